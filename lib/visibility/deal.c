// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/deal.h"

#include <time.h>

enum { REST_MILLISECONDS = 1, WATCH_MILLISECONDS = 50 };

static void fail_team(enf_shop *shop, const char *what) {
    enf_error error;
    enf_fail(&error, ENF_NO_RESOURCES, "rank %d: %s; start the run again", shop->place->team->rank, what);
    enf_shop_fail(shop, &error);
}

/// Sends without the lock, and empties the message.
static void send_to(enf_shop *shop, int to, enf_bytes *message) {
    const enf_team *team = shop->place->team;
    pthread_mutex_unlock(&shop->lock);
    bool sent = !message->failed && team->send(team->user, to, message);
    pthread_mutex_lock(&shop->lock);
    message->count = 0;
    if (!sent) fail_team(shop, "cannot send to the others");
}

/// The sender of a message, or -1 if there is none.
static int receive(enf_shop *shop, enf_bytes *message) {
    const enf_team *team = shop->place->team;
    int from = -1;
    pthread_mutex_unlock(&shop->lock);
    bool good = team->receive(team->user, &from, message);
    pthread_mutex_lock(&shop->lock);
    if (good) return from;
    fail_team(shop, "cannot hear the others");
    return -1;
}

/// Sleeps a little, without the lock.
static void rest(enf_shop *shop) {
    const struct timespec little = {.tv_nsec = REST_MILLISECONDS * 1000000};
    pthread_mutex_unlock(&shop->lock);
    nanosleep(&little, NULL);
    pthread_mutex_lock(&shop->lock);
}

// ---------------------------------------------------------------------------------------------- rank 0

/// Takes the next cells off the queue: a fair part of what is left, by cost.
static int32_t deal_batch(enf_shop *shop, enf_bytes *message) {
    int64_t left = 0, taken = 0;
    int32_t count = 0;
    for (int32_t i = shop->next; i < shop->count; i++) left += shop->work->cost[shop->queue[i]];
    int64_t share = left / (4 * (int64_t)shop->place->team->size);
    while (shop->next < shop->count && (count == 0 || taken < share)) {
        int32_t cell = shop->queue[shop->next++];
        taken += shop->work->cost[cell];
        enf_put_number(message, (uint64_t)cell);
        count++;
    }
    return count;
}

/// Takes one result from a message.
static void take_result(enf_shop *shop, enf_reader *reader) {
    const enf_work *work = shop->work;
    int32_t cell = (int32_t)enf_take_number(reader, (uint64_t)work->cell_count - 1);
    enf_outcome outcome = (enf_outcome)enf_take_number(reader, ENF_OUTCOME_COUNT - 1);
    size_t size = (size_t)enf_take_number(reader, enf_reader_left(reader));
    const uint8_t *data = enf_take_bytes(reader, size);
    if (reader->failed || shop->begun[cell]) {
        fail_team(shop, "a message makes no sense");
        return;
    }
    enf_reader result = {data, data + size, false};
    pthread_mutex_unlock(&shop->lock);
    bool good = !outcome || work->decode(work->user, cell, &result);
    pthread_mutex_lock(&shop->lock);
    const enf_bytes bytes = {.data = (uint8_t *)data, .count = size};
    if (result.failed || !good)
        fail_team(shop, good ? "a result makes no sense" : "out of memory for the results");
    else
        enf_shop_note(shop, cell, outcome, outcome ? &bytes : NULL);
}

typedef struct dealing {
    int32_t away; ///< cells that are with others
    int ended;    ///< processes that know that there are no more
} dealing;

static void answer(enf_shop *shop, dealing *dealing, int from, const enf_bytes *message) {
    enf_reader reader = {message->data, message->data + message->count, false};
    bool wants = enf_take_number(&reader, 1);
    for (; !reader.failed && enf_reader_left(&reader) > 0; dealing->away--) take_result(shop, &reader);
    if (!wants) return;
    enf_bytes reply = {0};
    int32_t count = deal_batch(shop, &reply);
    dealing->away += count;
    dealing->ended += count == 0;
    send_to(shop, from, &reply);
    enf_bytes_free(&reply);
}

