// SPDX-License-Identifier: GPL-3.0-or-later
// What a tool does to coordinates: rotations by odd angles, single precision, four decimals. Each level is
// compiled as it is, then in each of these variants, and compared with itself.
#ifndef _GNU_SOURCE
#define _GNU_SOURCE // asprintf
#endif
#include "build/build.h"
#include "cli/bench.h"
#include "cli/cli.h"
#include "cli/job.h"
#include "cli/random.h"

#include <dirent.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

typedef enum rounding { ROUND_NOT, ROUND_FLOAT, ROUND_DECIMALS, ROUNDING_COUNT } rounding;

static const char *const rounding_names[] = {"exact", "float", "decimals"};

enum { ROTATIONS = 5 }; // none, by (7, 8, 9) degrees, three at random

static const char *const rotation_names[ROTATIONS] = {"as it is", "7 8 9 degrees", "random 1", "random 2",
                                                      "random 3"};

/// What is compared.
typedef struct outcome {
    double seconds;
    int32_t fine_cells, regions;
    double leak; ///< width of the narrowest place on the way out; -1: no leak
    int64_t spawns_kept;
    int32_t spawns;
    double displacement, volume; ///< of all kept regions
    double *volumes;             ///< of regions thicker than the tolerance, falling
    size_t volume_count;
} outcome;

// ---- rotations

