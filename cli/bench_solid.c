// SPDX-License-Identifier: GPL-3.0-or-later
// Solid or air, in the finished world, against the union of the brushes that the level was made of. Every
// level twice: with its spawn points (which make their region air) and without, where the polygons alone
// decide.
#include "base/array.h"
#include "build/write.h"
#include "cli/bench.h"
#include "cli/bench_folder.h"
#include "cli/brushes.h"
#include "cli/cli.h"
#include "cli/job.h"
#include "format/locate.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS_DEFAULT = 100000 };

typedef struct request {
    double points, margin;
    struct row *sum; ///< of all levels
} request;

/// Answers of one world. `rock_as_air`: solid by the brushes, air or outside by us.
typedef struct answers {
    int64_t rock_as_air, air_as_rock, spawns_wrong;
    int32_t ambiguous; ///< regions
} answers;

typedef struct row {
    int64_t points, solid, spawns;
    answers with, without;
} row;

/// The points of a level that are far enough from every face, and the truth about each.
typedef struct probe {
    double (*at)[3];
    bool *solid;
    size_t count;
    double (*spawns)[3];
    size_t spawn_count;
} probe;

static bool choose_points(probe *probe, const cli_brushes *brushes, const request *request) {
    size_t wanted = (size_t)request->points;
    uint64_t seed = 1;
    probe->at = enf_array_new(wanted, sizeof *probe->at);
    probe->solid = enf_array_new(wanted, sizeof *probe->solid);
    if (!probe->at || !probe->solid) return false;
    for (size_t tried = 0; probe->count < wanted && tried < 10 * wanted; tried++) {
        double *at = probe->at[probe->count];
        cli_brushes_random_point(brushes, &seed, at);
        int side = cli_brushes_side(brushes, at, request->margin);
        if (side != 0) probe->solid[probe->count++] = side > 0;
    }
    return true;
}

/// Spawn points that lie in the open by the brushes.
static bool choose_spawns(probe *probe, const cli_brushes *brushes, const enf_soup *soup, double margin) {
    probe->spawns = enf_array_new(soup->spawn_count, sizeof *probe->spawns);
    if (!probe->spawns) return false;
    for (size_t i = 0; i < soup->spawn_count; i++) {
        const double *at = soup->spawns + 3 * i;
        if (cli_brushes_side(brushes, at, margin) < 0)
            memcpy(probe->spawns[probe->spawn_count++], at, sizeof *probe->spawns);
    }
    return true;
}

static void ask(const enf_file_view *view, const probe *probe, answers *answers) {
    for (size_t i = 0; i < probe->count; i++) {
        bool rock = enf_view_locate(view, probe->at[i], -1).kind == ENF_WORLD_ROCK;
        if (rock == probe->solid[i]) continue;
        *(rock ? &answers->air_as_rock : &answers->rock_as_air) += 1;
    }
    for (size_t i = 0; i < probe->spawn_count; i++)
        answers->spawns_wrong += enf_view_locate(view, probe->spawns[i], -1).kind == ENF_WORLD_ROCK;
}

/// Compiles the level and asks it. The first time the probe gets its spawn points, too.
static enf_status compile_and_ask(const char *path, bool with_spawns, const cli_brushes *brushes,
                                  double margin, probe *probe, answers *answers, enf_error *error) {
    static const char *const exclude[] = {"*liquid*"};
    enf_build build = {0};
    enf_build_image image;
    enf_build_options options = {
        .clean = {.weld = -1, .plane_tolerance = -1, .exclude = exclude, .exclude_count = 1},
        .keep = ENF_KEEP_ALL,
        .threads = cli_settings_default().threads};
    enf_status status = enf_stop_parse("auto", &options.stop, error);
    if (!status) status = enf_soup_read(&build.soup, path, error);
    if (!status && !probe->spawns && !choose_spawns(probe, brushes, &build.soup, margin))
        status = enf_fail_memory(error, "the spawn points");
    if (!with_spawns) build.soup.spawn_count = 0;
    if (!status) status = enf_build_run(&build, &options, error);
    if (!status) status = enf_build_image_make(&image, &build, NULL, error);
    if (!status) {
        ask(&image.view, probe, answers);
        for (int32_t r = 0; r < build.regions.region_count; r++)
            answers->ambiguous += build.regions.ambiguous[r];
        enf_build_image_free(&image);
    }
    enf_build_free(&build);
    return status;
}

