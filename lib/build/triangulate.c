// SPDX-License-Identifier: GPL-3.0-or-later
// Ear clipping (Meisters, "Polygons have ears", 1975) in the coordinate plane that shows the ring largest,
// with exact turns. Every turn of the loop takes out one corner, so it ends on any input.
#include "build/triangulate.h"

#include "base/array.h"
#include "build/planar.h"
#include "build/ring.h"

#include <math.h>
#include <stdlib.h>

typedef struct clipper {
    const int32_t *ring;
    const double *points;
    int u, v, sign;
    int32_t *next, *previous; ///< the corners that are left, by position in the ring
    int32_t
        *blocker; ///< positions of corners that did not turn left at first: no others can be alone in an ear
    size_t blocker_count, blockers_gone;
    signed char *state; ///< per position: one of the values below
} clipper;

/// What is known of a corner. Taking out an ear changes this for its two neighbours only.
enum { UNKNOWN, EAR, CONVEX, FLAT, REFLEX };

static const double *corner(const clipper *c, int32_t i) {
    return &c->points[3 * (size_t)c->ring[i]];
}

static int turn(const clipper *c, const double *p, const double *q, const double *r) {
    return c->sign * enf_planar_turn(p, q, r, c->u, c->v);
}

static int turn_at(const clipper *c, int32_t i) {
    return turn(c, corner(c, c->previous[i]), corner(c, i), corner(c, c->next[i]));
}

static bool same_spot(const clipper *c, const double *p, const double *q) {
    return p[c->u] == q[c->u] && p[c->v] == q[c->v];
}

/// True if a corner that does not turn left lies in the closed triangle at i, other than at its corners.
static bool is_blocked(const clipper *c, int32_t i) {
    const double *p = corner(c, c->previous[i]), *q = corner(c, i), *r = corner(c, c->next[i]);
    double low[2], high[2];
    int axes[2] = {c->u, c->v};
    for (int k = 0; k < 2; k++) {
        low[k] = fmin(p[axes[k]], fmin(q[axes[k]], r[axes[k]]));
        high[k] = fmax(p[axes[k]], fmax(q[axes[k]], r[axes[k]]));
    }
    for (size_t b = 0; b < c->blocker_count; b++) {
        if (c->next[c->blocker[b]] < 0) continue;
        const double *at = corner(c, c->blocker[b]);
        if (at[c->u] < low[0] || at[c->u] > high[0] || at[c->v] < low[1] || at[c->v] > high[1]) continue;
        if (same_spot(c, at, p) || same_spot(c, at, q) || same_spot(c, at, r)) continue;
        if (turn(c, p, q, at) >= 0 && turn(c, q, r, at) >= 0 && turn(c, r, p, at) >= 0) return true;
    }
    return false;
}

static int state_of(const clipper *c, int32_t i) {
    int side = turn_at(c, i);
    if (side <= 0) return side == 0 ? FLAT : REFLEX;
    return is_blocked(c, i) ? CONVEX : EAR;
}

/// The corner to take out next, from `from` on: an ear; else one that turns left (the ring is not simple);
/// else one on a line; else any (the rest runs clockwise).
static int32_t find_ear(clipper *c, int32_t from, size_t left) {
    int32_t convex = -1, flat = -1, i = from;
    for (size_t tried = 0; tried < left; tried++, i = c->next[i]) {
        if (c->state[i] == UNKNOWN) c->state[i] = (signed char)state_of(c, i);
        if (c->state[i] == EAR) return i;
        if (c->state[i] == CONVEX && convex < 0) convex = i;
        if (c->state[i] == FLAT && flat < 0) flat = i;
    }
    return convex >= 0 ? convex : flat >= 0 ? flat : from;
}

static void take_out(clipper *c, int32_t ear) {
    int32_t before = c->previous[ear], after = c->next[ear];
    c->next[before] = after;
    c->previous[after] = before;
    c->next[ear] = c->previous[ear] = -1;
    c->state[before] = c->state[after] = UNKNOWN;
    if (++c->blockers_gone * 2 <= c->blocker_count) return;
    size_t kept = 0;
    for (size_t b = 0; b < c->blocker_count; b++)
        if (c->next[c->blocker[b]] >= 0) c->blocker[kept++] = c->blocker[b];
    c->blocker_count = kept;
    c->blockers_gone = 0;
}

static size_t clip(clipper *c, size_t count, int32_t (*triangles)[3]) {
    size_t made = 0;
    int32_t at = 1;
    for (size_t left = count; left >= 3; left--) {
        int32_t ear = left == 3 ? at : find_ear(c, at, left);
        int32_t before = c->previous[ear], after = c->next[ear];
        if (!enf_planar_collinear(corner(c, before), corner(c, ear), corner(c, after))) {
            triangles[made][0] = c->ring[before];
            triangles[made][1] = c->ring[ear];
            triangles[made++][2] = c->ring[after];
        }
        take_out(c, ear);
        at = after;
    }
    return made;
}

enf_status enf_triangulate(const int32_t *ring, size_t count, const double *points, int32_t (*triangles)[3],
                           size_t *made, enf_error *error) {
    clipper c = {.ring = ring, .points = points};
    c.next = enf_array_new(count, sizeof *c.next);
    c.previous = enf_array_new(count, sizeof *c.previous);
    c.blocker = enf_array_new(count, sizeof *c.blocker);
    c.state = enf_array_zeroed(count, sizeof *c.state);
    enf_status status = ENF_OK;
    *made = 0;
    if (!c.next || !c.previous || !c.blocker || !c.state) {
        status = enf_fail_memory(error, "triangulation");
    } else {
        enf_ring_projection(ring, count, points, &c.u, &c.v, &c.sign);
        for (size_t i = 0; i < count; i++) {
            c.next[i] = (int32_t)((i + 1) % count);
            c.previous[i] = (int32_t)((i + count - 1) % count);
        }
        for (size_t i = 0; i < count; i++)
            if (turn_at(&c, (int32_t)i) <= 0) c.blocker[c.blocker_count++] = (int32_t)i;
        *made = clip(&c, count, triangles);
    }
    free(c.next);
    free(c.previous);
    free(c.blocker);
    free(c.state);
    return status;
}
