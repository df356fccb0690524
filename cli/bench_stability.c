// SPDX-License-Identifier: GPL-3.0-or-later
// Families of random soups: nothing may fail.
#include "base/array.h"
#include "cli/bench.h"
#include "cli/bench_child.h"
#include "cli/cli.h"
#include "cli/options.h"
#include "cli/progress.h"
#include "stress/stress_family.h"
#include "stress/stress_run.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double slow_ratio = 20; ///< times the family's median per output cell
enum { POINTS = 200, TIMINGS = 3 };

typedef struct settings {
    int seeds, only; ///< only: a family, or -1
    uint64_t first;
    double limit;
    const char *folder;
} settings;

/// What a child is told, and what it says.
typedef struct run {
    int family;
    uint64_t seed;
    const char *folder;
    enf_stress_result result;
} run;

typedef struct failure {
    int family;
    uint64_t seed;
    const char *kind;
    char reason[320];
} failure;

/// All that is noted of a family, and the failures of all.
typedef struct tally {
    const settings *settings;
    run *run;               ///< shared with the children
    double *seconds_a_cell; ///< per seed; < 0: no time
    int broken, wrong, refused, died, slow;
    int64_t cells, points, segments, surfaces;
    failure *failures;
    size_t failure_count, failure_capacity;
    cli_progress progress;
} tally;

static void work(void *shared) {
    run *run = shared;
    const enf_stress_options harness = {.folder = run->folder, .points = POINTS};
    enf_stress_run(run->family, run->seed, &harness, &run->result);
}

/// The least of several times, with nothing in between: a small world takes a tenth of a millisecond, and
/// memory that is cold or new to the child takes longer.
static void time_work(void *shared) {
    run *run = shared;
    const enf_stress_options harness = {.time_only = true};
    double least = INFINITY;
    for (int i = 0; i < TIMINGS; i++) {
        enf_stress_run(run->family, run->seed, &harness, &run->result);
        least = fmin(least, run->result.seconds);
    }
    run->result.seconds = least;
}

static enf_status run_seed(tally *tally, int family, uint64_t seed, void (*work)(void *), cli_child *child,
                           enf_error *error) {
    run *run = tally->run;
    memset(run, 0, sizeof *run);
    run->family = family, run->seed = seed, run->folder = tally->settings->folder;
    return cli_child_run(work, run, tally->settings->limit, 0, child, error);
}

static void note_failure(tally *tally, int family, uint64_t seed, const char *kind, const char *reason) {
    if (!enf_array_reserve(tally->failures, tally->failure_capacity, tally->failure_count + 1)) return;
    failure *failure = &tally->failures[tally->failure_count++];
    *failure = (struct failure){.family = family, .seed = seed, .kind = kind};
    snprintf(failure->reason, sizeof failure->reason, "%.300s", reason);
    for (char *c = failure->reason; *c; c++)
        if (*c == '"' || *c == '\n') *c = '\'';
}

static void note_death(tally *tally, int family, uint64_t seed, const cli_child *child) {
    char words[160];
    const char *stage = tally->run->result.stage;
    if (child->timed_out)
        snprintf(words, sizeof words, "more than %g s; last stage %s", tally->settings->limit,
                 stage ? stage : "-");
    else
        snprintf(words, sizeof words, "signal %d; last stage %s", child->signal, stage ? stage : "-");
    note_failure(tally, family, seed, child->timed_out ? "hang" : "crash", words);
    tally->died++;
}

/// ENF_NO_RESOURCES where the harness itself can't work.
static enf_status note_run(tally *tally, int family, uint64_t seed, const cli_child *child, double *time,
                           enf_error *error) {
    const enf_stress_result *result = &tally->run->result;
    *time = -1;
    if (child->signal) {
        note_death(tally, family, seed, child);
        return ENF_OK;
    }
    if (result->outcome == ENF_STRESS_HARNESS)
        return enf_fail(error, ENF_NO_RESOURCES, "family %s, seed %" PRIu64 ": %.300s",
                        enf_stress_family(family, NULL), seed, result->reason);
    static const char *const kinds[] = {
        [ENF_STRESS_REFUSED] = "error", [ENF_STRESS_BROKEN] = "check", [ENF_STRESS_WRONG] = "oracle"};
    if (result->outcome != ENF_STRESS_FINE)
        note_failure(tally, family, seed, kinds[result->outcome], result->reason);
    tally->refused += result->outcome == ENF_STRESS_REFUSED;
    tally->broken += result->outcome == ENF_STRESS_BROKEN;
    tally->wrong += result->outcome == ENF_STRESS_WRONG;
    tally->cells += result->fine_cells;
    tally->points += result->verdict.points;
    tally->segments += result->verdict.segments;
    tally->surfaces += result->verdict.surfaces;
    if (result->fine_cells > 0) *time = result->seconds / result->fine_cells;
    return ENF_OK;
}

