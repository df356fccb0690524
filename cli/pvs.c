// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade pvs: a portal graph in, out which cells see which.
#include "base/hash.h"
#include "base/memory.h"
#include "base/timer.h"
#include "cli/cli.h"
#include "cli/job.h"
#include "cli/paths.h"
#include "cli/pvs_report.h"
#include "enfilade/run.h"
#include "format/output.h"
#include "visibility/read_prt.h"
#include "visibility/witness.h"
#include "visibility/world_graph.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

typedef struct request {
    cli_texts inputs;
    const char *output, *report, *witness;
    int method, threads, progress;
    double budget;
    bool verbose, quiet;
} request;

/// The graph of a world file: its cells are those that it was compiled into.
static enf_status read_world(enf_portal_graph *graph, const enf_source *source, enf_error *error) {
    enf_world *world = NULL;
    enf_error wrong = {0};
    enf_status status = enf_world_open_memory(&world, source->data, source->size, NULL, &wrong);
    if (status) enf_fail(error, status, "%s: %.900s", source->name, wrong.text);
    if (!status) status = enf_world_graph_make(graph, enf_world_file(world), error);
    enf_world_close(world);
    return status;
}

/// What kind of file it is, its content says.
static enf_status read_graph(cli_pvs_result *result, const char *path, enf_error *error) {
    static const char magic[] = ENF_FILE_MAGIC;
    enf_source source;
    bool is_world = false; // its cells need not be convex: no reason to warn
    enf_status status = enf_source_open(&source, path, error);
    if (!status) {
        result->input = strcmp(path, "-") == 0 ? "standard input" : path;
        result->input_hash = enf_hash64(source.data, source.size, 0);
        is_world = source.size >= strlen(magic) && memcmp(source.data, magic, strlen(magic)) == 0;
        if (is_world)
            status = read_world(&result->graph, &source, error);
        else
            status = enf_read_prt(&result->graph, &source, error);
    }
    enf_source_close(&source);
    if (!status && !is_world) enf_portal_graph_find_non_convex(&result->graph);
    return status;
}

/// All are opened before the work begins, so that a wrong path is told at once.
typedef struct outputs {
    enf_output sets, report, witness;
} outputs;

static enf_status open_outputs(const request *request, outputs *outputs, enf_error *error) {
    enf_status status = enf_output_open(&outputs->sets, request->output, error);
    if (!status && request->report) status = enf_output_open(&outputs->report, request->report, error);
    if (!status && request->witness) status = enf_output_open(&outputs->witness, request->witness, error);
    return status;
}

static void discard_outputs(outputs *outputs) {
    enf_output_discard(&outputs->sets);
    enf_output_discard(&outputs->report);
    enf_output_discard(&outputs->witness);
}

/// The visible sets come last: when they are there, so is everything else.
static enf_status write_outputs(const request *request, const cli_pvs_result *result, outputs *outputs,
                                enf_error *error) {
    enf_status status = ENF_OK;
    enf_pvs_print(&result->visibility.pvs, outputs->sets.file);
    if (request->witness) status = enf_witnesses_print(&result->visibility, outputs->witness.file, error);
    if (request->report) cli_pvs_report_json(result, outputs->report.file);
    if (!status && request->witness) status = enf_output_commit(&outputs->witness, error);
    if (!status && request->report) status = enf_output_commit(&outputs->report, error);
    if (!status) status = enf_output_commit(&outputs->sets, error);
    return status;
}

static enf_status find(cli_pvs_result *result, const request *request, cli_progress *progress,
                       enf_error *error) {
    double started = enf_timer_now();
    cli_progress_report(progress, "read", 0);
    enf_status status = read_graph(result, request->inputs.items[0], error);
    if (!status && cli_was_interrupted()) status = ENF_NO_RESOURCES;
    if (!status) status = enf_visibility_run(&result->visibility, &result->graph, &result->options, error);
    if (!status && !cli_progress_report(progress, "write", 0)) status = ENF_NO_RESOURCES;
    result->seconds = enf_timer_now() - started;
    result->peak_bytes = enf_memory_peak();
    return status;
}

