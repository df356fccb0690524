// SPDX-License-Identifier: GPL-3.0-or-later
// Soup to cells against the Delaunay triangulation alone. Both work on one thread in the same process, turn
// and turn about, and processor time is what counts, so that a busy machine disturbs both alike. The peak is
// taken when the first run has ended, before the yardstick has allocated anything; it holds the libraries,
// the soup and the reading of it.
#include "base/array.h"
#include "base/memory.h"
#include "base/timer.h"
#include "build/build.h"
#include "cli/bench.h"
#include "cli/bench_folder.h"
#include "cli/cli.h"
#include "cli/job.h"
#include "shim/shim.h"

#include <stdio.h>
#include <stdlib.h>

enum { STAGES = ENF_STAGE_COLOUR + 1, RUNS_DEFAULT = 5 };

/// Columns of the table; seconds are medians over the runs.
enum {
    TRIANGLES,
    TETRAHEDRA,
    FINE_CELLS,
    CELL_RATIO,
    DELAUNAY,
    STAGE,
    TOTAL = STAGE + STAGES,
    TIME_RATIO,
    PEAK,
    EXACT, ///< share of the predicates that only whole numbers could decide
    COLUMN_COUNT
};

static const struct column {
    const char *name;
    int digits; ///< after the point
} columns[COLUMN_COUNT] = {
    {"triangles", 0},  {"tetrahedra", 0},  {"fine_cells", 0},       {"fine_cells/tetrahedra", 3},
    {"delaunay_s", 4}, {"clean_s", 4},     {"tetrahedralize_s", 4}, {"split_s", 4},
    {"connect_s", 4},  {"colour_s", 4},    {"total_s", 4},          {"total/delaunay", 2},
    {"peak_mb", 1},    {"exact_share", 5},
};

typedef struct row {
    double column[COLUMN_COUNT];
} row;

typedef struct table {
    int runs;
    row *rows;
    size_t count, capacity;
} table;

/// Seconds of every run, per column of the row.
typedef struct clocks {
    double *delaunay, *stage[STAGES], *total;
} clocks;

static bool make_clocks(clocks *clocks, int runs) {
    bool good = (clocks->delaunay = enf_array_new((size_t)runs, sizeof(double))) != NULL;
    good = (clocks->total = enf_array_new((size_t)runs, sizeof(double))) && good;
    for (int i = 0; i < STAGES; i++)
        good = (clocks->stage[i] = enf_array_new((size_t)runs, sizeof(double))) && good;
    return good;
}

static void free_clocks(clocks *clocks) {
    free(clocks->delaunay);
    free(clocks->total);
    for (int i = 0; i < STAGES; i++) free(clocks->stage[i]);
}

static size_t count_triangles(const enf_soup *soup) {
    size_t count = 0;
    for (size_t p = 0; p < soup->polygon_count; p++) {
        int64_t corners = soup->polygon_corner[p + 1] - soup->polygon_corner[p];
        count += corners > 2 ? (size_t)corners - 2 : 0;
    }
    return count;
}

/// The recipe to colour, once, then the yardstick. The soup is borrowed, and given back as it was.
static enf_status run_once(enf_soup *soup, int run, clocks *clocks, row *row, enf_error *error) {
    enf_build_options options = {
        .clean = {.weld = -1, .plane_tolerance = -1}, .keep = ENF_KEEP_ALL, .threads = 1, .stages = STAGES};
    enf_build build = {.soup = *soup};
    size_t rejected = soup->rejected_count, tetrahedra;
    double started = enf_timer_cpu();
    enf_status status = enf_build_run(&build, &options, error);
    clocks->total[run] = enf_timer_cpu() - started;
    for (int i = 0; i < STAGES && !status; i++) clocks->stage[i][run] = build.stages[i].cpu_seconds;
    if (run == 0) {
        row->column[PEAK] = (double)enf_memory_peak() / 1e6;
        row->column[TETRAHEDRA] = build.complex.tetrahedron_count;
        row->column[FINE_CELLS] = build.complex.cell_count;
        row->column[EXACT] = enf_complex_tier_share(&build.complex, ENF_TIER_EXACT);
        row->column[CELL_RATIO] = row->column[FINE_CELLS] / row->column[TETRAHEDRA];
    }
    if (!status)
        status = enf_shim_delaunay_time(build.mesh.points, build.mesh.point_count, &clocks->delaunay[run],
                                        &tetrahedra, error);
    *soup = build.soup;
    soup->rejected_count = rejected;
    build.soup = (enf_soup){0};
    enf_build_free(&build);
    return status;
}

