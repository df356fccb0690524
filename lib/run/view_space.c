// SPDX-License-Identifier: MIT
#include "run/view_space.h"

#include "run/affine.h"

#include <math.h>
#include <string.h>

static const double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

void enf_spaces_clear(enf_view_spaces *spaces, const enf_view_lens *lens) {
    enf_view_space *world = &spaces->spaces[0];
    *world = (enf_view_space){.parent = -1, .portal = -1};
    memcpy(world->to_camera, identity, sizeof identity);
    memcpy(world->from_camera, identity, sizeof identity);
    spaces->lenses[0] = *lens;
    spaces->count = 1;
}

/// All polygons of the portal in one plane, up to rounding?
static bool is_flat(const enf_file_view *file, const enf_file_portal *portal) {
    const enf_file_portal_polygon *first = &file->portal_polygons[portal->polygon_first];
    double reach = 0;
    for (int a = 0; a < 3; a++) reach += fabs(file->frame->box_max[a]) + fabs(file->frame->box_min[a]);
    for (int32_t i = 1; i < portal->polygon_count; i++)
        for (int32_t k = 0; k < first[i].vertex_count; k++) {
            const double *v = file->portal_vertices[first[i].vertex_first + k], *p = first->plane;
            if (!(fabs(p[0] * v[0] + p[1] * v[1] + p[2] * v[2] + p[3]) <= 1e-9 * reach)) return false;
        }
    return true;
}

/// The portal's plane in the space behind it.
static void set_plane(enf_view_space *space, const enf_file_view *file, const enf_file_portal *portal,
                      const double inverse[12]) {
    const double *plane = file->portal_polygons[portal->polygon_first].plane;
    space->has_plane = is_flat(file, portal);
    for (int j = 0; j < 4; j++)
        space->plane[j] = plane[0] * inverse[j] + plane[1] * inverse[4 + j] + plane[2] * inverse[8 + j] +
                          (j == 3 ? plane[3] : 0);
    for (int j = 0; j < 4; j++) space->has_plane = space->has_plane && isfinite(space->plane[j]);
}

int32_t enf_spaces_pass(enf_view_spaces *spaces, int32_t parent, const enf_file_view *file, int32_t portal,
                        const double matrix[12]) {
    for (int32_t i = parent + 1; i < spaces->count; i++)
        if (spaces->spaces[i].parent == parent && spaces->spaces[i].portal == portal) return i;
    if (spaces->count == ENF_VIEW_SPACES) return -1;
    enf_view_space *space = &spaces->spaces[spaces->count];
    const enf_view_space *before = &spaces->spaces[parent];
    double inverse[12];
    if (!enf_affine_invert(inverse, matrix)) return -1;
    if (!enf_lens_pass(&spaces->lenses[spaces->count], &spaces->lenses[parent], matrix, inverse)) return -1;
    *space = (enf_view_space){.parent = parent, .portal = portal, .transforms = before->transforms + 1};
    space->mirrored = before->mirrored != (enf_affine_determinant(matrix) < 0);
    enf_affine_multiply(space->from_camera, matrix, before->from_camera);
    enf_affine_multiply(space->to_camera, before->to_camera, inverse);
    set_plane(space, file, &file->portals[portal], inverse);
    return spaces->count++;
}
