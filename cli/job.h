// SPDX-License-Identifier: GPL-3.0-or-later
// One compilation: what was asked, and what came of it.
#ifndef ENF_CLI_JOB_H
#define ENF_CLI_JOB_H

#include "build/build.h"
#include "cli/options.h"
#include "cli/progress.h"
#include "visibility/visibility.h"

/// The options that shape the result. Start with cli_settings_default.
typedef struct cli_settings {
    int tetrahedralizer, heuristic, keep, pvs, threads;
    const char *stop;
    uint64_t memory;              ///< 0: not given
    double weld, plane_tolerance; ///< < 0: not given
    bool plain_cells;
    cli_texts exclude, detail;
    cli_points spawns;
} cli_settings;

cli_settings cli_settings_default(void);

/// One per core, up to a limit.
int cli_default_threads(void);
void cli_settings_free(cli_settings *settings);

extern const char *const cli_tetrahedralizers[], *const cli_heuristics[], *const cli_keeps[],
                                                                              *const cli_pvs_choices[];

/// What comes first of cli_pvs_choices; from the last of these on, they are methods.
enum { CLI_PVS_AUTO, CLI_PVS_NONE, CLI_PVS_METHOD };

/// Rows of an option table that fill the cli_settings `s`.
#define CLI_SETTINGS_OPTIONS(s)                                                                              \
    {"--tetrahedralizer",  0,                                                                                \
     CLI_CHOICE,           &(s).tetrahedralizer,                                                             \
     "own|cgal|tetgen",    "default own; cgal makes the same",                                               \
     cli_tetrahedralizers, false},                                                                           \
        {"--heuristic",  0,    CLI_CHOICE, &(s).heuristic, "NAME", "aspect (default) or aspect-scaled",      \
         cli_heuristics, false},                                                                             \
        {"--stop", 0, CLI_TEXT, &(s).stop, "RULE", "auto (default), weight=W or cells=N", NULL, false},      \
        {"--keep",  0,      CLI_CHOICE,                                                                      \
         &(s).keep, "RULE", "regions to keep: auto (default), all, outside, spawn",                          \
         cli_keeps, false},                                                                                  \
        {"--spawn", 0,    CLI_POINTS, &(s).spawns, "X,Y,Z", "a point that is in a room; may be repeated",    \
         NULL,      false},                                                                                  \
        {"--pvs",         0,        CLI_CHOICE,                                                              \
         &(s).pvs,        "METHOD", "auto (default), none, reach, facing, hourglass, lp, exact",             \
         cli_pvs_choices, false},                                                                            \
        {"--exclude",  0,      CLI_TEXTS,                                                                    \
         &(s).exclude, "GLOB", "leave out groups whose name matches; may be repeated",                       \
         NULL,         false},                                                                               \
        {"--detail",  0,      CLI_TEXTS,                                                                     \
         &(s).detail, "GLOB", "groups that are drawn but do not cut; may be repeated",                       \
         NULL,        false},                                                                                \
        {"--weld",  0,    CLI_LENGTH,                                                                        \
         &(s).weld, "D",  "corners closer than D become one; default 1e-9 of the diagonal",                  \
         NULL,      false},                                                                                  \
        {"--plane-tolerance",                                                                                \
         0,                                                                                                  \
         CLI_LENGTH,                                                                                         \
         &(s).plane_tolerance,                                                                               \
         "D",                                                                                                \
         "how far points may move to be coplanar again; default 2e-7 of the diagonal",                       \
         NULL,                                                                                               \
         false},                                                                                             \
        {"--plain-cells",                                                                                    \
         0,                                                                                                  \
         CLI_FLAG,                                                                                           \
         &(s).plain_cells,                                                                                   \
         NULL,                                                                                               \
         "leave fine cells as the cuts make them; otherwise convex ones are joined",                         \
         NULL,                                                                                               \
         false},                                                                                             \
        {"--memory",  0,      CLI_BYTES,                                                                     \
         &(s).memory, "SIZE", "refuse what will need more, as 16G; default: what the system allows",         \
         NULL,        false},                                                                                \
    {                                                                                                        \
        "--threads", 0, CLI_COUNT, &(s).threads, "N", "default: one per core; the result is the same", NULL, \
            false                                                                                            \
    }

typedef struct cli_job {
    const cli_settings *settings;
    enf_build_options options;
    char *options_json; ///< what shapes the result, on one line
    enf_build build;
    enf_visibility visibility; ///< if there is one in the world
    enf_stage_report read, write;
    double seconds;
    uint64_t peak_bytes, file_size;
} cli_job;

/// Translates the settings. ENF_BAD_USAGE with words for those that make no sense. Free the job in any case.
enf_status cli_job_prepare(cli_job *job, const cli_settings *settings, enf_error *error);

/// Reads the inputs and runs the stages.
enf_status cli_job_run(cli_job *job, const cli_texts *inputs, cli_progress *progress, enf_error *error);

void cli_job_free(cli_job *job);

/// Notes the time and memory of a stage outside of the recipe: reading or writing.
void cli_stage_end(enf_stage_report *stage, double started, double cpu_started);

/// Kept fine cells, portals and so on, counted from a finished build.
typedef struct cli_counts {
    int64_t fine_active, fine_discarded, regions_kept, spawns_in_cells, rejected[ENF_REJECT_COUNT];
} cli_counts;

cli_counts cli_job_count(const cli_job *job);

#endif
