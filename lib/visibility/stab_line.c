// SPDX-License-Identifier: GPL-3.0-or-later
// Real lines near a solution of the linear relaxation. With p = direction + moment and q = direction -
// moment, x = (direction, moment) is a line if |p| = |q|: stretching both to one length gives the line next
// to x.
#include "visibility/stab_parts.h"

#include <math.h>
#include <string.h>

/// The search gives up after so many steps, or when a step keeps so much of the form: it ends at a least
/// value that is not 0, most often because there is no line.
enum { STEPS = 40 };
static const double kept_at_most = 0.95;

static double dot3(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++) out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static bool stretch(double v[3], double length) {
    const double now = sqrt(dot3(v, v));
    for (int i = 0; i < 3; i++) v[i] *= length / now;
    return now > 0 && now < HUGE_VAL;
}

bool enf_stabber_line(const enf_stabber *stabber, const double x[ENF_PLUECKER], enf_line *line) {
    double p[3], q[3], along[3], moment[3], nearest[3];
    for (int i = 0; i < 3; i++) {
        p[i] = x[i] + x[3 + i];
        q[i] = x[i] - x[3 + i];
    }
    if (!stretch(p, 0.5) || !stretch(q, 0.5)) return false;
    for (int i = 0; i < 3; i++) {
        along[i] = p[i] + q[i];
        moment[i] = p[i] - q[i];
    }
    const double square = dot3(along, along);
    if (!(square > 0x1p-60)) return false; // next to a line at infinity
    cross(along, moment, nearest);
    stretch(along, 2); // the sequence is within sqrt(3) of the origin
    for (int i = 0; i < 3; i++) {
        line->from[i] = stabber->origin[i] + (nearest[i] / square - along[i]) / stabber->scale;
        line->to[i] = stabber->origin[i] + (nearest[i] / square + along[i]) / stabber->scale;
    }
    return true;
}

void enf_stabber_coordinates(const enf_stabber *stabber, const enf_line *line, double x[ENF_PLUECKER]) {
    double at[3];
    for (int i = 0; i < 3; i++) {
        x[i] = (line->to[i] - line->from[i]) * stabber->scale;
        at[i] = (line->from[i] - stabber->origin[i]) * stabber->scale;
    }
    stretch(x, 1);
    cross(at, x, x + 3);
}

enf_line enf_stabber_guess(const enf_stabber *stabber) {
    const int32_t first_portal = stabber->sequence[0];
    const enf_pluecker_opening *openings = stabber->pluecker->openings;
    const enf_pluecker_opening *first = &openings[first_portal >> 1],
                               *last = &openings[stabber->sequence[stabber->count - 1] >> 1];
    enf_line line;
    memcpy(line.from, first->middle, sizeof line.from);
    memcpy(line.to, last->middle, sizeof line.to);
    if (memcmp(line.from, line.to, sizeof line.to) == 0) {
        for (int i = 0; i < 3; i++)
            line.to[i] += (first_portal & 1 ? -first->normal[i] : first->normal[i]) / stabber->scale;
    }
    return line;
}

bool enf_stabber_passes(const enf_stabber *stabber, const enf_line *line) {
    const enf_portal_graph *graph = stabber->pluecker->graph;
    bool unsure = false;
    for (int32_t i = stabber->count - 1; i >= 0; i--) {
        int sign = enf_line_passes_quickly(line, graph, stabber->sequence[i]);
        if (sign < 0) return false;
        unsure |= sign == 0;
    }
    for (int32_t i = 0; unsure && i < stabber->count; i++) {
        if (!enf_line_passes(line, graph, stabber->sequence[i])) return false;
    }
    return stabber->side_count == 0 || enf_stabber_passes_wholly(stabber, line);
}

/// The quadratic form, times 2, between two points.
static double form(const double x[ENF_PLUECKER], const double y[ENF_PLUECKER]) {
    return dot3(x, y + 3) + dot3(x + 3, y);
}

