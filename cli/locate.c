// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade locate: points in, cell numbers out.
#include "cli/cli.h"
#include "cli/options.h"
#include "cli/world.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char blanks[] = " \t\r\n\v\f";

/// Three finite numbers and nothing else.
static bool read_point(const char *line, size_t length, double point[3]) {
    if (strlen(line) != length) return false; // a zero byte
    for (int a = 0; a < 3; a++) {
        line += strspn(line, blanks);
        if (!cli_read_number(line, &line, &point[a])) return false;
        if (*line && !strchr(blanks, *line)) return false;
    }
    return line[strspn(line, blanks)] == 0;
}

static int locate_all(const enf_world *world, bool with_kind) {
    char *line = NULL;
    size_t capacity = 0;
    ssize_t length;
    int64_t number = 0;
    int32_t hint = -1;
    int status = ENF_OK;
    while ((length = getline(&line, &capacity, stdin)) >= 0) {
        double point[3];
        number++;
        if (!read_point(line, (size_t)length, point)) {
            fflush(stdout);
            line[strcspn(line, "\r\n")] = 0;
            fprintf(stderr,
                    "stdin:%" PRId64
                    ": '%.60s' is no point; write three finite numbers 'x y z' on each line\n",
                    number, line);
            status = ENF_BAD_INPUT;
            break;
        }
        enf_place place = enf_world_locate(world, point, hint);
        hint = place.tetrahedron;
        printf("%" PRId32 "%s%s\n", place.cell, with_kind ? " " : "",
               with_kind ? enf_world_kind_name(place.kind) : "");
    }
    if (!status && ferror(stdin)) {
        fprintf(stderr, "stdin:%" PRId64 ": can't be read on; check where it comes from\n", number + 1);
        status = ENF_NO_RESOURCES;
    }
    free(line);
    return status;
}

int cli_locate(int argc, char **argv) {
    bool with_kind = false;
    cli_option options[] = {
        {"--kind", 0, CLI_FLAG, &with_kind, NULL, "also say air, rock or outside", NULL, false},
        {0},
    };
    const cli_syntax syntax = {
        .command = "enfilade locate",
        .usage = "WORLD.enf [--kind]",
        .summary = "Reads points 'x y z' from standard input, one per line, and writes the number of\n"
                   "the cell of each, or -1.",
        .options = options,
        .operands_min = 1,
        .operands_max = 1,
        .operand = "the world file"};
    cli_texts operands = {0};
    enf_world *world = NULL;
    int status = cli_parse(&syntax, argc, argv, &operands);
    if (status < 0) status = cli_open_world(&world, operands.items[0]);
    if (world) status = locate_all(world, with_kind);
    enf_world_close(world);
    free(operands.items);
    return status;
}
