// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef _GNU_SOURCE
#define _GNU_SOURCE // qsort_r
#endif
#include "visibility/work.h"

#include "visibility/deal.h"
#include "visibility/shop.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static const double watch_interval = 0.05; // seconds

/// Takes what the checkpoint has of this stage.
static enf_status take_stored(enf_shop *shop, enf_error *error) {
    const enf_work *work = shop->work;
    enf_checkpoint *checkpoint = shop->place->checkpoint;
    size_t count = 0;
    const enf_record *records = checkpoint ? enf_checkpoint_records(checkpoint, &count) : NULL;
    for (size_t i = 0; i < count; i++) {
        const enf_record *record = &records[i];
        if (record->stage != work->stage || record->key != work->key) continue;
        if (record->cell >= work->cell_count || shop->begun[record->cell]) continue;
        enf_reader reader = {record->result, record->result + record->size, false};
        if (!work->decode(work->user, record->cell, &reader)) return enf_fail_memory(error, "the results");
        if (reader.failed || enf_reader_left(&reader) > 0)
            return enf_fail(error, ENF_BAD_INPUT,
                            "%s: what the checkpoint has of cell %" PRId32 " makes no sense; remove it",
                            enf_checkpoint_path(checkpoint), record->cell);
        shop->begun[record->cell] = true;
        shop->place->stored++;
        shop->cost_done += work->cost[record->cell];
    }
    return ENF_OK;
}

/// The dearest first: what takes long should not begin last.
static int compare_cost(const void *a, const void *b, void *user) {
    const int64_t *cost = user;
    int32_t cell_a = *(const int32_t *)a, cell_b = *(const int32_t *)b;
    if (cost[cell_a] != cost[cell_b]) return cost[cell_a] > cost[cell_b] ? -1 : 1;
    return cell_a < cell_b ? -1 : 1;
}

static void fill_queue(enf_shop *shop) {
    const enf_work *work = shop->work;
    for (int32_t cell = 0; cell < work->cell_count; cell++) {
        shop->cost_all += work->cost[cell];
        if (work->cost[cell] > 0 && !shop->begun[cell]) shop->queue[shop->count++] = cell;
    }
    qsort_r(shop->queue, (size_t)shop->count, sizeof *shop->queue, compare_cost, (void *)work->cost);
    shop->closed = true;
}

static void work_alone(enf_shop *shop) {
    pthread_mutex_lock(&shop->lock);
    for (bool idle = false; !idle; idle = enf_shop_wait(shop, watch_interval)) enf_shop_watch(shop);
    pthread_mutex_unlock(&shop->lock);
}

enf_status enf_work_run(const enf_work *work, enf_workplace *place, bool *begun, enf_error *error) {
    enf_shop shop;
    memset(begun, 0, (size_t)work->cell_count * sizeof *begun);
    bool made = enf_shop_make(&shop, work, place, begun);
    enf_status status = made ? ENF_OK : enf_fail_memory(error, "the cells");
    if (!status && shop.leads) status = take_stored(&shop, error);
    if (!status) {
        if (shop.leads) fill_queue(&shop);
        enf_shop_start(&shop);
        if (!place->team)
            work_alone(&shop);
        else if (shop.leads)
            enf_deal_out(&shop);
        else
            enf_deal_in(&shop);
        enf_shop_end(&shop);
        if (!shop.status && place->team) enf_deal_share(&shop);
        if (shop.status) status = enf_fail(error, shop.status, "%s", shop.error.text);
    }
    enf_shop_free(&shop);
    return status;
}
