// SPDX-License-Identifier: GPL-3.0-or-later
// The soup goes the whole way of the data, to a file and back; what is judged is what was read back.
#ifndef _GNU_SOURCE
#define _GNU_SOURCE // asprintf
#endif
#include "stress/stress_run.h"

#include "base/array.h"
#include "build/check.h"
#include "build/write.h"
#include "format/read.h"
#include "format/save.h"
#include "shim/shim.h"
#include "stress/stress_family.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static double cpu_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static bool end_run(enf_stress_result *result, enf_stress_outcome outcome, const char *reason) {
    result->outcome = outcome;
    snprintf(result->reason, sizeof result->reason, "%.300s", reason);
    return false;
}

// ---------------------------------------------------------------------------------------------- the file

/// The whole file in memory; null if it can't be read.
static void *read_bytes(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    struct stat about;
    void *bytes = NULL;
    if (file && fstat(fileno(file), &about) == 0) {
        *size = (size_t)about.st_size;
        bytes = malloc(*size + 1);
        if (bytes && fread(bytes, 1, *size, file) != *size) {
            free(bytes);
            bytes = NULL;
        }
    }
    if (file) fclose(file);
    return bytes;
}

/// Writes the view and reads it back; *bytes holds what *back points to.
static enf_status go_through_file(const enf_file_view *view, const char *folder, void **bytes,
                                  enf_file_view *back, enf_error *error) {
    char *path = NULL;
    if (asprintf(&path, "%s/enfilade-stress-%ld.enf", folder, (long)getpid()) < 0)
        return enf_fail_memory(error, "a path");
    size_t size = 0;
    enf_status status = enf_view_save(view, path, error);
    if (!status && !(*bytes = read_bytes(path, &size)))
        status = enf_fail(error, ENF_NO_RESOURCES, "%s: can't be read back", path);
    unlink(path);
    free(path);
    return status ? status : enf_file_read(back, *bytes, size, false, error);
}

// ---------------------------------------------------------------------------------------------- judging

static bool judge_check(const enf_file_view *view, enf_stress_result *result) {
    enf_check_report *report = calloc(1, sizeof *report);
    enf_error error = {0};
    enf_status status =
        report ? enf_world_check(view, report, &error) : enf_fail_memory(&error, "the report");
    free(report);
    if (!status) return true;
    return end_run(result, status == ENF_NO_RESOURCES ? ENF_STRESS_HARNESS : ENF_STRESS_BROKEN, error.text);
}

static bool judge_oracles(enf_stress_case *made, const enf_file_view *view, int points,
                          enf_stress_result *result) {
    enf_stress_verdict *verdict = &result->verdict;
    enf_stress_ask_points(made, view, points, verdict);
    enf_stress_ask_segments(made, view, points, verdict);
    enf_stress_ask_surfaces(made, view, points / 4, verdict);
    if (verdict->disagreements == 0) return true;
    return end_run(result, ENF_STRESS_WRONG, verdict->first);
}

static void judge_world(enf_stress_case *made, const enf_build *build, const enf_stress_options *harness,
                        enf_stress_result *result) {
    enf_build_image image;
    enf_error error = {0};
    enf_status status = enf_build_image_make(&image, build, NULL, &error);
    if (status) {
        end_run(result, status == ENF_NO_RESOURCES ? ENF_STRESS_HARNESS : ENF_STRESS_BROKEN, error.text);
        return;
    }
    void *bytes = NULL;
    enf_file_view back = image.view;
    if (harness->folder) status = go_through_file(&image.view, harness->folder, &bytes, &back, &error);
    if (status)
        end_run(result, status == ENF_NO_RESOURCES ? ENF_STRESS_HARNESS : ENF_STRESS_BROKEN, error.text);
    else if (judge_check(&back, result) && judge_oracles(made, &back, harness->points, result))
        result->outcome = ENF_STRESS_FINE;
    free(bytes);
    enf_build_image_free(&image);
}

// ---------------------------------------------------------------------------------------------- runs

/// --keep outside finds nothing to keep where all is solid.
static bool is_allowed(enf_status status, const enf_build_options *options) {
    return status == ENF_BAD_INPUT && options->keep == ENF_KEEP_OUTSIDE;
}

/// Watches the pipeline: a run that is killed leaves what was noted last.
typedef struct watch {
    const enf_build *build;
    enf_stress_result *result;
    double started;
} watch;

static bool note_stage(void *user, const char *stage, double fraction) {
    const watch *watch = user;
    enf_stress_result *result = watch->result;
    (void)fraction;
    if (result->stage == stage) return true;
    result->stage = stage;
    result->polygons = (int32_t)watch->build->mesh.polygon_count;
    result->tetrahedra = watch->build->complex.tetrahedron_count;
    result->fine_cells = watch->build->complex.cell_count;
    if (strcmp(stage, "decimate") == 0) result->cell_seconds = cpu_seconds() - watch->started;
    return true;
}

void enf_stress_compile(enf_stress_case *made, const enf_build_options *options,
                        const enf_stress_options *harness, enf_stress_result *result) {
    memset(result, 0, sizeof *result);
    enf_build build = {.soup = made->soup};
    watch watch = {.build = &build, .result = result, .started = cpu_seconds()};
    enf_build_options watched = *options;
    watched.progress = note_stage;
    watched.progress_user = &watch;
    enf_error error = {0};
    enf_status status = enf_build_run(&build, &watched, &error);
    result->seconds = cpu_seconds() - watch.started;
    result->peak_bytes = build.peak_bytes;
    result->rejected = (int64_t)build.soup.rejected_count;
    result->polygons = (int32_t)build.mesh.polygon_count;
    result->tetrahedra = build.complex.tetrahedron_count;
    result->fine_cells = build.complex.cell_count;
    size_t tetrahedra;
    if (!status && harness->yardstick)
        status = enf_shim_delaunay_time(build.mesh.points, build.mesh.point_count, &result->delaunay_seconds,
                                        &tetrahedra, &error);
    made->soup = build.soup; // with what clean rejected
    if (harness->compiled) harness->compiled();
    if (!status && harness->time_only)
        result->outcome = ENF_STRESS_FINE;
    else if (!status)
        judge_world(made, &build, harness, result);
    else
        end_run(result, is_allowed(status, options) ? ENF_STRESS_FINE : ENF_STRESS_REFUSED, error.text);
    memset(&build.soup, 0, sizeof build.soup);
    enf_build_free(&build);
}

enf_build_options enf_stress_build_options(const enf_stress_case *made, uint64_t seed, int cells) {
    enf_build_options options = {.clean = {.weld = made->weld, .plane_tolerance = -1},
                                 .keep = seed % 4 == 1 ? ENF_KEEP_OUTSIDE : ENF_KEEP_ALL,
                                 .memory = UINT64_MAX, // whoever runs it sets the limit
                                 .threads = 1};
    if (cells > 0 && seed % 2) options.stop = (enf_stop){.rule = ENF_STOP_CELLS, .cells = cells};
    return options;
}

void enf_stress_run(int family, uint64_t seed, const enf_stress_options *harness, enf_stress_result *result) {
    enf_stress_case made;
    enf_error error = {0};
    memset(result, 0, sizeof *result);
    enf_status status = enf_stress_make(&made, family, seed, &error);
    if (status) {
        end_run(result, ENF_STRESS_HARNESS, error.text);
    } else {
        enf_build_options options = enf_stress_build_options(&made, seed, harness->cells);
        enf_stress_compile(&made, &options, harness, result);
    }
    enf_stress_case_free(&made);
}
