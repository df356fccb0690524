// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade pvs: a portal graph in, out which cells see which.
#include "base/hash.h"
#include "base/memory.h"
#include "base/timer.h"
#include "cli/cli.h"
#include "cli/heap.h"
#include "cli/job.h"
#include "cli/paths.h"
#include "cli/pvs_report.h"
#include "cli/pvs_team.h"
#include "enfilade/run.h"
#include "format/output.h"
#include "visibility/read_prt.h"
#include "visibility/witness.h"
#include "visibility/world_visibility.h"

#include <inttypes.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct request {
    cli_texts inputs;
    const char *output, *report, *witness, *checkpoint;
    int method, threads, progress;
    double budget;
    bool verbose, quiet;
    const enf_team *team; ///< or null
    bool leads;           ///< alone, or rank 0: it reads, writes and speaks
} request;

/// A world file: its cells are those that it was compiled into.
static enf_status read_world(cli_pvs_result *result, const enf_source *source, enf_error *error) {
    enf_error wrong = {0};
    enf_status status = enf_world_open_memory(&result->world, source->data, source->size, NULL, &wrong);
    if (status) return enf_fail(error, status, "%s: %.900s", source->name, wrong.text);
    const enf_file_view *view = enf_world_file(result->world);
    result->cell_count = result->leaf_count = view->cell_count;
    result->portal_count = view->portal_count / 2;
    return ENF_OK;
}

/// What kind of file it is, its content says.
static enf_status read_graph(cli_pvs_result *result, enf_source *source, enf_error *error) {
    static const char magic[] = ENF_FILE_MAGIC;
    bool is_world = source->size >= strlen(magic) && memcmp(source->data, magic, strlen(magic)) == 0;
    result->input_hash = enf_hash64(source->data, source->size, 0);
    if (is_world) return read_world(result, source, error);
    enf_status status = enf_read_prt(&result->graph, source, error);
    if (!status) enf_portal_graph_find_non_convex(&result->graph);
    result->cell_count = result->graph.cell_count;
    result->portal_count = result->graph.opening_count;
    result->leaf_count = result->graph.leaf_count ? result->graph.leaf_count : result->graph.cell_count;
    return status;
}

enum { SHARED_HEADER = 16 }; ///< world files must be aligned

/// The others get the source from rank 0: first its status, then, if that is fine, the bytes, into *bytes.
static enf_status share_source(const enf_team *team, enf_status status, enf_source *source, enf_bytes *bytes,
                               enf_error *error) {
    const char *name = source->name;
    if (team->rank == 0) {
        enf_put_word(bytes, status, 8);
        enf_put_word(bytes, 0, SHARED_HEADER - 8);
        if (!status) enf_put_bytes(bytes, source->data, source->size + 1);
    }
    if (bytes->failed || !team->share(team->user, bytes)) return enf_fail_memory(error, "the input");
    if (team->rank == 0 || bytes->data[0]) return (enf_status)bytes->data[0];
    return enf_source_over(source, name, (const char *)bytes->data + SHARED_HEADER,
                           bytes->count - SHARED_HEADER - 1, error);
}

/// What stays until the end, as a world lies in it.
typedef struct input {
    enf_source source;
    enf_bytes bytes; ///< of rank 0's source
} input;

/// Reads the input, unless something failed before. All processes come to the same; rank 0 alone has words
/// for what fails.
static enf_status load(cli_pvs_result *result, const request *request, input *input, enf_status status,
                       enf_error *error) {
    const char *path = request->inputs.items[0];
    input->source.name = path;
    result->input = strcmp(path, "-") == 0 ? "standard input" : path;
    if (!status && request->leads) status = enf_source_open(&input->source, path, error);
    if (request->team) status = share_source(request->team, status, &input->source, &input->bytes, error);
    if (!status) status = read_graph(result, &input->source, error);
    if (!status && result->world && request->witness)
        status = enf_fail(error, ENF_BAD_USAGE,
                          "--witness: %s is a world, whose cells are not convex; lines can be had for portal "
                          "files only",
                          result->input);
    if (!request->leads) error->text[0] = 0;
    return status;
}