static int work(void *user, const char *path, const char *name, void *result) {
    (void)name; // the path says it
    const request *request = user;
    row *row = result;
    enf_error error = {0};
    cli_brushes brushes = {0};
    probe probe = {0};
    enf_status status = cli_brushes_read(&brushes, path, &error);
    if (!status && !choose_points(&probe, &brushes, request)) status = enf_fail_memory(&error, "the points");
    if (!status) status = compile_and_ask(path, true, &brushes, request->margin, &probe, &row->with, &error);
    if (!status)
        status = compile_and_ask(path, false, &brushes, request->margin, &probe, &row->without, &error);
    row->points = (int64_t)probe.count;
    row->spawns = (int64_t)probe.spawn_count;
    for (size_t i = 0; i < probe.count; i++) row->solid += probe.solid[i];
    free(probe.at);
    free(probe.solid);
    free(probe.spawns);
    cli_brushes_free(&brushes);
    return status ? cli_folder_fail(path, &error) : ENF_OK;
}

static void print_head(void *user) {
    (void)user;
    puts("level,points,solid,spawns,rock_as_air,air_as_rock,spawns_in_rock,ambiguous_regions,"
         "rock_as_air_without_spawns,air_as_rock_without_spawns,spawns_in_rock_without_spawns,"
         "ambiguous_regions_without_spawns");
}

static void print_answers(const answers *answers) {
    printf(",%" PRId64 ",%" PRId64 ",%" PRId64 ",%" PRId32, answers->rock_as_air, answers->air_as_rock,
           answers->spawns_wrong, answers->ambiguous);
}

static void print_counts(const char *name, const row *row) {
    printf("%s,%" PRId64 ",%" PRId64 ",%" PRId64, name, row->points, row->solid, row->spawns);
    print_answers(&row->with);
    print_answers(&row->without);
    putchar('\n');
}

static void add_answers(answers *sum, const answers *answers) {
    sum->rock_as_air += answers->rock_as_air;
    sum->air_as_rock += answers->air_as_rock;
    sum->spawns_wrong += answers->spawns_wrong;
    sum->ambiguous += answers->ambiguous;
}

static void print_row(void *user, const char *name, const void *result) {
    const request *request = user;
    const row *row = result;
    print_counts(name, row);
    request->sum->points += row->points;
    request->sum->solid += row->solid;
    request->sum->spawns += row->spawns;
    add_answers(&request->sum->with, &row->with);
    add_answers(&request->sum->without, &row->without);
}

static bool is_all_right(const answers *answers) {
    return answers->rock_as_air + answers->air_as_rock + answers->spawns_wrong == 0;
}

int cli_bench_solid(int argc, char **argv) {
    row sum = {0};
    request request = {.points = POINTS_DEFAULT, .margin = 1e-5, .sum = &sum};
    cli_folder folder = {.user = &request,
                         .work = work,
                         .row_size = sizeof(row),
                         .print = print_row,
                         .print_head = print_head};
    cli_option options[] = {{"--points", 0, CLI_LENGTH, &request.points, "N",
                             "random points per level; default 100000", NULL, false},
                            {"--margin", 0, CLI_LENGTH, &request.margin, "D",
                             "points nearer than D to a brush's surface are not asked; default 0.00001", NULL,
                             false},
                            CLI_LEVELS_OPTION(folder),
                            {0}};
    const cli_syntax syntax = {
        .command = "enfilade bench solid",
        .usage = "DIR [--points N] [--margin D] [--levels GLOB]",
        .summary =
            "Solid or air: every level with '# brush' lines compiled with --keep all --exclude\n"
            "'*liquid*', with and without its spawn points, and asked at random points and at the spawn\n"
            "points; the truth is the union of the brushes. CSV; exit status 1 if an answer is wrong.",
        .options = options,
        .operands_min = 1,
        .operands_max = 1,
        .operand = "the folder"};
    cli_texts operands = {0};
    int status = cli_parse(&syntax, argc, argv, &operands);
    if (status < 0 && request.points > 1e8)
        status = cli_misuse(&syntax, "--points: %g are too many; at most 100000000", request.points);
    if (status < 0) {
        folder.path = operands.items[0];
        status = cli_folder_visit(&folder);
        print_counts("all", &sum);
        if (!status && !(is_all_right(&sum.with) && is_all_right(&sum.without))) status = ENF_CHECK_FAILED;
        if (cli_finish_output()) status = ENF_NO_RESOURCES;
    }
    free(operands.items);
    return status;
}
