// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/solid.h"

#include "visibility/flat_hull.h"

#include <math.h>
#include <string.h>

static void find_box(const double (*points)[3], int32_t count, double low[3], double high[3]) {
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = INFINITY;
        high[axis] = -INFINITY;
        for (int32_t i = 0; i < count; i++) {
            low[axis] = fmin(low[axis], points[i][axis]);
            high[axis] = fmax(high[axis], points[i][axis]);
        }
    }
}

void enf_solid_make(enf_solid *solid, const double (*points)[3], int32_t count) {
    double box[2][3];
    if (count <= ENF_SOLID_CORNERS) {
        memcpy(solid->corners, points, (size_t)count * sizeof *points);
        solid->count = count;
        return;
    }
    find_box(points, count, box[0], box[1]);
    solid->count = 8;
    for (int i = 0; i < 8; i++)
        for (int axis = 0; axis < 3; axis++) solid->corners[i][axis] = box[i >> axis & 1][axis];
}

/// Where the ways from corners in front to corners behind cross the plane: the corners of the face that the
/// cut makes. Returns how many.
static int32_t find_face(const enf_solid *solid, const enf_cut *cut, const double *heights,
                         double (*face)[3]) {
    enum { MOST = ENF_SOLID_CORNERS * ENF_SOLID_CORNERS / 4 };
    double points[MOST][3], hull[2 * MOST + 1][3];
    int32_t count = 0, kept = 0;
    for (int32_t i = 0; i < solid->count; i++)
        for (int32_t k = 0; heights[i] > 0 && k < solid->count; k++) {
            if (heights[k] >= 0) continue;
            const double share = heights[i] / (heights[i] - heights[k]);
            for (int axis = 0; axis < 3; axis++)
                points[count][axis] =
                    solid->corners[i][axis] + share * (solid->corners[k][axis] - solid->corners[i][axis]);
            count++;
        }
    const int32_t made = enf_flat_hull(points, count, cut->normal, hull);
    if (made > ENF_SOLID_CORNERS) return made;
    for (int32_t i = 0; i < made; i++)
        if (kept == 0 || memcmp(hull[i], face[kept - 1], sizeof *hull) != 0)
            memcpy(face[kept++], hull[i], sizeof *hull);
    return kept;
}

bool enf_solid_cut(enf_solid *solid, const enf_cut *cut) {
    double heights[ENF_SOLID_CORNERS], face[ENF_SOLID_CORNERS][3];
    int32_t front = 0, kept = 0;
    for (int32_t i = 0; i < solid->count; i++) {
        heights[i] = enf_dot(cut->normal, solid->corners[i]) - cut->least;
        front += heights[i] >= 0;
    }
    if (front == solid->count || front == 0) return front > 0;
    const int32_t made = find_face(solid, cut, heights, face);
    if (front + made > ENF_SOLID_CORNERS) return true;
    for (int32_t i = 0; i < solid->count; i++)
        if (heights[i] >= 0) memmove(solid->corners[kept++], solid->corners[i], sizeof *solid->corners);
    memcpy(solid->corners + kept, face, (size_t)made * sizeof *face);
    solid->count = kept + made;
    return true;
}

bool enf_solid_cut_all(enf_solid *solid, const enf_separators *cuts) {
    for (int32_t i = 0; i < cuts->count; i++) {
        const enf_cut cut = {{cuts->normal[0][i], cuts->normal[1][i], cuts->normal[2][i]}, cuts->least[i]};
        if (!enf_solid_cut(solid, &cut)) return false;
    }
    return true;
}

double enf_solid_extent(const enf_solid *solid, int *axis, double *middle) {
    double low[3], high[3];
    find_box((const double(*)[3])solid->corners, solid->count, low, high);
    *axis = 0;
    for (int i = 1; i < 3; i++)
        if (high[i] - low[i] > high[*axis] - low[*axis]) *axis = i;
    *middle = (low[*axis] + high[*axis]) / 2;
    return high[*axis] - low[*axis];
}

void enf_solid_middle(const enf_solid *solid, double middle[3]) {
    memset(middle, 0, 3 * sizeof *middle);
    for (int32_t i = 0; i < solid->count; i++)
        for (int axis = 0; axis < 3; axis++) middle[axis] += solid->corners[i][axis] / solid->count;
}
