// SPDX-License-Identifier: MIT
// The program of README.md: where is the eye, and which cells does it see when it looks along the x axis?
#include "enfilade/view.h"

#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv) {
    enf_world *world;
    enf_view *view;
    enf_error error;
    if (argc != 5) return fputs("usage: example WORLD.enf X Y Z\n", stderr), ENF_BAD_USAGE;
    if (enf_world_open_path(&world, argv[1], NULL, &error) || enf_view_create(&view, world, NULL, &error))
        return fprintf(stderr, "%s\n", error.text), (int)error.status;

    const double eye[3] = {atof(argv[2]), atof(argv[3]), atof(argv[4])};
    const enf_place place = enf_world_locate(world, eye, -1);
    printf("the eye is in cell %d, in %s\n", (int)place.cell, enf_world_kind_name(place.kind));

    const double forward[3] = {1, 0, 0}, up[3] = {0, 0, 1};
    enf_camera camera = enf_camera_look(eye, forward, up, 1.2, 16.0 / 9);
    camera.place = &place;
    const enf_visible *visible = enf_view_run(view, NULL, &camera);
    for (int i = 0; i < visible->entry_count; i++) { // front to back
        const enf_view_entry *entry = &visible->entries[i];
        printf("cell %d through portal %d: %.2f to %.2f, %.2f to %.2f of the screen\n", (int)entry->cell,
               (int)entry->portal, entry->rectangle[0], entry->rectangle[2], entry->rectangle[1],
               entry->rectangle[3]);
    }
    enf_view_free(view);
    enf_world_close(world);
    return ENF_OK;
}
