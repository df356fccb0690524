// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade locate: points in, cell numbers out.
#include "cli/cli.h"
#include "cli/options.h"
#include "cli/points.h"
#include "cli/world.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct locating {
    const enf_world *world;
    bool with_kind;
    int32_t hint;
} locating;

static int answer_line(const double *point, void *user) {
    locating *l = user;
    enf_place place = enf_world_locate(l->world, point, l->hint);
    l->hint = place.tetrahedron;
    printf("%" PRId32 "%s%s\n", place.cell, l->with_kind ? " " : "",
           l->with_kind ? enf_world_kind_name(place.kind) : "");
    return ENF_OK;
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
    if (world) {
        locating l = {world, with_kind, -1};
        status = cli_read_numbers(3, "point; write three finite numbers 'x y z'", answer_line, &l);
    }
    enf_world_close(world);
    free(operands.items);
    return status;
}
