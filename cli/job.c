// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/job.h"

#include "base/memory.h"
#include "base/timer.h"
#include "build/json.h"
#include "shim/shim.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char *const cli_tetrahedralizers[] = {"own", "cgal", "tetgen", NULL};
const char *const cli_heuristics[] = {"aspect", "aspect-scaled", NULL};
_Static_assert(sizeof cli_heuristics / sizeof *cli_heuristics == ENF_HEURISTIC_COUNT + 1,
               "one name per heuristic");
const char *const cli_keeps[] = {"auto", "all", "outside", "spawn", NULL};
const char *const cli_pvs_choices[] = {"auto", "none", "reach", "facing", "hourglass", "lp", "exact", NULL};

enum { THREADS_MAX = 64 };

int cli_default_threads(void) {
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    return cores < 1 ? 1 : cores > THREADS_MAX ? THREADS_MAX : (int)cores;
}

cli_settings cli_settings_default(void) {
    return (cli_settings){
        .stop = "auto", .weld = -1, .plane_tolerance = -1, .threads = cli_default_threads()};
}

void cli_settings_free(cli_settings *settings) {
    free(settings->exclude.items);
    free(settings->detail.items);
    free(settings->spawns.items);
}

static void put_texts(enf_json *json, const char *key, const cli_texts *texts) {
    enf_json_begin_array(json, key);
    for (size_t i = 0; i < texts->count; i++) enf_json_text(json, NULL, texts->items[i]);
    enf_json_end_array(json);
}

static void put_tolerance(enf_json *json, const char *key, double tolerance) {
    if (tolerance < 0)
        enf_json_text(json, key, "default");
    else
        enf_json_number(json, key, tolerance);
}

static char *print_options(const cli_settings *settings) {
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    if (!file) return NULL;
    enf_json json = {.file = file, .one_line = true};
    enf_json_begin_object(&json, NULL);
    enf_json_text(&json, "tetrahedralizer", cli_tetrahedralizers[settings->tetrahedralizer]);
    enf_json_text(&json, "heuristic", cli_heuristics[settings->heuristic]);
    enf_json_text(&json, "stop", settings->stop);
    enf_json_text(&json, "keep", cli_keeps[settings->keep]);
    enf_json_text(&json, "pvs", cli_pvs_choices[settings->pvs]);
    put_tolerance(&json, "weld", settings->weld);
    put_tolerance(&json, "plane_tolerance", settings->plane_tolerance);
    enf_json_bool(&json, "plain_cells", settings->plain_cells);
    put_texts(&json, "exclude", &settings->exclude);
    put_texts(&json, "detail", &settings->detail);
    enf_json_begin_array(&json, "spawns");
    for (size_t i = 0; i < settings->spawns.count; i++)
        enf_json_numbers(&json, NULL, settings->spawns.items[i], 3);
    enf_json_end_array(&json);
    enf_json_end_object(&json);
    bool failed = ferror(file) != 0;
    if (fclose(file) != 0 || failed) {
        free(text);
        return NULL;
    }
    return text;
}

enf_status cli_job_prepare(cli_job *job, const cli_settings *settings, enf_error *error) {
    *job = (cli_job){.settings = settings};
    enf_build_options *options = &job->options;
    options->clean = (enf_clean_options){.weld = settings->weld,
                                         .plane_tolerance = settings->plane_tolerance,
                                         .exclude = settings->exclude.items,
                                         .exclude_count = settings->exclude.count,
                                         .detail = settings->detail.items,
                                         .detail_count = settings->detail.count};
    options->tetrahedralizer = (enf_tetrahedralizer)settings->tetrahedralizer;
    options->heuristic = (enf_heuristic)settings->heuristic;
    options->keep = (enf_keep)settings->keep;
    options->plain_cells = settings->plain_cells;
    options->threads = settings->threads;
    options->memory = settings->memory;
    options->measure_resident = true;
    if (options->tetrahedralizer == ENF_TETRAHEDRALIZER_TETGEN && !enf_shim_has_tetgen())
        return enf_fail(error, ENF_BAD_USAGE,
                        "--tetrahedralizer tetgen: this build has no TetGen; use own or cgal, or build with "
                        "ENFILADE_TETGEN=ON");
    enf_status status = enf_stop_parse(settings->stop, &options->stop, error);
    if (status) return status;
    job->options_json = print_options(settings);
    return job->options_json ? ENF_OK : enf_fail_memory(error, "the options");
}

