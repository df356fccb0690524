// SPDX-License-Identifier: GPL-3.0-or-later
// The recipe as an editor sees it: progress comes stage by stage, and it can be cancelled at any call.
#include "pipeline_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

typedef struct watcher {
    const char *stage;
    double fraction;
    int calls, stages, stop_at; ///< stop_at: the call that says no; 0: none
    bool orderly;
} watcher;

static bool watch(void *user, const char *stage, double fraction) {
    watcher *w = user;
    if (!w->stage || strcmp(stage, w->stage) != 0) {
        w->stage = stage;
        w->stages++;
        w->fraction = 0;
    }
    w->orderly = w->orderly && fraction >= w->fraction && fraction <= 1;
    w->fraction = fraction;
    return ++w->calls != w->stop_at;
}

static enf_status build_watched(watcher *w, int threads, enf_error *error) {
    enf_build build;
    memset(&build, 0, sizeof build);
    pipeline_read_model(&build.soup, "office");
    enf_build_options options = pipeline_options();
    options.threads = threads;
    options.progress = watch;
    options.progress_user = w;
    enf_status status = enf_build_run(&build, &options, error);
    enf_build_free(&build);
    return status;
}

static void progress_rises_within_each_stage(void **state) {
    (void)state;
    for (int threads = 1; threads <= 2; threads++) {
        watcher w = {.orderly = true};
        enf_error error = {0};
        assert_int_equal(build_watched(&w, threads, &error), ENF_OK);
        assert_true(w.orderly);
        assert_true(w.stages >= 6);
        // Not only where stages begin; of several threads only the caller's own tells.
        assert_true(w.calls > (threads == 1 ? 2 : 1) * w.stages);
    }
}

static void every_call_can_cancel(void **state) {
    (void)state;
    watcher all = {.orderly = true};
    enf_error error = {0};
    assert_int_equal(build_watched(&all, 1, &error), ENF_OK);
    int step = all.calls > 40 ? all.calls / 40 : 1;
    for (int stop = 1; stop <= all.calls; stop += step) {
        watcher w = {.orderly = true, .stop_at = stop};
        assert_int_equal(build_watched(&w, 1, &error), ENF_NO_RESOURCES);
        assert_non_null(strstr(error.text, "cancelled"));
        assert_int_equal(w.calls, stop);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(progress_rises_within_each_stage),
        cmocka_unit_test(every_call_can_cancel),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