static enf_status measure(const table *table, const char *path, row *row, enf_error *error) {
    enf_soup soup = {0};
    clocks clocks = {0};
    enf_status status = make_clocks(&clocks, table->runs) ? ENF_OK : enf_fail_memory(error, "the clocks");
    if (!status) status = enf_soup_read(&soup, path, error);
    for (int run = 0; run < table->runs && !status; run++) status = run_once(&soup, run, &clocks, row, error);
    if (!status) {
        size_t runs = (size_t)table->runs;
        row->column[TRIANGLES] = (double)count_triangles(&soup);
        row->column[DELAUNAY] = cli_median(clocks.delaunay, runs);
        for (int i = 0; i < STAGES; i++) row->column[STAGE + i] = cli_median(clocks.stage[i], runs);
        row->column[TOTAL] = cli_median(clocks.total, runs);
        row->column[TIME_RATIO] = row->column[TOTAL] / row->column[DELAUNAY];
    }
    free_clocks(&clocks);
    enf_soup_free(&soup);
    return status;
}

static int work(void *user, const char *path, const char *name, void *result) {
    (void)name; // the path says it
    enf_error error = {0};
    enf_status status = measure(user, path, result, &error);
    return status ? cli_folder_fail(path, &error) : ENF_OK;
}

static void print_head(void *user) {
    (void)user;
    fputs("level", stdout);
    for (int i = 0; i < COLUMN_COUNT; i++) printf(",%s", columns[i].name);
    putchar('\n');
}

static void print_columns(const char *name, const row *row) {
    fputs(name, stdout);
    for (int i = 0; i < COLUMN_COUNT; i++) printf(",%.*f", columns[i].digits, row->column[i]);
    putchar('\n');
}

static void print_row(void *user, const char *name, const void *result) {
    table *table = user;
    print_columns(name, result);
    if (enf_array_reserve(table->rows, table->capacity, table->count + 1))
        table->rows[table->count++] = *(const row *)result;
}

/// The middle of each column; of the peaks, the largest.
static void print_medians(const table *table) {
    row last = {0};
    double *values = enf_array_new(table->count, sizeof *values);
    for (int i = 0; values && i < COLUMN_COUNT; i++) {
        for (size_t k = 0; k < table->count; k++) values[k] = table->rows[k].column[i];
        last.column[i] = cli_median(values, table->count);
        if (i == PEAK && table->count) last.column[i] = values[table->count - 1]; // sorted by now
    }
    if (values && table->count) print_columns("median (peak: largest)", &last);
    free(values);
}

int cli_bench_cells(int argc, char **argv) {
    table table = {.runs = RUNS_DEFAULT};
    cli_folder folder = {
        .user = &table, .work = work, .row_size = sizeof(row), .print = print_row, .print_head = print_head};
    cli_option options[] = {
        {"--runs", 0, CLI_COUNT, &table.runs, "N", "medians over so many runs; default 5", NULL, false},
        CLI_LEVELS_OPTION(folder),
        {0}};
    const cli_syntax syntax = {
        .command = "enfilade bench cells",
        .usage = "DIR [--runs N] [--levels GLOB]",
        .summary =
            "Soup to coloured cells (clean, tetrahedralize, split, connect, colour) of every level in a\n"
            "folder, on one thread, in processor seconds, against CGAL's spatially sorted Delaunay\n"
            "triangulation of the same vertices. Peak memory is that of the whole process up to colour,\n"
            "reading included; exact_share is of the predicates that only whole numbers could decide. "
            "CSV;\n"
            "the last row has the medians and the largest peak.",
        .options = options,
        .operands_min = 1,
        .operands_max = 1,
        .operand = "the folder"};
    cli_texts operands = {0};
    int status = cli_parse(&syntax, argc, argv, &operands);
    if (status < 0) {
        folder.path = operands.items[0];
        status = cli_folder_visit(&folder);
        print_medians(&table);
        if (cli_finish_output()) status = ENF_NO_RESOURCES;
    }
    free(table.rows);
    free(operands.items);
    return status;
}