static enf_status read_inputs(cli_job *job, const cli_texts *inputs, enf_error *error) {
    enf_soup *soup = &job->build.soup;
    for (size_t i = 0; i < inputs->count; i++) {
        enf_status status = enf_soup_read(soup, inputs->items[i], error);
        if (status) return status;
        if (cli_was_interrupted()) return enf_fail(error, ENF_NO_RESOURCES, "cancelled");
    }
    const cli_points *spawns = &job->settings->spawns;
    for (size_t i = 0; i < spawns->count; i++) {
        const double *at = spawns->items[i];
        if (!enf_soup_add_spawn(soup, at[0], at[1], at[2])) return enf_fail_memory(error, "the spawn points");
    }
    return ENF_OK;
}

/// A message about the whole world names the inputs, as one about a line does.
static void name_inputs(const enf_soup *soup, enf_error *error) {
    for (size_t i = 0; i < soup->file_count; i++)
        if (strncmp(error->text, soup->files[i], strlen(soup->files[i])) == 0) return;
    enf_error wrong = *error;
    enf_fail(error, wrong.status, "%s%s: %.900s", soup->file_count ? soup->files[0] : "input",
             soup->file_count > 1 ? " and others" : "", wrong.text);
}

enf_status cli_job_run(cli_job *job, const cli_texts *inputs, cli_progress *progress, enf_error *error) {
    double started = enf_timer_now(), cpu_started = enf_timer_cpu();
    job->read.name = "read";
    if (progress) cli_progress_report(progress, "read", 0);
    enf_status status = read_inputs(job, inputs, error);
    cli_stage_end(&job->read, started, cpu_started);
    job->options.progress = progress ? cli_progress_report : NULL;
    job->options.progress_user = progress;
    if (!status) {
        status = enf_build_run(&job->build, &job->options, error);
        if (status == ENF_BAD_INPUT) name_inputs(&job->build.soup, error);
    }
    job->seconds = enf_timer_now() - started;
    job->peak_bytes = enf_memory_peak();
    return status;
}

void cli_stage_end(enf_stage_report *stage, double started, double cpu_started) {
    stage->seconds = enf_timer_now() - started;
    stage->cpu_seconds = enf_timer_cpu() - cpu_started;
    stage->peak_bytes = enf_memory_peak();
    stage->resident_bytes = enf_memory_resident();
    stage->ran = true;
}

void cli_job_free(cli_job *job) {
    free(job->options_json);
    enf_build_free(&job->build);
    enf_visibility_free(&job->visibility);
    *job = (cli_job){0};
}

cli_counts cli_job_count(const cli_job *job) {
    const enf_build *build = &job->build;
    cli_counts counts = {0};
    for (int32_t i = 0; i < build->complex.cell_count; i++)
        *(build->cell_of[i] >= 0 ? &counts.fine_active : &counts.fine_discarded) += 1;
    for (int32_t i = 0; i < build->regions.region_count; i++) counts.regions_kept += build->regions.kept[i];
    for (int32_t i = 0; i < build->regions.spawn_count; i++) {
        int32_t fine = build->regions.spawn_cell[i];
        counts.spawns_in_cells += fine >= 0 && build->cell_of[fine] >= 0;
    }
    for (size_t i = 0; i < build->soup.rejected_count; i++) counts.rejected[build->soup.rejected[i].reason]++;
    return counts;
}
