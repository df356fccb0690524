// SPDX-License-Identifier: GPL-3.0-or-later
// Teams without MPI: processes are threads here, messages go through mailboxes. All come to what one alone
// does, whoever does what; and a team that breaks says so.
#include "visibility/visibility.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>
#include <pthread.h>

#include "maze_fixture.h"

enum { MEMBERS_MAX = 4, SIDE = 9 };

/// A message that waits.
typedef struct letter {
    struct letter *next;
    int from;
    enf_bytes bytes;
} letter;

typedef struct office {
    pthread_mutex_t lock;
    pthread_cond_t shared;
    letter *first[MEMBERS_MAX], **last[MEMBERS_MAX];
    enf_bytes blackboard;
    int shares, readers; ///< of the blackboard: how often it was written; who has not read it yet
    int size, letters_left;
} office;

typedef struct member {
    office *office;
    enf_team team;
    const enf_portal_graph *graph;
    enf_visibility_options options;
    enf_visibility visibility;
    enf_error error;
    int shares; ///< that it has read
    pthread_t thread;
} member;

static bool send_letter(void *user, int to, const enf_bytes *message) {
    member *me = user;
    office *office = me->office;
    letter *sent = calloc(1, sizeof *sent);
    sent->from = me->team.rank;
    enf_put_bytes(&sent->bytes, message->data, message->count);
    pthread_mutex_lock(&office->lock);
    bool breaks = office->letters_left-- == 0;
    *office->last[to] = sent;
    office->last[to] = &sent->next;
    pthread_mutex_unlock(&office->lock);
    return !breaks;
}

static bool receive_letter(void *user, int *from, enf_bytes *message) {
    member *me = user;
    office *office = me->office;
    int rank = me->team.rank;
    *from = -1;
    pthread_mutex_lock(&office->lock);
    letter *got = office->first[rank];
    if (got) {
        office->first[rank] = got->next;
        if (!got->next) office->last[rank] = &office->first[rank];
    }
    bool broken = office->letters_left < 0;
    pthread_mutex_unlock(&office->lock);
    message->count = 0;
    if (got) {
        *from = got->from;
        enf_put_bytes(message, got->bytes.data, got->bytes.count);
        enf_bytes_free(&got->bytes);
        free(got);
    }
    return !broken;
}

static bool share_bytes(void *user, enf_bytes *bytes) {
    member *me = user;
    office *office = me->office;
    pthread_mutex_lock(&office->lock);
    if (me->team.rank == 0) {
        while (office->readers > 0) pthread_cond_wait(&office->shared, &office->lock);
        office->blackboard.count = 0;
        enf_put_bytes(&office->blackboard, bytes->data, bytes->count);
        office->shares++;
        office->readers = office->size - 1;
    } else {
        while (office->shares == me->shares) pthread_cond_wait(&office->shared, &office->lock);
        me->shares++;
        bytes->count = 0;
        enf_put_bytes(bytes, office->blackboard.data, office->blackboard.count);
        office->readers--;
    }
    pthread_cond_broadcast(&office->shared);
    pthread_mutex_unlock(&office->lock);
    return true;
}

static void *live(void *user) {
    member *me = user;
    enf_visibility_run(&me->visibility, me->graph, &me->options, &me->error);
    return NULL;
}

static void open_office(office *office, int size, int letters) {
    *office = (struct office){.size = size, .letters_left = letters};
    pthread_mutex_init(&office->lock, NULL);
    pthread_cond_init(&office->shared, NULL);
    for (int i = 0; i < size; i++) office->last[i] = &office->first[i];
}

static void close_office(office *office) {
    for (int i = 0; i < office->size; i++)
        for (letter *at = office->first[i], *next; at; at = next) {
            next = at->next;
            enf_bytes_free(&at->bytes);
            free(at);
        }
    enf_bytes_free(&office->blackboard);
    pthread_mutex_destroy(&office->lock);
    pthread_cond_destroy(&office->shared);
}

/// Runs a team of so many, with so many letters before the post breaks down.
static void run_team(member *members, int size, int letters, const enf_portal_graph *graph,
                     const enf_visibility_options *options) {
    office office;
    open_office(&office, size, letters);
    for (int i = 0; i < size; i++) {
        member *me = &members[i];
        *me = (member){.office = &office, .graph = graph, .options = *options};
        me->team = (enf_team){i, size, me, send_letter, receive_letter, share_bytes};
        me->options.team = &me->team;
        assert_int_equal(pthread_create(&me->thread, NULL, live, me), 0);
    }
    for (int i = 0; i < size; i++) pthread_join(members[i].thread, NULL);
    close_office(&office);
}

