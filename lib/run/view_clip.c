// SPDX-License-Identifier: MIT
// Clipping is done in homogeneous coordinates (x, y, w), before the division: a region's lines are planes
// through the eye there, so that corners beside and behind the eye need no care of their own (J. F. Blinn and
// M. E. Newell, "Clipping using homogeneous coordinates", SIGGRAPH 1978). What is left after the lines of a
// region, which is bounded, has w > 0. One line after the other: I. E. Sutherland and G. W. Hodgman,
// "Reentrant polygon clipping", CACM 1974.
#include "run/view_clip.h"

#include <math.h>
#include <string.h>

/// Regions are bounded: corners are hardly off the screen. Otherwise the geometry makes no sense.
static const double far_off = 16;

/// Room for corners while clipping: two polygons, of which one is read and one written.
typedef struct pad {
    double corners[2][ENF_VIEW_CORNERS][3];
    int32_t count;
    int now;
} pad;

void enf_region_measure(enf_view_region *region, const enf_view_lens *lens) {
    const double *g = lens->gram;
    for (int32_t i = 0; i < region->line_count; i++) {
        enf_view_line *l = &region->lines[i];
        double square = l->a * l->a * g[0] + l->b * l->b * g[1] + l->c * l->c * g[2] +
                        2 * (l->a * l->b * g[3] + l->a * l->c * g[4] + l->b * l->c * g[5]);
        l->length = square > 0 ? sqrt(square) * (1 + 1e-9) : 0;
    }
}

/// Keeps what has f[0] x + f[1] y + f[2] z + f[3] >= 0. False if the polygon is so far from convex that there
/// is no room.
static bool keep_side(pad *pad, const double f[4]) {
    double side[ENF_VIEW_CORNERS];
    const double(*from)[3] = (const double(*)[3])pad->corners[pad->now];
    int32_t count = pad->count, outside = 0;
    for (int32_t i = 0; i < count; i++) {
        side[i] = f[0] * from[i][0] + f[1] * from[i][1] + f[2] * from[i][2] + f[3];
        outside += !(side[i] >= 0);
    }
    if (outside == 0) return true;
    pad->count = 0;
    if (outside == count) return true;
    double(*to)[3] = pad->corners[!pad->now];
    int32_t made = 0;
    for (int32_t i = 0; i < count; i++) {
        int32_t j = i + 1 < count ? i + 1 : 0;
        bool in = side[i] >= 0, next_in = side[j] >= 0;
        if (made + 2 > ENF_VIEW_CORNERS) return false;
        if (in) memcpy(to[made++], from[i], sizeof *to);
        if (in == next_in) continue;
        double share = side[i] / (side[i] - side[j]);
        for (int a = 0; a < 3; a++) to[made][a] = from[i][a] + (from[j][a] - from[i][a]) * share;
        made++;
    }
    pad->now = !pad->now;
    pad->count = made;
    return true;
}

bool enf_view_is_near(const double eye[3], double near_distance, const double plane[4], const double (*v)[3],
                      int32_t count) {
    double distance = plane[0] * eye[0] + plane[1] * eye[1] + plane[2] * eye[2] + plane[3];
    if (fabs(distance) > near_distance) return false;
    for (int32_t i = 0; i < count; i++) {
        const double *from = v[i], *to = v[i + 1 < count ? i + 1 : 0];
        double e[3], inward[3], side = 0, square = 0;
        for (int a = 0; a < 3; a++) e[a] = to[a] - from[a];
        for (int a = 0; a < 3; a++) {
            inward[a] = plane[(a + 1) % 3] * e[(a + 2) % 3] - plane[(a + 2) % 3] * e[(a + 1) % 3];
            side += inward[a] * (eye[a] - from[a]);
            square += inward[a] * inward[a];
        }
        if (side < 0 && side * side > near_distance * near_distance * square) return false;
    }
    return true;
}

