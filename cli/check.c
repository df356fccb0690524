// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade check: every invariant, exactly. A row per invariant; the status says whether all hold.
#include "cli/check.h"
#include "visibility/check_world_pvs.h"

#include "build/json.h"
#include "cli/cli.h"
#include "cli/options.h"
#include "enfilade/run.h"
#include "visibility/check_world_pvs.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void print_json(const enf_check_report *report) {
    enf_json json = {.file = stdout};
    enf_json_begin_object(&json, NULL);
    enf_json_bool(&json, "held", report->broken_count == 0);
    enf_json_whole(&json, "broken", report->broken_count);
    enf_json_text(&json, "first", report->broken_count ? report->first : NULL);
    enf_json_begin_array(&json, "rows");
    for (int i = 0; i < report->row_count; i++) {
        const enf_check_row *row = &report->rows[i];
        enf_json_begin_object(&json, NULL);
        json.one_line = true;
        enf_json_text(&json, "name", row->name);
        enf_json_bool(&json, "held", row->held);
        enf_json_bool(&json, "skipped", row->skipped);
        enf_json_whole(&json, "tested", (int64_t)row->tested);
        enf_json_text(&json, "detail", row->detail);
        enf_json_end_object(&json);
        json.one_line = false;
    }
    enf_json_end_array(&json);
    enf_json_end_object(&json);
    enf_json_finish(&json);
}

static void print_text(const enf_check_report *report) {
    for (int i = 0; i < report->row_count; i++) {
        const enf_check_row *row = &report->rows[i];
        printf("%-7s %-42s %10" PRIu64 "  %s\n",
               row->skipped ? "skipped"
               : row->held  ? "holds"
                            : "BROKEN",
               row->name, row->tested, row->detail);
    }
}

void cli_print_check(const enf_check_report *report, bool as_json) {
    if (as_json)
        print_json(report);
    else
        print_text(report);
    fflush(stdout);
}

static int check_world(const char *path, bool as_json) {
    enf_world *world = NULL;
    enf_error wrong = {0}, error = {0};
    // A wrong checksum is one of the rows; only what cannot be read at all ends here.
    const enf_open_options lenient = {.size = sizeof lenient, .skip_checksums = true};
    if (enf_world_open_path(&world, path, &lenient, &error) != ENF_OK) return cli_fail(&error);
    enf_check_report *report = calloc(1, sizeof *report);
    enf_status status = report ? enf_world_check(enf_world_file(world), report, &wrong)
                               : enf_fail_memory(&wrong, "the report");
    if (!status) status = enf_world_check_pvs(enf_world_file(world), report, &wrong);
    if (status == ENF_OK || status == ENF_CHECK_FAILED) cli_print_check(report, as_json);
    if (status) {
        enf_fail(&error, status, "%s: %.900s", path, wrong.text);
        cli_fail(&error);
    }
    free(report);
    enf_world_close(world);
    return (int)status;
}

/// Is it a portal file? Its first letters say so.
static bool is_portal_file(const char *path) {
    char letters[3] = {0};
    FILE *file = fopen(path, "rb");
    if (!file) return false;
    bool found = fread(letters, 1, sizeof letters, file) == sizeof letters && memcmp(letters, "PRT", 3) == 0;
    fclose(file);
    return found;
}

int cli_check(int argc, char **argv) {
    cli_visible_check visible = {0};
    cli_option options[] = {
        {"--json", 0, CLI_FLAG, &visible.as_json, NULL, "the rows as JSON", NULL, false},
        {"--pvs", 0, CLI_TEXT, &visible.pvs, "PVS.txt", "the visible set of a .prt file", NULL, false},
        {"--witness", 0, CLI_TEXT, &visible.witness, "FILE", "sight lines that prove what it lists", NULL,
         false},
        {"--hidden", 0, CLI_FLAG, &visible.hidden, NULL, "confirm that what it leaves out is hidden", NULL,
         false},
        {"--sample", 0, CLI_LENGTH, &visible.sample, "SECONDS", "throw lines to find what it misses", NULL,
         false},
        {0},
    };
    const cli_syntax syntax = {
        .command = "enfilade check",
        .usage = "WORLD.enf|IN.prt [--json] [--pvs PVS.txt [--witness FILE] [--hidden] [--sample SECONDS]]",
        .summary =
            "Tests every invariant of a world file, or a visible set against the portal file that it is\n"
            "about, with exact arithmetic. Exit status 1, and a message that names the first broken one,\n"
            "if one does not hold.",
        .options = options,
        .operands_min = 1,
        .operands_max = 1,
        .operand = "the world file"};
    cli_texts operands = {0};
    int status = cli_parse(&syntax, argc, argv, &operands);
    if (status < 0) {
        visible.graph = operands.items[0];
        if (visible.pvs)
            status = cli_check_visible(&visible);
        else if (visible.witness || visible.hidden || visible.sample > 0 || is_portal_file(visible.graph))
            status = cli_misuse(&syntax, "--pvs is missing: the visible set of the .prt file");
        else
            status = check_world(visible.graph, visible.as_json);
    }
    free(operands.items);
    return status;
}