// ---------------------------------------------------------------------------------------------- times

static int compare_numbers(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median_of(const double *values, int count) {
    double *sorted = enf_array_new((size_t)count, sizeof *sorted);
    int used = 0;
    for (int i = 0; sorted && i < count; i++)
        if (values[i] >= 0) sorted[used++] = values[i];
    if (used > 0) qsort(sorted, (size_t)used, sizeof *sorted, compare_numbers);
    double median = used > 0 ? sorted[used / 2] : 0;
    free(sorted);
    return median;
}

/// A run that looks slow is timed again: the least time counts, since others use the machine too.
static enf_status time_again(tally *tally, int family, int number, double limit, enf_error *error) {
    uint64_t seed = tally->settings->first + (uint64_t)number;
    double *time = &tally->seconds_a_cell[number];
    enf_status status = ENF_OK;
    for (int i = 0; !status && i<TIMINGS && * time> limit; i++) {
        cli_child child;
        status = run_seed(tally, family, seed, time_work, &child, error);
        const enf_stress_result *result = &tally->run->result;
        if (!status && !child.signal && result->fine_cells > 0)
            *time = fmin(*time, result->seconds / result->fine_cells);
    }
    return status;
}

/// The largest ratio to the median, and its seed.
static enf_status judge_times(tally *tally, int family, double median, double *worst, uint64_t *worst_seed,
                              enf_error *error) {
    *worst = 0;
    *worst_seed = 0;
    enf_status status = ENF_OK;
    for (int i = 0; !status && i < tally->settings->seeds && median > 0; i++) {
        status = time_again(tally, family, i, slow_ratio * median, error);
        double ratio = tally->seconds_a_cell[i] / median;
        uint64_t seed = tally->settings->first + (uint64_t)i;
        if (ratio > *worst) *worst = ratio, *worst_seed = seed;
        if (ratio <= slow_ratio) continue;
        char words[80];
        snprintf(words, sizeof words, "%.1f times the median per output cell", ratio);
        note_failure(tally, family, seed, "slow", words);
        tally->slow++;
    }
    return status;
}

// ---------------------------------------------------------------------------------------------- families

static void print_head(void) {
    puts("family,runs,check_failures,oracle_disagreements,errors,crashes_and_hangs,slow,fine_cells,points_"
         "asked,"
         "segments_asked,surface_points_asked,median_us_per_cell,worst_ratio,worst_seed");
}

static void print_family(const tally *tally, int family, int runs, double median, double worst,
                         uint64_t worst_seed) {
    printf("%s,%d,%d,%d,%d,%d,%d,%" PRId64 ",%" PRId64 ",%" PRId64 ",%" PRId64 ",%.3f,%.2f,%" PRIu64 "\n",
           enf_stress_family(family, NULL), runs, tally->broken, tally->wrong, tally->refused, tally->died,
           tally->slow, tally->cells, tally->points, tally->segments, tally->surfaces, 1e6 * median, worst,
           worst_seed);
    fflush(stdout);
}

static void print_failures(const tally *tally) {
    if (tally->failure_count == 0) return;
    puts("\nfamily,seed,failure,reason");
    for (size_t i = 0; i < tally->failure_count; i++) {
        const failure *failure = &tally->failures[i];
        printf("%s,%" PRIu64 ",%s,\"%s\"\n", enf_stress_family(failure->family, NULL), failure->seed,
               failure->kind, failure->reason);
    }
}

static enf_status run_family(tally *tally, int family, enf_error *error) {
    const settings *settings = tally->settings;
    enf_status status = ENF_OK;
    int runs = 0;
    tally->broken = tally->wrong = tally->refused = tally->died = tally->slow = 0;
    tally->cells = tally->points = tally->segments = tally->surfaces = 0;
    for (; !status && runs < settings->seeds; runs++) {
        cli_child child;
        uint64_t seed = settings->first + (uint64_t)runs;
        if (!cli_progress_report(&tally->progress, enf_stress_family(family, NULL),
                                 (double)runs / settings->seeds)) {
            status = enf_fail(error, ENF_NO_RESOURCES, "interrupted at family %s, seed %" PRIu64,
                              enf_stress_family(family, NULL), seed);
            break;
        }
        status = run_seed(tally, family, seed, work, &child, error);
        if (!status) status = note_run(tally, family, seed, &child, &tally->seconds_a_cell[runs], error);
    }
    double median = median_of(tally->seconds_a_cell, runs), worst = 0;
    uint64_t worst_seed = 0;
    if (!status) status = judge_times(tally, family, median, &worst, &worst_seed, error);
    cli_progress_stop(&tally->progress);
    if (!status) print_family(tally, family, runs, median, worst, worst_seed);
    return status;
}

static int run_families(const settings *settings) {
    enf_error error = {0};
    enf_status status = ENF_OK;
    tally tally = {.settings = settings,
                   .run = cli_shared_new(sizeof *tally.run),
                   .seconds_a_cell = enf_array_new((size_t)settings->seeds, sizeof(double))};
    if (!tally.run || !tally.seconds_a_cell) status = enf_fail_memory(&error, "the table");
    cli_progress_start(&tally.progress, CLI_PROGRESS_AUTO);
    if (!status) print_head();
    for (int family = 0; !status && enf_stress_family(family, NULL); family++)
        if (settings->only < 0 || settings->only == family) status = run_family(&tally, family, &error);
    print_failures(&tally);
    bool all_fine = tally.failure_count == 0;
    cli_shared_free(tally.run, sizeof *tally.run);
    free(tally.seconds_a_cell);
    free(tally.failures);
    if (cli_finish_output()) return ENF_NO_RESOURCES;
    if (status) return cli_fail(&error);
    return all_fine ? ENF_OK : ENF_CHECK_FAILED;
}

// ---------------------------------------------------------------------------------------------- options

static bool read_seed(const char *text, uint64_t *seed) {
    char *end;
    errno = 0;
    unsigned long long number = strtoull(text, &end, 10);
    *seed = number;
    return *text >= '0' && *text <= '9' && !*end && !errno;
}

static int find_family(const char *name) {
    for (int i = 0; enf_stress_family(i, NULL); i++)
        if (strcmp(enf_stress_family(i, NULL), name) == 0) return i;
    return -1;
}

int cli_bench_stability(int argc, char **argv) {
    const char *family = NULL, *first = "0", *folder = getenv("TMPDIR");
    settings settings = {.seeds = 100, .only = -1, .limit = 60, .folder = folder ? folder : P_tmpdir};
    cli_option options[] = {
        {"--seeds", 0, CLI_COUNT, &settings.seeds, "N", "of each family; default 100", NULL, false},
        {"--first", 0, CLI_TEXT, &first, "SEED", "the first seed; default 0", NULL, false},
        {"--family", 0, CLI_TEXT, &family, "NAME", "only this one", NULL, false},
        {"--limit", 0, CLI_LENGTH, &settings.limit, "SECONDS", "CPU seconds for a run; default 60", NULL,
         false},
        {0}};
    const cli_syntax syntax = {
        .command = "enfilade bench stability",
        .usage = "[--seeds N] [--first SEED] [--family NAME] [--limit SECONDS]",
        .summary =
            "Compiles random soups of ten families with one thread, writes each to a file, checks every\n"
            "invariant of it, and asks oracles: rock or air where the soup is made of solids, exact tests "
            "of\n"
            "what lies between two points. A run is slow that takes more than 20 times the family's median\n"
            "time per fine cell, also when it is done again. CSV: a row per family, then one per failure.\n"
            "Exit status 1 if there is one.",
        .options = options};
    cli_texts operands = {0};
    int status = cli_parse(&syntax, argc, argv, &operands);
    if (status >= 0) return status;
    if (!read_seed(first, &settings.first))
        return cli_misuse(&syntax, "--first: '%.100s' is no whole number", first);
    if (family && (settings.only = find_family(family)) < 0)
        return cli_misuse(&syntax, "--family: there is no '%.100s'; the table without it names all", family);
    settings.limit = fmax(settings.limit, 1);
    return run_families(&settings);
}