/// Are all corners outside of one side of the rectangle? Needs no w > 0.
static bool misses_rectangle(const double r[4], const double (*v)[3], int32_t count) {
    int32_t out[4] = {0};
    for (int32_t i = 0; i < count; i++) {
        out[0] += v[i][0] < (r[0] - ENF_VIEW_SLACK) * v[i][2];
        out[1] += v[i][1] < (r[1] - ENF_VIEW_SLACK) * v[i][2];
        out[2] += v[i][0] > (r[2] + ENF_VIEW_SLACK) * v[i][2];
        out[3] += v[i][1] > (r[3] + ENF_VIEW_SLACK) * v[i][2];
    }
    return out[0] == count || out[1] == count || out[2] == count || out[3] == count;
}

/// Divides by w, counter-clockwise. False if that can't be done.
static bool divide(const pad *pad, enf_view_piece *piece) {
    const double(*v)[3] = (const double(*)[3])pad->corners[pad->now];
    piece->count = pad->count;
    piece->nearest = INFINITY;
    double sum = 0;
    for (int32_t i = 0; i < pad->count; i++) {
        if (!(v[i][2] > 0)) return false;
        double inverse = 1 / v[i][2];
        piece->corners[i][0] = v[i][0] * inverse;
        piece->corners[i][1] = v[i][1] * inverse;
        sum += fabs(piece->corners[i][0]) + fabs(piece->corners[i][1]);
        piece->nearest = v[i][2] < piece->nearest ? v[i][2] : piece->nearest;
    }
    if (!(sum < far_off * pad->count)) return false;
    if (enf_polygon_area((const double(*)[2])piece->corners, piece->count) >= 0) return true;
    for (int32_t i = 0, j = piece->count - 1; i < j; i++, j--) {
        double swap[2];
        memcpy(swap, piece->corners[i], sizeof swap);
        memcpy(piece->corners[i], piece->corners[j], sizeof swap);
        memcpy(piece->corners[j], swap, sizeof swap);
    }
    return true;
}

/// Fills the pad with the vertices as seen. False if there is nothing.
static enf_view_outcome project(const enf_view_clipping *c, const double (*vertices)[3], int32_t count,
                                pad *pad) {
    pad->now = 0;
    pad->count = count;
    if (c->planes[0] || c->planes[1]) {
        memcpy(pad->corners[0], vertices, (size_t)count * sizeof *vertices);
        for (int i = 0; i < 2; i++)
            if (c->planes[i] && !keep_side(pad, c->planes[i])) return ENF_CLIP_WHOLE;
        if (pad->count == 0) return ENF_CLIP_OUT_POLYGON;
        vertices = (const double(*)[3])pad->corners[pad->now];
    }
    for (int32_t i = 0; i < pad->count; i++)
        enf_lens_project(c->lens, vertices[i], pad->corners[pad->now][i]);
    return ENF_CLIP_SEEN;
}

enf_view_outcome enf_view_clip(const enf_view_clipping *c, const double plane[4], const double (*vertices)[3],
                               int32_t count, enf_view_piece *piece) {
    piece->nearest = 0;
    if (enf_view_is_near(c->lens->eye, c->near_distance, plane, vertices, count)) return ENF_CLIP_WHOLE;
    if (count > ENF_VIEW_PORTAL_CORNERS) return ENF_CLIP_WHOLE;
    pad pad;
    enf_view_outcome outcome = project(c, vertices, count, &pad);
    if (outcome != ENF_CLIP_SEEN) return outcome;
    const double(*corners)[3] = (const double(*)[3])pad.corners[pad.now];
    if (!(c->without & ENF_VIEW_RECTANGLE) && misses_rectangle(c->region->rectangle, corners, pad.count))
        return ENF_CLIP_OUT_RECTANGLE;
    if (c->without & ENF_VIEW_POLYGON) return ENF_CLIP_WHOLE;
    for (int32_t i = 0; i < c->region->line_count && pad.count > 0; i++) {
        const enf_view_line *l = &c->region->lines[i];
        const double f[4] = {l->a, l->b, l->c, 0};
        if (!keep_side(&pad, f)) return ENF_CLIP_WHOLE;
    }
    if (pad.count == 0) return ENF_CLIP_OUT_POLYGON;
    return divide(&pad, piece) ? ENF_CLIP_SEEN : ENF_CLIP_WHOLE;
}