static void warn_of_shape(const enf_portal_graph *graph) {
    if (graph->non_convex_cells == 1)
        fprintf(stderr, "warning: cell %" PRId32 " is not convex; it is handled conservatively\n",
                graph->first_non_convex_cell);
    else if (graph->non_convex_cells > 1)
        fprintf(stderr,
                "warning: %" PRId32 " cells are not convex (first: cell %" PRId32
                "); they are handled conservatively\n",
                graph->non_convex_cells, graph->first_non_convex_cell);
}

static void tell(const cli_pvs_result *result, const request *request) {
    warn_of_shape(&result->graph);
    if (request->verbose) cli_pvs_report_verbose(result, stderr);
    cli_pvs_report_summary(result, request->output, stderr);
}

static int run(const request *request) {
    cli_pvs_result result = {0};
    enf_error error = {0};
    outputs outputs = {0};
    cli_progress progress;
    cli_progress_start(&progress, (cli_progress_mode)request->progress);
    result.options = (enf_visibility_options){.method = (enf_method)request->method,
                                              .threads = request->threads,
                                              .want_witnesses = request->witness != NULL,
                                              .progress = cli_progress_report,
                                              .progress_user = &progress,
                                              .budget_seconds = request->budget};
    enf_status status = open_outputs(request, &outputs, &error);
    if (!status) status = find(&result, request, &progress, &error);
    if (!status) status = write_outputs(request, &result, &outputs, &error);
    cli_progress_stop(&progress);
    discard_outputs(&outputs);
    if (status && cli_was_interrupted())
        status = enf_fail(&error, ENF_NO_RESOURCES, "cancelled; %s was not written", request->output);
    else if (!status && !request->quiet)
        tell(&result, request);
    enf_visibility_free(&result.visibility);
    enf_portal_graph_free(&result.graph);
    return status ? cli_fail(&error) : ENF_OK;
}

static int check_and_run(const cli_syntax *syntax, const request *request) {
    const char *outputs[] = {request->output, request->report, request->witness};
    if (!request->output) return cli_misuse(syntax, "-o OUT is missing");
    if (request->verbose && request->quiet) return cli_misuse(syntax, "-v and -q contradict each other");
    const char *clash = cli_find_clash(&request->inputs, outputs, 3);
    if (clash)
        return cli_misuse(syntax, "'%.100s' would be written over; give every file a name of its own", clash);
    return run(request);
}

int cli_pvs(int argc, char **argv) {
    request request = {.method = ENF_METHOD_EXACT, .threads = cli_default_threads()};
    cli_option options[] = {
        {"--output", 'o', CLI_TEXT, &request.output, "OUT", "the text file to write", NULL, false},
        {"--method", 0, CLI_CHOICE, &request.method, "METHOD",
         "reach, facing, hourglass, lp or exact (default), from cheap to exact",
         cli_pvs_methods + 1, // without "none"
         false},
        {"--threads", 0, CLI_COUNT, &request.threads, "N", "default: one per core; the result is the same",
         NULL, false},
        {"--budget", 0, CLI_LENGTH, &request.budget, "SECONDS",
         "what is not decided by then counts as seen; default 0: no end", NULL, false},
        {"--report", 0, CLI_TEXT, &request.report, "FILE.json", "write what was done, for scripts", NULL,
         false},
        {"--witness", 0, CLI_TEXT, &request.witness, "FILE",
         "write a sight line for each pair that was proved: i j x y z x y z", NULL, false},
        {"--progress", 0, CLI_CHOICE, &request.progress, "MODE", "auto (default), always or never",
         cli_progress_modes, false},
        {"--verbose", 'v', CLI_FLAG, &request.verbose, NULL, "say how much was looked at", NULL, false},
        {"--quiet", 'q', CLI_FLAG, &request.quiet, NULL, "errors only", NULL, false},
        {0},
    };
    const cli_syntax syntax = {
        .command = "enfilade pvs",
        .usage = "IN.prt|WORLD.enf -o OUT [options]",
        .summary =
            "Finds which cells see which, of a portal file (PRT1, PRT1-AM or PRT2, gzipped or not)\n"
            "or of a compiled world. Cells that are not convex see at least what they should.\n"
            "Line i of OUT, from 0 on, has the numbers of the cells that cell i sees, itself included.",
        .options = options,
        .operands_min = 1,
        .operands_max = 1,
        .operand = "the input file"};
    int status = cli_parse(&syntax, argc, argv, &request.inputs);
    if (status < 0) status = check_and_run(&syntax, &request);
    free(request.inputs.items);
    return status;
}
