// SPDX-License-Identifier: MIT
#include "base/parallel.h"

#include <pthread.h>
#include <stdatomic.h>

enum { THREADS_MAX = 64 };

typedef struct crew {
    void (*job)(void *user, int32_t index, int thread);
    void *user;
    int32_t count;
    atomic_int next;
} crew;

typedef struct worker {
    crew *crew;
    int thread;
    pthread_t handle;
} worker;

static void *work(void *argument) {
    worker *me = argument;
    for (;;) {
        int index = atomic_fetch_add(&me->crew->next, 1);
        if (index >= me->crew->count) return NULL;
        me->crew->job(me->crew->user, index, me->thread);
    }
}

void enf_parallel_for(int threads, int32_t count, void (*job)(void *user, int32_t index, int thread),
                      void *user) {
    crew all = {.job = job, .user = user, .count = count};
    worker workers[THREADS_MAX];
    if (threads > THREADS_MAX) threads = THREADS_MAX;
    if (threads > count) threads = count;
    int started = 1;
    for (; started < threads; started++) {
        workers[started] = (worker){.crew = &all, .thread = started};
        if (pthread_create(&workers[started].handle, NULL, work, &workers[started]) != 0) break;
    }
    workers[0] = (worker){.crew = &all};
    work(&workers[0]);
    for (int i = 1; i < started; i++) pthread_join(workers[i].handle, NULL);
}
