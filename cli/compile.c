// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade compile: polygons in, world file out.
#include "base/timer.h"
#include "build/write.h"
#include "cli/cli.h"
#include "cli/heap.h"
#include "cli/paths.h"
#include "cli/report.h"
#include "format/output.h"
#include "format/save.h"
#include "visibility/world_pvs.h"

#include <inttypes.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct request {
    cli_settings settings;
    cli_texts inputs;
    const char *output, *report, *leak;
    int progress;
    bool verbose, quiet;
} request;

/// No output may replace an input or another output.
static const char *find_clash(const request *request) {
    const char *outputs[] = {request->output, request->report, request->leak};
    return cli_find_clash(&request->inputs, outputs, 3);
}

static bool ends_with(const char *text, const char *ending) {
    size_t length = strlen(text), tail = strlen(ending);
    return length >= tail && strcmp(text + length - tail, ending) == 0;
}

/// The way out as a polyline: an OBJ line, or the .pts file that level editors load.
static void print_leak(const cli_job *job, const char *path, FILE *out) {
    const enf_regions *regions = &job->build.regions;
    bool obj = ends_with(path, ".obj");
    for (int32_t i = 0; i < regions->leak_point_count; i++) {
        double at[3];
        enf_frame_to_world(&job->build.mesh.frame, regions->leak_points[i], at);
        fprintf(out, "%s%.15g %.15g %.15g\n", obj ? "v " : "", at[0], at[1], at[2]);
    }
    if (!obj || regions->leak_point_count < 2) return;
    fputc('l', out);
    for (int32_t i = 0; i < regions->leak_point_count; i++) fprintf(out, " %" PRId32, i + 1);
    fputc('\n', out);
}

static void warn_of_leak(const cli_job *job, const char *path) {
    const enf_regions *regions = &job->build.regions;
    const enf_frame *frame = &job->build.mesh.frame;
    double at[3], neck[3];
    enf_frame_to_world(frame, &job->build.mesh.spawns[3 * regions->leak_spawn], at);
    enf_frame_to_world(frame, regions->leak_neck, neck);
    fprintf(stderr,
            "warning: leak: from spawn point %" PRId32
            " (%g %g %g) one can reach the outside of the world; the "
            "narrowest place on the way is %.3g wide, at (%g %g %g); ",
            regions->leak_spawn, at[0], at[1], at[2], regions->leak_width * frame->step, neck[0], neck[1],
            neck[2]);
    if (path)
        fprintf(stderr, "the path is in %s\n", path);
    else
        fputs("--leak FILE.pts (or .obj) writes the path\n", stderr);
}

/// The stage of the recipe that the builder leaves to us: it works on what will be in the file.
static enf_status find_visibility(cli_job *job, enf_build_image *image, cli_progress *progress,
                                  enf_error *error) {
    const int choice = job->settings->pvs;
    if (choice == CLI_PVS_NONE) return ENF_OK;
    double started = enf_timer_now(), cpu_started = enf_timer_cpu();
    const bool is_auto = choice == CLI_PVS_AUTO;
    const enf_visibility_options options = {.method = is_auto ? ENF_METHOD_HOURGLASS
                                                              : (enf_method)(choice - CLI_PVS_METHOD),
                                            .threads = job->settings->threads,
                                            .progress = cli_progress_report,
                                            .progress_user = progress};
    bool left_out = false;
    enf_status status =
        enf_world_pvs_add(image, &options, is_auto ? &left_out : NULL, &job->visibility, error);
    enf_stage_report *stage = &job->build.stages[job->build.stage_count - 1];
    cli_stage_end(stage, started, cpu_started);
    stage->ran = !left_out;
    if (left_out)
        snprintf(stage->why, sizeof stage->why, "it would take long; --pvs hourglass asks for it");
    else
        snprintf(stage->why, sizeof stage->why, "%" PRId64 " pairs of cells, by %s",
                 enf_pvs_pairs(&job->visibility.pvs), enf_method_name(options.method));
    job->seconds += stage->seconds;
    return status;
}

static enf_status write_world(cli_job *job, const char *path, cli_progress *progress, enf_error *error) {
    enf_build_image image;
    double started = enf_timer_now(), cpu_started = enf_timer_cpu();
    enf_status status = enf_build_image_make(&image, &job->build, job->options_json, error);
    if (status) return status;
    double made = enf_timer_now(), cpu_made = enf_timer_cpu();
    status = find_visibility(job, &image, progress, error);
    started += enf_timer_now() - made; // that was a stage of its own
    cpu_started += enf_timer_cpu() - cpu_made;
    cli_progress_report(progress, "write", 0);
    if (!status) status = enf_view_save(&image.view, path, error);
    enf_build_image_free(&image);
    struct stat about;
    if (!status && stat(path, &about) == 0 && S_ISREG(about.st_mode))
        job->file_size = (uint64_t)about.st_size;
    job->write.name = "write";
    cli_stage_end(&job->write, started, cpu_started);
    job->seconds += job->write.seconds;
    job->peak_bytes = job->write.peak_bytes;
    return status;
}

