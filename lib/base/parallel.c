// SPDX-License-Identifier: MIT
#include "base/parallel.h"

#include <pthread.h>
#include <stdatomic.h>

enum { THREADS_MAX = 64 };

typedef struct shift {
    const enf_crew *crew;
    void (*job)(void *user, int32_t index, int thread);
    void *user;
    int32_t count;
    atomic_int next;
    atomic_bool stopped;
} shift;

typedef struct worker {
    shift *shift;
    int thread;
    pthread_t handle;
} worker;

static void *work(void *argument) {
    worker *me = argument;
    shift *all = me->shift;
    const enf_crew *crew = all->crew;
    for (bool first = me->thread == 0; !atomic_load(&all->stopped); first = false) {
        int index = first ? 0 : atomic_fetch_add(&all->next, 1);
        if (index >= all->count) break;
        if (me->thread == 0 && crew->watch && !crew->watch(crew->user, (double)index / all->count)) {
            atomic_store(&all->stopped, true);
            break;
        }
        all->job(all->user, index, me->thread);
    }
    return NULL;
}

bool enf_parallel_for(const enf_crew *crew, int32_t count, void (*job)(void *user, int32_t index, int thread),
                      void *user) {
    shift all = {.crew = crew, .job = job, .user = user, .count = count, .next = 1};
    worker workers[THREADS_MAX];
    int threads = crew->threads < THREADS_MAX ? crew->threads : THREADS_MAX, started = 1;
    if (threads > count) threads = count;
    for (; started < threads; started++) {
        workers[started] = (worker){.shift = &all, .thread = started};
        if (pthread_create(&workers[started].handle, NULL, work, &workers[started]) != 0) break;
    }
    workers[0] = (worker){.shift = &all};
    work(&workers[0]);
    for (int i = 1; i < started; i++) pthread_join(workers[i].handle, NULL);
    return !atomic_load(&all.stopped);
}
