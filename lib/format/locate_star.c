// SPDX-License-Identifier: MIT
// All tetrahedra around a point that lies on the border of one: each lies behind a face, with the point on
// it, of another.
#include "format/locate_star.h"

#include "format/locate_point.h"

static bool find_star(const enf_locating *point, enf_star *star) {
    for (int i = 0; i < star->count; i++) {
        int32_t tetrahedron = star->list[i];
        int faces = enf_locating_faces(point, tetrahedron);
        if (faces < 0) continue; // in a file that means nothing
        for (int face = 0; face < 4; face++) {
            int32_t next = point->view->tetrahedron_next[tetrahedron][face];
            if (faces >> face & 1 && next >= 0 && !enf_star_add(star, next)) return false;
        }
    }
    return true;
}

bool enf_locating_star(enf_locating *point, int32_t tetrahedron) {
    enf_star star;
    enf_star_begin(&star);
    if (!enf_star_add(&star, tetrahedron) || !find_star(point, &star)) return false;
    for (int i = 0; i < star.count; i++) enf_locating_descend(point, star.list[i]);
    return true;
}
