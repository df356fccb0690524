// SPDX-License-Identifier: GPL-3.0-or-later
// Run time against error: each rung of the ladder on each level, against the exact sets and against lines
// that the sampler, which shares nothing with the solver, finds and the witness checker confirms.
#include "cli/bench_visibility.h"
#include "base/memory.h"
#include "base/timer.h"
#include "cli/bench.h"
#include "cli/bench_folder.h"
#include "cli/cli.h"
#include "cli/options.h"
#include "format/output.h"
#include "visibility_check/sampler.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { RUNS_MOST = 15, OTHER = ENF_METHOD_COUNT };

typedef struct row {
    int32_t cells, portals;
    double peak_mb;
    int64_t sampled; ///< pairs i < j that the sampler found
    bool has_other;  ///< sets of another program lie beside the portal file
    cli_visibility_measure measures[ENF_METHOD_COUNT + 1];
    int32_t sequence_longest;
} row;

typedef struct table {
    int runs, threads;
    double sample; ///< processor seconds a level
    row sum;
} table;

// ---------------------------------------------------------------------------------------------- one level

static enf_status time_method(const table *table, const enf_portal_graph *graph, enf_method method, row *row,
                              enf_pvs *sets, enf_error *error) {
    const enf_visibility_options options = {.method = method, .threads = table->threads};
    cli_visibility_measure *measure = &row->measures[method];
    double seconds[RUNS_MOST];
    for (int run = 0; run < table->runs; run++) {
        enf_visibility visibility;
        enf_status status = enf_visibility_run(&visibility, graph, &options, error);
        if (status) {
            enf_visibility_free(&visibility);
            return status;
        }
        seconds[run] = visibility.cpu_seconds;
        measure->whole =
            visibility.stabs.zero_by_whole + visibility.stabs.programs + visibility.stabs.quadrics;
        row->sequence_longest = visibility.sequence_longest;
        enf_pvs_free(sets);
        *sets = visibility.pvs;
        visibility.pvs = (enf_pvs){0};
        enf_visibility_free(&visibility);
    }
    measure->seconds = cli_median(seconds, (size_t)table->runs);
    return ENF_OK;
}

/// Pairs i < j that one has and the other has not. Of sets that are not symmetric, either way counts.
static int64_t count_more(const enf_pvs *sets, const enf_pvs *than) {
    int64_t count = 0;
    for (int32_t i = 0; i < sets->cell_count; i++)
        for (int32_t j = i + 1; j < sets->cell_count; j++)
            count += (enf_pvs_get(sets, i, j) || enf_pvs_get(sets, j, i)) &&
                     !(enf_pvs_get(than, i, j) || enf_pvs_get(than, j, i));
    return count;
}

/// Adds to the truth what lines show.
static enf_status sample(const enf_portal_graph *graph, double seconds, enf_pvs *truth, int64_t *sampled,
                         enf_error *error) {
    enf_sampler sampler;
    enf_witness_checker checker = {0};
    enf_status status = enf_sampler_make(&sampler, graph, 1, error);
    if (!status) status = enf_sampler_run(&sampler, seconds, 0, error);
    if (!status && !enf_witness_checker_make(&checker, graph)) status = enf_fail_memory(error, "the checker");
    for (int32_t i = 0; !status && i < graph->cell_count; i++)
        for (int32_t j = i + 1; j < graph->cell_count; j++) {
            enf_witness witness;
            if (!enf_sampler_witness(&sampler, i, j, &witness)) continue;
            ++*sampled;
            if (enf_pvs_get(truth, i, j) || enf_witness_check(&checker, &witness).fault) continue;
            enf_pvs_set(truth, i, j);
            enf_pvs_set(truth, j, i);
        }
    enf_witness_checker_free(&checker);
    enf_sampler_free(&sampler);
    return status;
}

/// The sets that another program has left beside the portal file, if there are any.
static bool read_other(const char *path, int32_t cells, enf_pvs *sets) {
    size_t length = strlen(path);
    char *name = malloc(length + sizeof ".pvs.txt.gz");
    bool found = false;
    if (name) {
        memcpy(name, path, length + 1);
        char *dot = strstr(strrchr(name, '/') ? strrchr(name, '/') : name, ".prt");
        memcpy(dot, ".pvs.txt.gz", sizeof ".pvs.txt.gz");
        enf_error error;
        found = access(name, R_OK) == 0 && enf_pvs_read(sets, name, cells, &error) == ENF_OK;
    }
    free(name);
    return found;
}

static void compare(cli_visibility_measure *measure, const enf_pvs *sets, const enf_pvs *truth) {
    measure->pairs = enf_pvs_pairs(sets);
    measure->missed = count_more(truth, sets);
    measure->wrong = count_more(sets, truth);
}

static enf_status measure_level(const table *table, const char *path, row *row, enf_error *error) {
    enf_portal_graph graph;
    enf_pvs sets[ENF_METHOD_COUNT + 1] = {{0}}, truth = {0};
    enf_status status = enf_portal_graph_read(&graph, path, error);
    for (int m = 0; m < ENF_METHOD_COUNT && !status; m++)
        status = time_method(table, &graph, (enf_method)m, row, &sets[m], error);
    if (!status) {
        row->peak_mb = (double)enf_memory_peak() / 1e6; // the sampler is not part of it
        row->cells = graph.cell_count;
        row->portals = graph.opening_count;
        row->has_other = read_other(path, graph.cell_count, &sets[OTHER]);
        status = enf_pvs_new(&truth, graph.cell_count, error);
    }
    if (!status)
        memcpy(truth.rows, sets[ENF_METHOD_EXACT].rows,
               (size_t)truth.cell_count * truth.row_words * sizeof *truth.rows);
    if (!status && table->sample > 0) status = sample(&graph, table->sample, &truth, &row->sampled, error);
    for (int m = 0; m < ENF_METHOD_COUNT + row->has_other && !status; m++)
        compare(&row->measures[m], &sets[m], &truth);
    for (int m = 0; m <= ENF_METHOD_COUNT; m++) enf_pvs_free(&sets[m]);
    enf_pvs_free(&truth);
    enf_portal_graph_free(&graph);
    return status;
}

