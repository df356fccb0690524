// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade sight: pairs of points in, 1 or 0 out.
#include "cli/cli.h"
#include "cli/options.h"
#include "cli/points.h"
#include "cli/world.h"

#include "enfilade/sight.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct sighting {
    const enf_world *world;
    int32_t hint;
} sighting;

static int answer_line(const double *numbers, void *user) {
    sighting *s = user;
    enf_sight_query query = {.size = sizeof query,
                             .from = {numbers[0], numbers[1], numbers[2]},
                             .to = {numbers[3], numbers[4], numbers[5]}};
    enf_sight sight;
    enf_error error = {0};
    enf_place from = enf_world_locate(s->world, query.from, s->hint);
    query.from_place = &from;
    s->hint = from.tetrahedron;
    if (enf_sight_between(s->world, NULL, &query, &sight, &error)) return cli_fail(&error);
    puts(sight.is_free ? "1" : "0");
    return ENF_OK;
}

int cli_sight(int argc, char **argv) {
    cli_option options[] = {{0}};
    const cli_syntax syntax = {
        .command = "enfilade sight",
        .usage = "WORLD.enf",
        .summary = "Reads pairs of points 'x y z  x y z' from standard input, one per line, and writes for\n"
                   "each 1 if the segment between them is free, or 0.",
        .options = options,
        .operands_min = 1,
        .operands_max = 1,
        .operand = "the world file"};
    cli_texts operands = {0};
    enf_world *world = NULL;
    int status = cli_parse(&syntax, argc, argv, &operands);
    if (status < 0) status = cli_open_world(&world, operands.items[0]);
    if (world) {
        sighting s = {world, -1};
        status =
            cli_read_numbers(6, "pair of points; write six finite numbers 'x y z  x y z'", answer_line, &s);
    }
    enf_world_close(world);
    free(operands.items);
    return status;
}