static void assert_same(const enf_visibility *a, const enf_visibility *b) {
    size_t words = (size_t)a->pvs.cell_count * a->pvs.row_words;
    assert_int_equal(a->pvs.cell_count, b->pvs.cell_count);
    assert_memory_equal(a->pvs.rows, b->pvs.rows, words * sizeof *a->pvs.rows);
    assert_true(a->witness_count == b->witness_count);
    size_t witnesses = (size_t)a->witness_count;
    if (witnesses > 0) assert_memory_equal(a->witnesses, b->witnesses, witnesses * sizeof *a->witnesses);
    if (witnesses > 0)
        assert_memory_equal(a->witness_cells, b->witness_cells, witnesses * sizeof *a->witness_cells);
    assert_true(a->visits == b->visits && a->lines == b->lines && a->nodes == b->nodes);
    assert_true(a->pairs_open == b->pairs_open && a->portal_pairs == b->portal_pairs);
    assert_memory_equal(&a->stabs, &b->stabs, sizeof a->stabs);
    assert_int_equal(a->sequence_longest, b->sequence_longest);
}

static void a_team_comes_to_what_one_comes_to(void **state) {
    (void)state;
    enf_portal_graph graph;
    maze_read(&graph, SIDE, 3);
    for (int method = ENF_METHOD_REACH; method < ENF_METHOD_COUNT; method++) {
        enf_visibility alone;
        enf_visibility_options options = {
            .method = (enf_method)method, .threads = 1, .want_witnesses = method % 2 == 0};
        assert_int_equal(enf_visibility_run(&alone, &graph, &options, NULL), ENF_OK);
        for (int size = 1; size <= MEMBERS_MAX; size++) {
            member members[MEMBERS_MAX];
            options.threads = 1 + size % 3;
            run_team(members, size, INT32_MAX, &graph, &options);
            for (int i = 0; i < size; i++) {
                if (members[i].error.status) fail_msg("rank %d: %s", i, members[i].error.text);
                assert_same(&alone, &members[i].visibility);
                enf_visibility_free(&members[i].visibility);
            }
        }
        enf_visibility_free(&alone);
    }
    enf_portal_graph_free(&graph);
}

static void a_team_that_breaks_says_so(void **state) {
    (void)state;
    enf_portal_graph graph;
    maze_read(&graph, SIDE, 3);
    for (int letters = 0; letters < 5; letters++) {
        member members[2];
        const enf_visibility_options options = {.method = ENF_METHOD_EXACT, .threads = 1};
        run_team(members, 2, letters, &graph, &options);
        for (int i = 0; i < 2; i++) {
            assert_int_equal(members[i].error.status, ENF_NO_RESOURCES);
            assert_non_null(strstr(members[i].error.text, "the others"));
            enf_visibility_free(&members[i].visibility);
        }
    }
    enf_portal_graph_free(&graph);
}

/// A budget that is over before the first cell: no job begins anywhere, and the team still agrees.
static void a_team_without_time_agrees(void **state) {
    (void)state;
    enf_portal_graph graph;
    member members[3];
    maze_read(&graph, SIDE, 3);
    const enf_visibility_options options = {.method = ENF_METHOD_EXACT, .threads = 1, .budget_seconds = 1e-9};
    run_team(members, 3, INT32_MAX, &graph, &options);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(members[i].error.status, ENF_OK);
        assert_int_equal(members[i].visibility.cells_budgeted, SIDE * SIDE);
        assert_same(&members[0].visibility, &members[i].visibility);
    }
    for (int i = 0; i < 3; i++) enf_visibility_free(&members[i].visibility);
    enf_portal_graph_free(&graph);
}

/// Rank 0 keeps what the others do, too.
static void a_team_fills_the_checkpoint(void **state) {
    (void)state;
    enf_portal_graph graph;
    member members[3];
    enf_visibility again;
    char path[] = P_tmpdir "/enfilade-team-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    maze_read(&graph, SIDE, 3);
    enf_visibility_options options = {.method = ENF_METHOD_EXACT, .threads = 1, .checkpoint = path};
    run_team(members, 3, INT32_MAX, &graph, &options);
    assert_int_equal(enf_visibility_run(&again, &graph, &options, NULL), ENF_OK);
    assert_true(again.jobs_stored > SIDE * SIDE);
    for (int i = 0; i < 3; i++) assert_same(&again, &members[i].visibility);
    for (int i = 1; i < 3; i++) enf_visibility_free(&members[i].visibility);
    enf_visibility more;
    run_team(members + 1, 2, INT32_MAX, &graph, &options);
    for (int i = 1; i < 3; i++) assert_same(&again, &members[i].visibility);
    assert_true(members[1].visibility.jobs_stored == again.jobs_stored);
    options.budget_seconds = 1e-9; // nothing is left to be done
    assert_int_equal(enf_visibility_run(&more, &graph, &options, NULL), ENF_OK);
    assert_int_equal(more.cells_budgeted + more.pairs_budgeted, 0);
    assert_same(&again, &more);
    remove(path);
    enf_visibility_free(&more);
    enf_visibility_free(&again);
    for (int i = 0; i < 3; i++) enf_visibility_free(&members[i].visibility);
    enf_portal_graph_free(&graph);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_team_comes_to_what_one_comes_to),
        cmocka_unit_test(a_team_that_breaks_says_so),
        cmocka_unit_test(a_team_without_time_agrees),
        cmocka_unit_test(a_team_fills_the_checkpoint),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