static void close_input(cli_pvs_result *result, input *input) {
    enf_world_close(result->world);
    enf_source_close(&input->source);
    enf_bytes_free(&input->bytes);
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

static enf_status find_in_world(cli_pvs_result *result, enf_error *error) {
    enf_world_air air;
    const enf_file_view *view = enf_world_file(result->world);
    enf_status status = enf_world_air_make(&air, view, false, result->options.threads, error);
    if (!status) status = enf_world_visibility_run(&result->visibility, &air, view, &result->options, error);
    enf_world_air_free(&air);
    return status;
}

static enf_status find(cli_pvs_result *result, const request *request, enf_error *error) {
    enf_status status =
        result->world ? find_in_world(result, error)
                      : enf_visibility_run(&result->visibility, &result->graph, &result->options, error);
    if (!status) return ENF_OK;
    enf_error why = *error;
    if (!request->leads)
        enf_fail(error, status, "rank %d: %.1000s", request->team->rank, why.text);
    else if (cli_was_interrupted())
        enf_fail(error, ENF_NO_RESOURCES, "%s; %s was not written%s%s",
                 request->team ? "stopped: cancelled, or a process was lost" : "cancelled", request->output,
                 request->checkpoint ? "; the same command goes on from what is in " : "",
                 request->checkpoint ? request->checkpoint : "");
    return error->status;
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

static void prepare(cli_pvs_result *result, const request *request, cli_progress *progress) {
    if (request->leads) {
        cli_progress_start(progress, (cli_progress_mode)request->progress);
    } else { // rank 0 ends all when it is asked to
        signal(SIGINT, SIG_IGN);
        signal(SIGTERM, SIG_IGN);
    }
    result->processes = request->team ? request->team->size : 1;
    result->options = (enf_visibility_options){.method = (enf_method)request->method,
                                               .threads = request->threads,
                                               .want_witnesses = request->witness != NULL,
                                               .progress = request->leads ? cli_progress_report : NULL,
                                               .progress_user = progress,
                                               .budget_seconds = request->budget,
                                               .checkpoint = request->checkpoint,
                                               .team = request->team};
}

/// What rank 0 does at the end. A checkpoint stays if it can still be of use: with a larger budget.
static enf_status finish(cli_pvs_result *result, const request *request, outputs *outputs, double started,
                         enf_error *error) {
    result->seconds = enf_timer_now() - started;
    result->peak_bytes = enf_memory_peak();
    enf_status status = write_outputs(request, result, outputs, error);
    if (!status && request->checkpoint && !cli_pvs_is_late(result)) unlink(request->checkpoint);
    return status;
}

static int run(const request *request) {
    cli_pvs_result result = {0};
    enf_error error = {0};
    input input = {0};
    outputs outputs = {0};
    cli_progress progress = {0};
    double started = enf_timer_now();
    cli_heap_divide();
    prepare(&result, request, &progress);
    if (request->leads) cli_progress_report(&progress, "read", 0);
    enf_status status = request->leads ? open_outputs(request, &outputs, &error) : ENF_OK;
    status = load(&result, request, &input, status, &error);
    bool begun = !status; // from here on, who fails fails alone
    if (begun) status = find(&result, request, &error);
    bool alone = begun && status;
    if (!status && request->leads) {
        cli_progress_report(&progress, "write", 0);
        status = finish(&result, request, &outputs, started, &error);
    }
    if (request->leads) cli_progress_stop(&progress);
    discard_outputs(&outputs);
    if (!status && request->leads && !request->quiet) tell(&result, request);
    enf_visibility_free(&result.visibility);
    enf_portal_graph_free(&result.graph);
    close_input(&result, &input);
    if (status && error.text[0]) fprintf(stderr, "%s\n", error.text);
    if (alone) cli_team_abort(request->team, (int)status);
    return (int)status;
}

static int check(const cli_syntax *syntax, const request *request) {
    const char *outputs[] = {request->output, request->report, request->witness, request->checkpoint};
    if (!request->output) return cli_misuse(syntax, "-o OUT is missing");
    if (request->verbose && request->quiet) return cli_misuse(syntax, "-v and -q contradict each other");
    if (request->checkpoint && strcmp(request->checkpoint, "-") == 0)
        return cli_misuse(syntax, "--checkpoint: '-' is no file that could be read again");
    const char *clash = cli_find_clash(&request->inputs, outputs, 4);
    if (clash)
        return cli_misuse(syntax, "'%.100s' would be written over; give every file a name of its own", clash);
    return -1;
}

/// -1: go on. All processes have the same words; rank 0 alone complains of them.
static int understand(const cli_syntax *syntax, int argc, char **argv, request *request) {
    enf_bytes answer = {0};
    int status = -1;
    if (request->leads) {
        status = cli_parse(syntax, argc, argv, &request->inputs);
        if (status < 0) status = check(syntax, request);
    }
    if (request->team) {
        if (request->leads) enf_put_word(&answer, (uint64_t)(status + 1), 1);
        if (!request->team->share(request->team->user, &answer) || answer.count == 0)
            status = ENF_NO_RESOURCES;
        else
            status = answer.data[0] - 1;
        enf_bytes_free(&answer);
    }
    return status < 0 && !request->leads ? cli_parse(syntax, argc, argv, &request->inputs) : status;
}

/// The command of one process.
static int run_one(int argc, char **argv, const enf_team *team) {
    request request = {.method = ENF_METHOD_EXACT,
                       .threads = cli_team_threads(team),
                       .team = team,
                       .leads = !team || team->rank == 0};
    cli_option options[] = {
        {"--output", 'o', CLI_TEXT, &request.output, "OUT", "the text file to write", NULL, false},
        {"--method", 0, CLI_CHOICE, &request.method, "METHOD",
         "reach, facing, hourglass, lp or exact (default), from cheap to exact",
         cli_pvs_choices + CLI_PVS_METHOD, false},
        {"--threads", 0, CLI_COUNT, &request.threads, "N", "default: one per core; the result is the same",
         NULL, false},
        {"--budget", 0, CLI_SECONDS, &request.budget, "TIME",
         "60s, 5m, 2h: what is not decided by then counts as seen; default 0: no end", NULL, false},
        {"--checkpoint", 0, CLI_TEXT, &request.checkpoint, "FILE",
         "keep what is done in FILE; go on from it if it is there; removed at the end", NULL, false},
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
    int status = understand(&syntax, argc, argv, &request);
    if (status < 0) status = run(&request);
    free(request.inputs.items);
    return status;
}

int cli_pvs(int argc, char **argv) {
    const enf_team *team = cli_team_join();
    int status = run_one(argc, argv, team);
    cli_team_leave(team);
    return status;
}
