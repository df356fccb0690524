// SPDX-License-Identifier: MIT
// The program of README.md: which cell holds a point, and where do its portals lead?
#include "enfilade/run.h"

#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv) {
    enf_world *world;
    enf_error error;
    if (argc != 5) return fputs("usage: example WORLD.enf X Y Z\n", stderr), ENF_BAD_USAGE;
    if (enf_world_open_path(&world, argv[1], NULL, &error) != ENF_OK)
        return fprintf(stderr, "%s\n", error.text), (int)error.status;

    const double point[3] = {atof(argv[2]), atof(argv[3]), atof(argv[4])};
    const enf_place place = enf_world_locate(world, point, -1);
    printf("cell %d, in %s\n", (int)place.cell, enf_world_kind_name(place.kind));

    const enf_file_view *file = enf_world_file(world);
    if (place.cell >= 0) {
        const enf_file_cell *cell = &file->cells[place.cell];
        for (int i = 0; i < cell->portal_count; ++i) {
            const int32_t portal = file->cell_portals[cell->portal_first + i];
            printf("portal %d leads to cell %d\n", (int)portal, (int)file->portals[portal].to);
        }
    }
    enf_world_close(world);
    return ENF_OK;
}