static void make_unit(double x[ENF_PLUECKER]) {
    const double length = sqrt(dot3(x, x) + dot3(x + 3, x + 3));
    for (int i = 0; i < ENF_PLUECKER; i++) x[i] /= length;
}

static double dot6(const double x[ENF_PLUECKER], const double y[ENF_PLUECKER]) {
    return dot3(x, y) + dot3(x + 3, y + 3);
}

/// The least s > 0 with a + b s + c s^2 = 0, a < 0; infinity if there is none.
static double first_root(double a, double b, double c) {
    const double under_root = b * b - 4 * a * c;
    if (!(under_root >= 0)) return HUGE_VAL;
    const double root = sqrt(under_root);
    if (b > 0) return -2 * a / (b + root);
    return c > 0 ? (root - b) / (2 * c) : HUGE_VAL;
}

/// Of the points x + s y, s > 0: where the form is first 0, or else where its quotient with the square of the
/// length is least. Both are of unit length; the quotient falls from x towards y.
static void step(double x[ENF_PLUECKER], const double y[ENF_PLUECKER]) {
    const double sign = form(x, x) < 0 ? -1 : 1;
    const double a = sign * form(x, x), b = sign * form(x, y), c = sign * form(y, y), d = dot6(x, y);
    double s = first_root(-a, -2 * b, -c);
    if (s == HUGE_VAL) s = first_root(b - a * d, c - a, c * d - b);
    for (int i = 0; i < ENF_PLUECKER; i++) x[i] = s < HUGE_VAL ? x[i] + s * y[i] : y[i];
    make_unit(x);
}

/// A point y of the open cone with <y, down> > 0: one constraint more.
static bool go_down(enf_stabber *stabber, double down[ENF_PLUECKER], double y[ENF_PLUECKER]) {
    const size_t stride = (size_t)stabber->capacity;
    enf_min_norm hull;
    make_unit(down);
    for (int i = 0; i < ENF_PLUECKER; i++)
        stabber->vectors[(size_t)i * stride + (size_t)stabber->edge_count] = down[i];
    if (enf_min_norm_find(stabber->vectors, stabber->edge_count + 1, stabber->capacity, NULL, ENF_STAB_MARGIN,
                          0, stabber->products, &hull) != ENF_MIN_NORM_POSITIVE)
        return false;
    memcpy(y, hull.x, sizeof hull.x);
    make_unit(y);
    return true;
}

/// Another point of the open cone: one at which the form with x has the other sign, or else one towards which
/// the form's quotient with the square of the length falls.
static bool turn_to(enf_stabber *stabber, const double x[ENF_PLUECKER], double y[ENF_PLUECKER]) {
    const double value = form(x, x), sign = value < 0 ? 1 : -1;
    double down[ENF_PLUECKER];
    for (int i = 0; i < ENF_PLUECKER; i++) down[i] = sign * x[(i + 3) % ENF_PLUECKER];
    if (go_down(stabber, down, y)) return true;
    for (int i = 0; i < ENF_PLUECKER; i++) down[i] = sign * (x[(i + 3) % ENF_PLUECKER] - value * x[i]);
    return go_down(stabber, down, y);
}

bool enf_stabber_search(enf_stabber *stabber, enf_line *line) {
    double x[ENF_PLUECKER], y[ENF_PLUECKER];
    memcpy(x, stabber->hull.x, sizeof x);
    make_unit(x);
    for (int i = 0; i < STEPS; i++) {
        const double before = fabs(form(x, x));
        if (enf_stabber_line(stabber, x, line) && enf_stabber_passes(stabber, line)) return true;
        if (i == 0) stabber->counts.searched++;
        if (!turn_to(stabber, x, y)) return false;
        step(x, y);
        if (fabs(form(x, x)) > kept_at_most * before) return false;
    }
    return false;
}