/// The small outputs are opened before the work begins, so that a wrong path is told at once.
typedef struct outputs {
    enf_output world, report, leak;
} outputs;

static enf_status open_outputs(const request *request, outputs *outputs, enf_error *error) {
    enf_status status = ENF_OK;
    if (strcmp(request->output, "-") != 0) {
        status = enf_output_open(&outputs->world, request->output, error); // only to see whether it works
        enf_output_discard(&outputs->world);
    }
    if (!status && request->report) status = enf_output_open(&outputs->report, request->report, error);
    if (!status && request->leak) status = enf_output_open(&outputs->leak, request->leak, error);
    return status;
}

static enf_status write_outputs(const request *request, cli_job *job, outputs *outputs,
                                cli_progress *progress, enf_error *error) {
    enf_status status = write_world(job, request->output, progress, error);
    if (!status && request->leak && job->build.regions.leak) {
        print_leak(job, request->leak, outputs->leak.file);
        status = enf_output_commit(&outputs->leak, error);
    }
    if (!status && request->report) {
        cli_report_json(job, outputs->report.file);
        status = enf_output_commit(&outputs->report, error);
    }
    return status;
}

static int compile(const request *request) {
    cli_job job = {0};
    enf_error error = {0};
    outputs outputs = {0};
    cli_progress progress;
    cli_progress_start(&progress, (cli_progress_mode)request->progress);
    enf_status status = cli_job_prepare(&job, &request->settings, &error);
    if (!status) status = open_outputs(request, &outputs, &error);
    if (request->settings.pvs >= CLI_PVS_METHOD + (int)ENF_METHOD_LP) cli_heap_divide(); // whole numbers
    if (!status) status = cli_job_run(&job, &request->inputs, &progress, &error);
    if (!status && cli_was_interrupted()) status = ENF_NO_RESOURCES;
    if (!status) status = write_outputs(request, &job, &outputs, &progress, &error);
    cli_progress_stop(&progress);
    enf_output_discard(&outputs.report);
    enf_output_discard(&outputs.leak);
    if (status && cli_was_interrupted()) {
        status = enf_fail(&error, ENF_NO_RESOURCES, "cancelled; %s was not written", request->output);
    } else if (!status && !request->quiet) {
        if (request->verbose) cli_report_verbose(&job, stderr);
        cli_report_summary(&job, request->output, stderr);
        if (job.build.regions.leak) warn_of_leak(&job, request->leak);
    }
    cli_job_free(&job);
    return status ? cli_fail(&error) : ENF_OK;
}

int cli_compile(int argc, char **argv) {
    request request = {.settings = cli_settings_default()};
    cli_option options[] = {
        {"--output", 'o', CLI_TEXT, &request.output, "WORLD.enf", "the file to write", NULL, false},
        CLI_SETTINGS_OPTIONS(request.settings),
        {"--report", 0, CLI_TEXT, &request.report, "FILE.json", "write what was done, for scripts", NULL,
         false},
        {"--leak", 0, CLI_TEXT, &request.leak, "FILE", "with a leak: write the path (.obj, else .pts)", NULL,
         false},
        {"--progress", 0, CLI_CHOICE, &request.progress, "MODE", "auto (default), always or never",
         cli_progress_modes, false},
        {"--verbose", 'v', CLI_FLAG, &request.verbose, NULL, "say what each stage did, and what was left out",
         NULL, false},
        {"--quiet", 'q', CLI_FLAG, &request.quiet, NULL, "errors only", NULL, false},
        {0},
    };
    const cli_syntax syntax = {
        .command = "enfilade compile",
        .usage = "INPUT... -o WORLD.enf [options]",
        .summary = "Cuts a world, given as polygons (.obj .ply .off .stl, gzipped or not; several are put "
                   "together),\n"
                   "into cells and portals. OBJ comments `# spawn x y z` name points that are in a room.",
        .options = options,
        .operands_min = 1,
        .operands_max = INT_MAX,
        .operand = "an input file"};
    int status = cli_parse(&syntax, argc, argv, &request.inputs);
    const char *clash;
    if (status >= 0)
        ;
    else if (!request.output)
        status = cli_misuse(&syntax, "-o WORLD.enf is missing");
    else if (request.verbose && request.quiet)
        status = cli_misuse(&syntax, "-v and -q contradict each other");
    else if ((clash = find_clash(&request)))
        status =
            cli_misuse(&syntax, "'%.100s' would be written over; give every file a name of its own", clash);
    else
        status = compile(&request);
    cli_settings_free(&request.settings);
    free(request.inputs.items);
    return status;
}
