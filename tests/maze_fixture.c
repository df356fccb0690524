// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include "maze_fixture.h"

#include "base/hash.h"

#include <stdio.h>
#include <stdlib.h>

enum { ROOM = 64 };

/// A part of a wall: from and to, 1 to ROOM - 1.
static void choose_part(uint64_t *seed, int part[2]) {
    *seed = enf_hash_mix(*seed + UINT64_C(0x9e3779b97f4a7c15));
    int length = 6 + (int)(*seed % 40);
    part[0] = 1 + (int)((*seed >> 20) % (uint64_t)(ROOM - 2 - length));
    part[1] = part[0] + length;
}

char *maze_print(int side, uint64_t seed) {
    char *text = NULL;
    size_t size;
    FILE *file = open_memstream(&text, &size);
    if (!file) abort();
    fprintf(file, "PRT1\n%d\n%d\n", side * side, 2 * side * (side - 1));
    for (int i = 0; i < side * side; i++) {
        int x = i % side, y = i / side, along[2], up[2];
        choose_part(&seed, along);
        choose_part(&seed, up);
        int at = ROOM * (x + 1), from = ROOM * y + along[0], to = ROOM * y + along[1];
        if (x + 1 < side)
            fprintf(file, "4 %d %d (%d %d %d)(%d %d %d)(%d %d %d)(%d %d %d)\n", i, i + 1, at, from, up[0], at,
                    to, up[0], at, to, up[1], at, from, up[1]);
        choose_part(&seed, along);
        choose_part(&seed, up);
        at = ROOM * (y + 1), from = ROOM * x + along[0], to = ROOM * x + along[1];
        if (y + 1 < side)
            fprintf(file, "4 %d %d (%d %d %d)(%d %d %d)(%d %d %d)(%d %d %d)\n", i, i + side, from, at, up[0],
                    from, at, up[1], to, at, up[1], to, at, up[0]);
    }
    if (fclose(file) != 0) abort();
    return text;
}

void maze_read(enf_portal_graph *graph, int side, uint64_t seed) {
    char path[] = P_tmpdir "/enfilade-maze-XXXXXX", *text = maze_print(side, seed);
    int descriptor = mkstemp(path);
    FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "w");
    enf_error error;
    if (!file || fputs(text, file) == EOF || fclose(file) != 0) abort();
    if (enf_portal_graph_read(graph, path, &error) != ENF_OK) {
        fprintf(stderr, "%s\n", error.text);
        abort();
    }
    enf_portal_graph_find_non_convex(graph);
    remove(path);
    free(text);
}