static int work(void *user, const char *path, const char *name, void *result) {
    (void)name; // the path says it
    enf_error error = {0};
    enf_status status = measure_level(user, path, result, &error);
    return status ? cli_folder_fail(path, &error) : ENF_OK;
}

// ---------------------------------------------------------------------------------------------- the table

static void print_head(void *user) {
    (void)user;
    puts("level,cells,portals,method,cpu_s,peak_mb,pairs,missed,wrong,whole_number_decisions,sampled,longest_"
         "line");
}

static void print_measures(const char *name, const row *row) {
    for (int m = 0; m < ENF_METHOD_COUNT + row->has_other; m++) {
        const cli_visibility_measure *measure = &row->measures[m];
        printf("%s,%" PRId32 ",%" PRId32 ",%s,", name, row->cells, row->portals,
               m == OTHER ? "other" : enf_method_name((enf_method)m));
        if (m == OTHER)
            printf(",");
        else
            printf("%.3f,%.1f", measure->seconds, row->peak_mb);
        printf(",%" PRId64 ",%" PRId64 ",%" PRId64 ",%" PRId64 ",%" PRId64 ",%" PRId32 "\n", measure->pairs,
               measure->missed, measure->wrong, measure->whole, row->sampled,
               m == ENF_METHOD_EXACT ? row->sequence_longest : 0);
    }
}

static void print_row(void *user, const char *name, const void *result) {
    table *table = user;
    const row *row = result;
    print_measures(name, row);
    fflush(stdout);
    table->sum.cells += row->cells;
    table->sum.portals += row->portals;
    table->sum.sampled += row->sampled;
    table->sum.has_other |= row->has_other;
    if (table->sum.peak_mb < row->peak_mb) table->sum.peak_mb = row->peak_mb;
    if (table->sum.sequence_longest < row->sequence_longest)
        table->sum.sequence_longest = row->sequence_longest;
    for (int m = 0; m <= ENF_METHOD_COUNT; m++) {
        cli_visibility_measure *sum = &table->sum.measures[m];
        sum->seconds += row->measures[m].seconds;
        sum->pairs += row->measures[m].pairs;
        sum->missed += row->measures[m].missed;
        sum->wrong += row->measures[m].wrong;
        sum->whole += row->measures[m].whole;
    }
}

static int draw(const table *table, const char *path) {
    enf_output output;
    enf_error error = {0};
    enf_status status = enf_output_open(&output, path, &error);
    if (!status) {
        cli_visibility_plot(table->sum.measures, "Visible sets: run time against error", output.file);
        status = enf_output_commit(&output, &error);
    }
    return status ? cli_fail(&error) : ENF_OK;
}

int cli_bench_visibility(int argc, char **argv) {
    static const char *const endings[] = {".prt", ".prt.gz", NULL};
    table table = {.runs = 3, .threads = 1};
    const char *svg = NULL;
    cli_folder folder = {.user = &table,
                         .endings = endings,
                         .work = work,
                         .row_size = sizeof(row),
                         .print = print_row,
                         .print_head = print_head};
    cli_option options[] = {{"--runs", 0, CLI_COUNT, &table.runs, "N",
                             "medians over so many runs, at most 15; default 3", NULL, false},
                            {"--threads", 0, CLI_COUNT, &table.threads, "N", "default 1", NULL, false},
                            {"--sample", 0, CLI_LENGTH, &table.sample, "SECONDS",
                             "processor time for lines to check against, a level; default 0", NULL, false},
                            {"--svg", 0, CLI_TEXT, &svg, "FILE", "a picture of the sums", NULL, false},
                            CLI_LEVELS_OPTION(folder),
                            {0}};
    const cli_syntax syntax = {
        .command = "enfilade bench visibility",
        .usage = "DIR [--runs N] [--threads N] [--sample SECONDS] [--svg FILE] [--levels GLOB]",
        .summary =
            "Every rung of the ladder on every portal file (.prt) in a folder, in processor seconds. Pairs "
            "are\n"
            "directed, with every cell's own; missed (not in the sets, but in the exact ones or shown by a "
            "line\n"
            "of the sampler) and wrong (in the sets, but not so) count pairs once. Sets that lie beside a\n"
            "portal file as NAME.pvs.txt.gz are a row, `other`. CSV; the last rows have the sums.",
        .options = options,
        .operands_min = 1,
        .operands_max = 1,
        .operand = "the folder"};
    cli_texts operands = {0};
    int status = cli_parse(&syntax, argc, argv, &operands);
    if (status < 0) {
        if (table.runs > RUNS_MOST) table.runs = RUNS_MOST;
        folder.path = operands.items[0];
        status = cli_folder_visit(&folder);
        if (table.sum.cells > 0) print_measures("all (peak: largest)", &table.sum);
        if (cli_finish_output()) status = ENF_NO_RESOURCES;
        if (!status && svg) status = draw(&table, svg);
    }
    free(operands.items);
    return status;
}
