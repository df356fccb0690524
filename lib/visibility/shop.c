// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/shop.h"

#include "base/array.h"
#include "base/timer.h"

#include <stdlib.h>
#include <time.h>

bool enf_shop_make(enf_shop *shop, const enf_work *work, enf_workplace *place, bool *begun) {
    *shop = (enf_shop){.work = work, .place = place, .begun = begun};
    shop->leads = !place->team || place->team->rank == 0;
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_mutex_init(&shop->lock, NULL);
    pthread_cond_init(&shop->more, &attributes);
    pthread_cond_init(&shop->idle, &attributes);
    pthread_condattr_destroy(&attributes);
    shop->queue = enf_array_new((size_t)work->cell_count, sizeof *shop->queue);
    return shop->queue != NULL;
}

void enf_shop_free(enf_shop *shop) {
    pthread_mutex_destroy(&shop->lock);
    pthread_cond_destroy(&shop->more);
    pthread_cond_destroy(&shop->idle);
    enf_bytes_free(&shop->outbox);
    free(shop->queue);
}

static bool is_idle(const enf_shop *shop) {
    return shop->status || (shop->next == shop->count && shop->busy == 0);
}

bool enf_shop_wait(enf_shop *shop, double seconds) {
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    int64_t nanoseconds = until.tv_nsec + (int64_t)(seconds * 1e9);
    until.tv_sec += nanoseconds / 1000000000;
    until.tv_nsec = nanoseconds % 1000000000;
    if (!is_idle(shop)) pthread_cond_timedwait(&shop->idle, &shop->lock, &until);
    return is_idle(shop);
}

void enf_shop_fail(enf_shop *shop, const enf_error *error) {
    shop->stopped = true;
    if (!shop->status) {
        shop->error = *error;
        shop->status = error->status;
    }
    pthread_cond_signal(&shop->idle);
}

void enf_shop_note(enf_shop *shop, int32_t cell, enf_outcome outcome, const enf_bytes *result) {
    enf_error error = {0};
    shop->cost_done += shop->work->cost[cell];
    shop->begun[cell] = outcome != ENF_OUTCOME_NONE;
    if (result && result->failed) {
        enf_fail_memory(&error, "the results");
    } else if (!shop->leads) {
        enf_put_number(&shop->outbox, (uint64_t)cell);
        enf_put_number(&shop->outbox, outcome);
        enf_put_number(&shop->outbox, result ? result->count : 0);
        if (result) enf_put_bytes(&shop->outbox, result->data, result->count);
        if (shop->outbox.failed) enf_fail_memory(&error, "the results");
    } else if (shop->place->checkpoint && outcome == ENF_OUTCOME_DONE) {
        const enf_record record = {shop->work->stage, cell, shop->work->key, result->data, result->count};
        enf_checkpoint_add(shop->place->checkpoint, &record, &error);
    }
    if (error.status) enf_shop_fail(shop, &error);
}

void enf_shop_watch(enf_shop *shop) {
    const enf_crew *crew = &shop->place->crew;
    if (!crew->watch || shop->stopped) return;
    double share = shop->cost_all > 0 ? (double)shop->cost_done / (double)shop->cost_all : 1;
    pthread_mutex_unlock(&shop->lock);
    bool goes_on = crew->watch(crew->user, share);
    pthread_mutex_lock(&shop->lock);
    if (goes_on) return;
    enf_error error;
    enf_fail(&error, ENF_NO_RESOURCES, "cancelled");
    enf_shop_fail(shop, &error);
}

// ---------------------------------------------------------------------------------------------- threads

/// The next cell, or -1 if none will come. The lock is held.
static int32_t take(enf_shop *shop) {
    while (shop->next == shop->count && !shop->closed) pthread_cond_wait(&shop->more, &shop->lock);
    if (shop->next == shop->count) return -1;
    shop->busy++;
    return shop->queue[shop->next++];
}

/// Does a cell, without the lock.
static enf_status do_cell(const enf_shop *shop, int32_t cell, int thread, enf_outcome *outcome,
                          enf_bytes *result, enf_error *error) {
    const enf_work *work = shop->work;
    bool late = false;
    enf_status status = work->run(work->user, cell, thread, &late, error);
    if (status) return status;
    *outcome = late ? ENF_OUTCOME_LATE : ENF_OUTCOME_DONE;
    result->count = 0;
    if (!shop->leads || (shop->place->checkpoint && !late)) work->encode(work->user, cell, result);
    return ENF_OK;
}

static void *labour(void *argument) {
    enf_shop *shop = argument;
    enf_bytes result = {0};
    pthread_mutex_lock(&shop->lock);
    int thread = shop->numbered++;
    for (int32_t cell; (cell = take(shop)) >= 0;) {
        enf_outcome outcome = ENF_OUTCOME_NONE;
        enf_error error = {0};
        bool begin = !shop->stopped && enf_timer_now() <= shop->place->deadline;
        pthread_mutex_unlock(&shop->lock);
        enf_status status = begin ? do_cell(shop, cell, thread, &outcome, &result, &error) : ENF_OK;
        pthread_mutex_lock(&shop->lock);
        if (status)
            enf_shop_fail(shop, &error);
        else
            enf_shop_note(shop, cell, outcome, outcome ? &result : NULL);
        shop->busy--;
        if (is_idle(shop)) pthread_cond_signal(&shop->idle);
    }
    pthread_mutex_unlock(&shop->lock);
    enf_bytes_free(&result);
    return NULL;
}

void enf_shop_start(enf_shop *shop) {
    int wanted = shop->place->crew.threads;
    if (wanted > ENF_SHOP_THREADS_MAX) wanted = ENF_SHOP_THREADS_MAX;
    if (shop->closed && wanted > shop->count) wanted = shop->count;
    while (shop->thread_count < wanted &&
           pthread_create(&shop->threads[shop->thread_count], NULL, labour, shop) == 0)
        shop->thread_count++;
    if (shop->thread_count > 0 || wanted == 0) return;
    if (shop->closed) {
        labour(shop);
        return;
    }
    enf_error error;
    enf_fail(&error, ENF_NO_RESOURCES, "the system gives no thread; raise ulimit -u");
    enf_shop_fail(shop, &error);
}

void enf_shop_end(enf_shop *shop) {
    pthread_mutex_lock(&shop->lock);
    shop->closed = true;
    pthread_cond_broadcast(&shop->more);
    pthread_mutex_unlock(&shop->lock);
    for (int i = 0; i < shop->thread_count; i++) pthread_join(shop->threads[i], NULL);
    shop->thread_count = 0;
}
