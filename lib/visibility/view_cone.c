// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/view_cone.h"

#include <math.h>

void enf_view_cone_find(enf_separators *cone, const double eye[3], const enf_window *window, int32_t portal) {
    const double sign = portal & 1 ? -1 : 1;
    cone->count = 0;
    cone->spare = 0;
    for (int32_t i = 0; i < window->count && cone->count < ENF_SEPARATORS_MOST; i++) {
        double a[3], b[3], normal[3];
        for (int axis = 0; axis < 3; axis++) {
            a[axis] = window->at[axis][i] - eye[axis];
            b[axis] = window->at[axis][i + 1] - eye[axis]; // windows are closed
        }
        for (int axis = 0; axis < 3; axis++) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            normal[axis] = sign * (a[u] * b[v] - a[v] * b[u]);
        }
        const double length = sqrt(enf_dot(normal, normal));
        if (!(length > 0)) continue;
        for (int axis = 0; axis < 3; axis++) cone->normal[axis][cone->count] = normal[axis] / length;
        cone->least[cone->count++] = enf_dot(normal, eye) / length;
    }
    enf_separators_close(cone);
}

bool enf_view_cone_has(const enf_separators *cone, const double point[3]) {
    for (int32_t i = 0; i < cone->count; i++) {
        const double normal[3] = {cone->normal[0][i], cone->normal[1][i], cone->normal[2][i]};
        if (enf_dot(normal, point) < cone->least[i]) return false;
    }
    return true;
}