void enf_deal_out(enf_shop *shop) {
    dealing dealing = {0};
    enf_bytes message = {0};
    int waited = WATCH_MILLISECONDS;
    pthread_mutex_lock(&shop->lock);
    for (bool idle = false; !shop->status;) {
        if (idle && dealing.away == 0 && dealing.ended == shop->place->team->size - 1) break;
        int from = receive(shop, &message);
        if (from >= 0) {
            answer(shop, &dealing, from, &message);
            continue;
        }
        if (waited >= WATCH_MILLISECONDS) {
            enf_shop_watch(shop);
            waited = 0;
        }
        rest(shop);
        waited += REST_MILLISECONDS;
        idle = enf_shop_wait(shop, 0);
    }
    pthread_mutex_unlock(&shop->lock);
    enf_bytes_free(&message);
}

// ---------------------------------------------------------------------------------------------- the others

static void take_cells(enf_shop *shop, const enf_bytes *message) {
    enf_reader reader = {message->data, message->data + message->count, false};
    if (message->count == 0) shop->closed = true;
    while (!reader.failed && enf_reader_left(&reader) > 0) {
        int32_t cell = (int32_t)enf_take_number(&reader, (uint64_t)shop->work->cell_count - 1);
        reader.failed = reader.failed || shop->count == shop->work->cell_count;
        if (!reader.failed) shop->queue[shop->count++] = cell;
    }
    if (reader.failed) fail_team(shop, "a message makes no sense");
    pthread_cond_broadcast(&shop->more);
}

/// Sends what is finished, and asks for more in time.
static void report(enf_shop *shop, bool *asks) {
    bool wants = !*asks && !shop->closed && shop->count - shop->next < shop->place->crew.threads;
    if (!wants && shop->outbox.count == 0) return;
    enf_bytes message = {0};
    enf_put_number(&message, wants);
    enf_put_bytes(&message, shop->outbox.data, shop->outbox.count);
    shop->outbox.count = 0;
    *asks = *asks || wants;
    send_to(shop, 0, &message);
    enf_bytes_free(&message);
}

void enf_deal_in(enf_shop *shop) {
    enf_bytes message = {0};
    bool asks = false;
    pthread_mutex_lock(&shop->lock);
    while (!shop->status) {
        report(shop, &asks);
        if (receive(shop, &message) >= 0) {
            take_cells(shop, &message);
            asks = false;
            continue;
        }
        bool idle = enf_shop_wait(shop, 0); // it lets go of the lock: only then is the outbox final
        if (idle && shop->closed && shop->outbox.count == 0) break;
        rest(shop);
    }
    pthread_mutex_unlock(&shop->lock);
    enf_bytes_free(&message);
}

// ---------------------------------------------------------------------------------------------- the end

static void put_all(const enf_shop *shop, enf_bytes *all) {
    const enf_work *work = shop->work;
    enf_bytes result = {0};
    for (int32_t cell = 0; cell < work->cell_count; cell++) {
        if (!shop->begun[cell]) continue;
        result.count = 0;
        work->encode(work->user, cell, &result);
        enf_put_number(all, (uint64_t)cell);
        enf_put_number(all, result.count);
        enf_put_bytes(all, result.data, result.count);
    }
    all->failed = all->failed || result.failed;
    enf_bytes_free(&result);
}

static bool take_all(const enf_shop *shop, const enf_bytes *all) {
    const enf_work *work = shop->work;
    enf_reader reader = {all->data, all->data + all->count, false};
    while (enf_reader_left(&reader) > 0) {
        int32_t cell = (int32_t)enf_take_number(&reader, (uint64_t)work->cell_count - 1);
        size_t size = (size_t)enf_take_number(&reader, enf_reader_left(&reader));
        const uint8_t *data = enf_take_bytes(&reader, size);
        if (reader.failed) return false;
        enf_reader result = {data, data + size, false};
        if (!shop->begun[cell] && (!work->decode(work->user, cell, &result) || result.failed)) return false;
        shop->begun[cell] = true;
    }
    return true;
}

void enf_deal_share(enf_shop *shop) {
    const enf_team *team = shop->place->team;
    enf_bytes all = {0};
    if (shop->leads) put_all(shop, &all);
    bool good = !all.failed && team->share(team->user, &all) && (shop->leads || take_all(shop, &all));
    enf_bytes_free(&all);
    if (!good) fail_team(shop, "the results cannot be shared");
}