/// The rotation of a quaternion of any length.
static void set_from_quaternion(double m[3][3], double w, double x, double y, double z) {
    double n = w * w + x * x + y * y + z * z;
    const double rows[3][3] = {{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
                               {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
                               {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) m[i][k] = rows[i][k] / n;
}

/// By 7 degrees about x, then 8 about y, then 9 about z.
static void set_from_degrees(double m[3][3]) {
    double s[3], c[3];
    for (int a = 0; a < 3; a++) {
        double angle = (7 + a) * 3.141592653589793 / 180;
        s[a] = sin(angle);
        c[a] = cos(angle);
    }
    const double rows[3][3] = {
        {c[2] * c[1], c[2] * s[1] * s[0] - s[2] * c[0], c[2] * s[1] * c[0] + s[2] * s[0]},
        {s[2] * c[1], s[2] * s[1] * s[0] + c[2] * c[0], s[2] * s[1] * c[0] - c[2] * s[0]},
        {-s[1], c[1] * s[0], c[1] * c[0]}};
    memcpy(m, rows, sizeof rows);
}

/// Uniform: a point of the four-dimensional ball.
static void set_at_random(double m[3][3], uint64_t seed) {
    double q[4], square = 2;
    while (square > 1 || square < 0.01) {
        square = 0;
        for (int i = 0; i < 4; i++) {
            q[i] = (double)(cli_random(&seed) >> 11) * 0x1p-52 - 1;
            square += q[i] * q[i];
        }
    }
    set_from_quaternion(m, q[0], q[1], q[2], q[3]);
}

static double rounded(double x, rounding how) {
    switch (how) {
    case ROUND_FLOAT:
        return (double)(float)x;
    case ROUND_DECIMALS:
        return nearbyint(x * 1e4) / 1e4;
    default:
        return x;
    }
}

static void move(double *points, size_t count, int rotation, uint64_t seed, rounding how) {
    double m[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    if (rotation == 1) set_from_degrees(m);
    if (rotation > 1) set_at_random(m, seed + (uint64_t)rotation);
    for (size_t i = 0; i < count; i++) {
        double at[3];
        memcpy(at, &points[3 * i], sizeof at);
        for (int a = 0; a < 3; a++) {
            double x = rotation ? m[a][0] * at[0] + m[a][1] * at[1] + m[a][2] * at[2] : at[a];
            points[3 * i + (size_t)a] = rounded(x, how);
        }
    }
}

// ---- one compilation

static int compare_falling(const void *left, const void *right) {
    double a = *(const double *)left, b = *(const double *)right;
    return (a < b) - (a > b);
}

static enf_status note_outcome(outcome *out, const cli_job *job, enf_error *error) {
    const enf_build *build = &job->build;
    cli_counts counts = cli_job_count(job);
    double step = build->mesh.frame.step, width = fmax(build->mesh.weld, build->mesh.plane_tolerance);
    *out = (outcome){.fine_cells = build->complex.cell_count,
                     .regions = build->regions.region_count,
                     .leak = build->regions.leak ? build->regions.leak_width * step : -1,
                     .spawns_kept = counts.spawns_in_cells,
                     .spawns = build->regions.spawn_count,
                     .displacement = build->mesh.displacement_max};
    out->volumes = malloc(((size_t)build->regions.region_count + 1) * sizeof *out->volumes);
    if (!out->volumes) return enf_fail_memory(error, "the regions");
    for (int32_t r = 0; r < build->regions.region_count; r++) {
        double volume = build->regions.volume[r] * step * step * step;
        double area = (build->regions.front_area[r] + build->regions.back_area[r]) * step * step;
        if (build->regions.kept[r]) out->volume += volume;
        if (volume > width * area) out->volumes[out->volume_count++] = volume;
    }
    qsort(out->volumes, out->volume_count, sizeof *out->volumes, compare_falling);
    return ENF_OK;
}

static double cpu_seconds(void) {
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (double)usage.ru_utime.tv_sec + (double)usage.ru_stime.tv_sec +
           1e-6 * ((double)usage.ru_utime.tv_usec + (double)usage.ru_stime.tv_usec);
}

/// CPU time of the stages, without reading: the same for all variants.
static enf_status compile_once(const char *path, const cli_settings *settings, int rotation, uint64_t seed,
                               rounding how, outcome *out, enf_error *error) {
    cli_job job = {0};
    enf_status status = cli_job_prepare(&job, settings, error);
    if (!status) status = enf_soup_read(&job.build.soup, path, error);
    if (!status) {
        move(job.build.soup.points, job.build.soup.point_count, rotation, seed, how);
        move(job.build.soup.spawns, job.build.soup.spawn_count, rotation, seed, how);
        double started = cpu_seconds();
        status = enf_build_run(&job.build, &job.options, error);
        double seconds = cpu_seconds() - started;
        if (!status) status = note_outcome(out, &job, error);
        out->seconds = seconds;
    }
    cli_job_free(&job);
    return status;
}

/// The fastest of several runs, and what they agree on.
static enf_status compile_variant(const char *path, const cli_settings *settings, int rotation, uint64_t seed,
                                  rounding how, int runs, outcome *out, enf_error *error) {
    *out = (outcome){0};
    for (int run = 0; run < runs; run++) {
        outcome next = {0};
        enf_status status = compile_once(path, settings, rotation, seed, how, &next, error);
        if (run && !status) next.seconds = fmin(next.seconds, out->seconds);
        free(out->volumes);
        *out = next;
        if (status) return status;
    }
    return ENF_OK;
}

// ---- comparison

/// The largest difference between regions of the same rank, as a part of the kept volume.
static double volume_difference(const outcome *a, const outcome *b) {
    double worst = 0;
    size_t count = a->volume_count > b->volume_count ? a->volume_count : b->volume_count;
    for (size_t i = 0; i < count; i++) {
        double x = i < a->volume_count ? a->volumes[i] : 0, y = i < b->volume_count ? b->volumes[i] : 0;
        worst = fmax(worst, fabs(x - y));
    }
    return a->volume > 0 ? worst / a->volume : 0;
}

/// "-", or how narrow the leak is.
static const char *print_leak(char text[32], double width) {
    if (width < 0) return "-";
    snprintf(text, 32, "%.2e", width);
    return text;
}

static void print_row(const char *name, int rotation, rounding how, const outcome *base, const outcome *out) {
    char leak[32];
    printf("%s,%s,%s,%.3f,%.2f,%" PRId32 ",%.3f,%zu,%zu,%.1e,%s,%" PRId64 "/%" PRId32 ",%.2e\n", name,
           rotation_names[rotation], rounding_names[how], out->seconds, out->seconds / base->seconds,
           out->fine_cells, (double)out->fine_cells / base->fine_cells, out->volume_count, base->volume_count,
           volume_difference(base, out), print_leak(leak, out->leak), out->spawns_kept, out->spawns,
           out->displacement);
    fflush(stdout);
}

typedef struct recovery_options {
    int levels, runs, seed;
    cli_settings settings;
} recovery_options;

static enf_status run_level(const char *path, const char *name, const recovery_options *options,
                            enf_error *error) {
    outcome base = {0};
    enf_status status = ENF_OK;
    for (int rotation = 0; rotation < ROTATIONS && !status; rotation++) {
        for (int how = 0; how < ROUNDING_COUNT && !status; how++) {
            outcome out;
            status = compile_variant(path, &options->settings, rotation, (uint64_t)options->seed,
                                     (rounding)how, options->runs, &out, error);
            bool first = rotation == 0 && how == 0;
            if (first) base = out;
            if (!status) print_row(name, rotation, (rounding)how, &base, &out);
            if (!first) free(out.volumes);
        }
    }
    free(base.volumes);
    return status;
}

static int is_level(const struct dirent *entry) {
    const char *dot = strstr(entry->d_name, ".obj");
    return dot && (!dot[4] || strcmp(dot, ".obj.gz") == 0);
}

static int run_folder(const char *folder, const recovery_options *options) {
    struct dirent **entries = NULL;
    int count = scandir(folder, &entries, is_level, alphasort), worst = ENF_OK;
    if (count <= 0) {
        fprintf(stderr, "%s: %s; name a folder with .obj files, gzipped or not\n", folder,
                count < 0 ? "can't be read" : "holds no levels");
        free(entries);
        return count < 0 ? ENF_NO_RESOURCES : ENF_BAD_INPUT;
    }
    puts("level,rotation,rounding,cpu_s,time_ratio,fine_cells,cell_ratio,regions,regions_as_it_is,"
         "volume_difference,leak,spawns_kept,displacement");
    for (int i = 0; i < count; i++) {
        char *path = NULL;
        enf_error error = {0};
        bool wanted = i < options->levels;
        enf_status status = ENF_OK;
        if (wanted && asprintf(&path, "%s/%s", folder, entries[i]->d_name) < 0) {
            path = NULL;
            status = enf_fail_memory(&error, "a path");
        }
        if (wanted && !status) status = run_level(path, entries[i]->d_name, options, &error);
        if (status) fprintf(stderr, "%s: %s\n", entries[i]->d_name, error.text);
        if ((int)status > worst) worst = (int)status;
        free(path);
        free(entries[i]);
    }
    free(entries);
    return cli_finish_output() ? ENF_NO_RESOURCES : worst;
}

int cli_bench_recovery(int argc, char **argv) {
    recovery_options chosen = {.levels = 1000000, .runs = 1, .seed = 1, .settings = cli_settings_default()};
    chosen.settings.threads = 1;
    cli_option options[] = {
        {"--levels", 0, CLI_COUNT, &chosen.levels, "N", "only the first N levels", NULL, false},
        {"--runs", 0, CLI_COUNT, &chosen.runs, "N", "of each variant the fastest of N (default 1)", NULL,
         false},
        {"--seed", 0, CLI_COUNT, &chosen.seed, "N", "of the random rotations (default 1)", NULL, false},
        CLI_SETTINGS_OPTIONS(chosen.settings),
        {0}};
    const cli_syntax syntax = {
        .command = "enfilade bench recovery",
        .usage = "DIR [--levels N] [--runs N] [options of compile]",
        .summary =
            "Compiles every level in a folder as it is, rotated by (7, 8, 9) degrees and by three random\n"
            "rotations, each exactly, rounded to single precision and to four decimals. Ratios are to the\n"
            "level as it is; volume_difference is the largest between regions of the same rank, as a part\n"
            "of the kept volume; leak is the width of its narrowest place; displacement is the largest, in "
            "world units. Writes csv.",
        .options = options,
        .operands_min = 1,
        .operands_max = 1,
        .operand = "the folder"};
    cli_texts operands = {0};
    int status = cli_parse(&syntax, argc, argv, &operands);
    if (status < 0) status = run_folder(operands.items[0], &chosen);
    cli_settings_free(&chosen.settings);
    free(operands.items);
    return status;
}
