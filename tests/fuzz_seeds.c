// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the worlds that a fuzzer begins with, and the installed example looks at, into a folder: small ones
// that have every section.
#include "run_worlds.h"
#include "world_fixture.h"

#include <stdio.h>
#include <stdlib.h>

static void write_file(const char *folder, const char *name, const void *bytes, size_t size) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, size, file) != size || fclose(file)) {
        perror(path);
        exit(1);
    }
}

int main(int argc, char **argv) {
    if (argc != 2) return fputs("usage: fuzz_seeds FOLDER\n", stderr), 2;
    const enf_frame turned = {1, {0, 1, 2}, {1, 1, 1}, 1, true, {{0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1}}};
    for (int k = 0; k < 2; k++) { // with the exact complex
        fixture f;
        size_t size;
        fixture_make(&f, 2, k ? &turned : NULL);
        unsigned char *bytes = fixture_save(&f, &size);
        write_file(argv[1], k ? "fixture-turned.enf" : "fixture.enf", bytes, size);
        free(bytes);
        fixture_free(&f);
    }
    for (int side = 2; side <= 4; side += 2) { // with a visible set
        run_world w = run_world_grid(side, side == 2, 3);
        write_file(argv[1], side == 2 ? "cubes-2.enf" : "cubes-4.enf", w.bytes, w.size);
        run_world_free(&w);
    }
    return 0;
}
