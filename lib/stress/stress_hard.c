// SPDX-License-Identifier: GPL-3.0-or-later
// The soups, one function per kind.
#include "stress/stress_hard.h"

#include "base/hash.h"
#include "build/gen_world.h"

#include <math.h>
#include <string.h>

static const enf_stress_motion stay = {.scale = 1};

static void random_point(enf_stress_case *made, double size, double at[3]) {
    for (int a = 0; a < 3; a++) at[a] = enf_stress_uniform(made, -size, size);
}

/// A cube of side 2, turned; each copy moved and turned as a whole, by up to `amount` at its corners.
static void make_cubes(enf_stress_case *made, const enf_stress_hard *soup) {
    const enf_stress_motion place = {.turn = {17, 29, 43}, .scale = 1};
    for (int i = 0; i < soup->count; i++) {
        enf_stress_motion nudge = stay;
        for (int a = 0; a < 3; a++) {
            nudge.turn[a] = 20 * enf_stress_uniform(made, -soup->amount, soup->amount);
            nudge.move[a] = 0.6 * enf_stress_uniform(made, -soup->amount, soup->amount);
        }
        size_t first = made->soup.point_count;
        enf_stress_add_box(made, (const double[]){-1, -1, -1}, (const double[]){1, 1, 1}, ENF_STRESS_WHOLE);
        enf_stress_move(made, first, &place);
        enf_stress_move(made, first, &nudge);
    }
    made->truth = ENF_STRESS_SOLIDS;
}

/// Rectangles in the plane z = 0, or in planes that leave it by up to `amount`.
static void make_quads(enf_stress_case *made, const enf_stress_hard *soup) {
    for (int i = 0; i < soup->count; i++) {
        double x = enf_stress_uniform(made, -1, 0.5), y = enf_stress_uniform(made, -1, 0.5), w[2], slope[3];
        for (int a = 0; a < 2; a++) w[a] = enf_stress_uniform(made, 0.1, 1);
        random_point(made, soup->amount / 3, slope);
        double at[4][3];
        for (int k = 0; k < 4; k++) {
            at[k][0] = k == 1 || k == 2 ? x + w[0] : x;
            at[k][1] = k >= 2 ? y + w[1] : y;
            at[k][2] = slope[0] * at[k][0] + slope[1] * at[k][1] + slope[2];
        }
        enf_stress_add_polygon(made, 4, (const double(*)[3])at);
    }
    for (int side = -1; side <= 1; side += 2) { // air on both sides of the quads
        const double cap[3][3] = {{-1, -1, side}, {1, -1, side}, {0, 1, side}};
        enf_stress_add_polygon(made, 3, cap);
    }
}

static void make_triangles(enf_stress_case *made, const enf_stress_hard *soup) {
    for (int i = 0; i < soup->count; i++) {
        double at[3][3];
        for (int k = 0; k < 3; k++) random_point(made, soup->amount, at[k]);
        enf_stress_add_polygon(made, 3, (const double(*)[3])at);
    }
}

/// Triangles of length about 1 and width `amount`, in a box of side 20.
static void make_slivers(enf_stress_case *made, const enf_stress_hard *soup) {
    for (int i = 0; i < soup->count; i++) {
        double at[3][3], way[3];
        random_point(made, 10, at[0]);
        random_point(made, 0.5, way);
        double share = enf_stress_uniform(made, 0, 1);
        for (int a = 0; a < 3; a++) {
            at[1][a] = at[0][a] + way[a];
            at[2][a] = at[0][a] + share * way[a] + enf_stress_uniform(made, -soup->amount, soup->amount);
        }
        enf_stress_add_polygon(made, 3, (const double(*)[3])at);
    }
}

/// Rows of rectangles of random widths: each row's corners lie on its neighbours' edges. Every fifth row is a
/// wall.
static void make_strips(enf_stress_case *made, const enf_stress_hard *soup) {
    const double length = 20;
    int rows = (int)sqrt(soup->count), per_row = soup->count / rows;
    for (int row = 0; row < rows; row++) {
        double x = 0, widths[1024], sum = 0;
        for (int i = 0; i < per_row && i < 1024; i++) sum += widths[i] = enf_stress_uniform(made, 0.1, 1);
        for (int i = 0; i < per_row && i < 1024; i++) {
            double up = row % 2 ? 2 : -2, to = i + 1 < per_row ? x + widths[i] * length / sum : length,
                   y = row * length / rows, next = (row + 1) * length / rows;
            const double flat[4][3] = {{x, y, 0}, {to, y, 0}, {to, next, 0}, {x, next, 0}};
            const double wall[4][3] = {{x, y, 0}, {to, y, 0}, {to, y, up}, {x, y, up}};
            enf_stress_add_polygon(made, 4, row % 5 == 4 ? wall : flat);
            x = to;
        }
    }
}

/// 85 in 100 triangles have no area: corners that coincide, or lie in a row.
static void make_degenerate(enf_stress_case *made, const enf_stress_hard *soup) {
    for (int i = 0; i < soup->count; i++) {
        double at[3][3], way[3];
        random_point(made, 10, at[0]);
        for (int k = 1; k < 3; k++) {
            random_point(made, 0.5, way);
            for (int a = 0; a < 3; a++) at[k][a] = at[0][a] + way[a];
        }
        int kind = enf_stress_whole(made, 100);
        if (kind < 30) memcpy(at[2], at[1], sizeof at[2]);
        if (kind < 10) memcpy(at[1], at[0], sizeof at[1]);
        if (kind >= 30 && kind < 85)
            for (int a = 0; a < 3; a++) at[2][a] = at[0][a] + 2 * (at[1][a] - at[0][a]);
        enf_stress_add_polygon(made, 3, (const double(*)[3])at);
    }
}

static void sphere_point(double radius, int ring, int segment, double at[3]) {
    double s[2], c[2];
    enf_gen_sine_cosine(180.0 * ring / 16, &s[0], &c[0]);
    enf_gen_sine_cosine(360.0 * segment / 32, &s[1], &c[1]);
    at[0] = radius * s[0] * c[1];
    at[1] = radius * s[0] * s[1];
    at[2] = radius * c[0];
}

/// Spheres of 960 triangles around each other, turned, every second one facing inwards: shells of rock.
static void make_spheres(enf_stress_case *made, const enf_stress_hard *soup) {
    for (int i = 0; i < soup->count; i++) {
        size_t first = made->soup.point_count;
        for (int r = 0; r < 16; r++) {
            for (int s = 0; s < 32; s++) {
                double at[4][3], triangle[3][3];
                for (int k = 0; k < 4; k++)
                    sphere_point(1 + i, r + k / 2, (s + (k == 1 || k == 2)) % 32, at[k]);
                for (int half = 0; half < 2; half++) {
                    if (r == (half ? 0 : 15)) continue; // the poles
                    const int pick[2][3] = {{0, 3, 2}, {0, 2, 1}};
                    for (int k = 0; k < 3; k++)
                        memcpy(triangle[i % 2 ? 2 - k : k], at[pick[half][k]], sizeof at[0]);
                    enf_stress_add_polygon(made, 3, (const double(*)[3])triangle);
                }
            }
        }
        enf_stress_motion motion = stay;
        for (int a = 0; a < 3; a++) motion.turn[a] = enf_stress_uniform(made, -180, 180);
        enf_stress_move(made, first, &motion);
    }
}

/// Overlapping turned boxes that touch and share planes.
static void add_boxes(enf_stress_case *made, int count) {
    for (int i = 0; i < count; i++) {
        double low[3], high[3];
        for (int a = 0; a < 3; a++) {
            low[a] = enf_stress_whole(made, 20);
            high[a] = low[a] + 1 + enf_stress_whole(made, 4);
        }
        enf_stress_add_box(made, low, high, ENF_STRESS_WHOLE);
    }
    const enf_stress_motion motion = {.turn = {17, 29, 43}, .scale = 1};
    enf_stress_move(made, 0, &motion);
    made->truth = ENF_STRESS_SOLIDS;
}

static void make_far(enf_stress_case *made, const enf_stress_hard *soup) {
    add_boxes(made, soup->count);
    const enf_stress_motion motion = {.scale = 1, .move = {soup->amount, -soup->amount, soup->amount}};
    enf_stress_move(made, 0, &motion);
}

static void make_scaled(enf_stress_case *made, const enf_stress_hard *soup) {
    add_boxes(made, soup->count);
    const enf_stress_motion motion = {.scale = soup->amount / 40};
    enf_stress_move(made, 0, &motion);
    if (soup->amount > 1e100) made->truth = ENF_STRESS_UNKNOWN; // some boxes lose some faces
}

/// One triangle has a corner that is no number, or none that makes sense.
static void make_strange(enf_stress_case *made, const enf_stress_hard *soup) {
    add_boxes(made, soup->count);
    const double at[3][3] = {{1, 2, 3}, {4, 5, soup->amount}, {6, 8, 7}};
    enf_stress_add_polygon(made, 3, at);
}

// ---------------------------------------------------------------------------------------------- all

static const enf_stress_hard soups[] = {
    {"cubes-100-1e-12", "100 copies of a turned cube, jitter 1e-12 (below the default weld distance)",
     "timeout", 0, true, 1, make_cubes, 100, 1e-12},
    {"cubes-1000-1e-12", "1,000 copies of a turned cube, jitter 1e-12", "timeout at 100", 0, true, 1,
     make_cubes, 1000, 1e-12},
    {"cubes-20-1e-6", "20 copies of a turned cube, jitter 1e-6: every copy is another plane", "-", 0, true, 1,
     make_cubes, 20, 1e-6},
    {"cubes-100-1e-6", "100 copies of a turned cube, jitter 1e-6", "timeout", 0, true, 1, make_cubes, 100,
     1e-6},
    {"cubes-1000-1e-6", "1,000 copies of a turned cube, jitter 1e-6", "timeout at 100", 0, true, 1,
     make_cubes, 1000, 1e-6},
    {"cubes-1000-10", "1,000 cubes, jitter 10: they overlap here and there", "-", 0, true, 1, make_cubes,
     1000, 10},
    {"near-coplanar-200", "200 rectangles that leave one plane by 1e-9", "100 s, 3.5 GB", 100, true, 1e9,
     make_quads, 200, 1e-9},
    {"coplanar-200", "200 overlapping rectangles in one plane", "30 s, 937,000 cells", 30, false, 1,
     make_quads, 200, 0},
    {"triangles-100", "100 large random triangles", "-", 0, true, 1, make_triangles, 100, 10},
    {"triangles-300", "300 large random triangles", "timeout", 0, true, 1, make_triangles, 300, 10},
    {"slivers-10000", "10,000 triangles 1e-6 wide", "32 s", 32, false, 1, make_slivers, 10000, 1e-6},
    {"t-junctions", "2,500 rectangles in rows, corners on the neighbours' edges", "1.9 s", 1.9, false, 1,
     make_strips, 2500, 0},
    {"degenerate-85", "10,000 triangles, 85 % without area", "31 s", 31, false, 1, make_degenerate, 10000, 0},
    {"spheres-20000", "21 spheres in each other, 20,160 triangles", "2.1 s", 2.1, false, 1, make_spheres, 21,
     0},
    {"offset-1e7", "200 turned boxes, 1e7 from the origin", "-", 0, false, 1, make_far, 200, 1e7},
    {"scale-1e-60", "200 turned boxes of size 1e-60", "crash", 0, false, 1, make_scaled, 200, 1e-60},
    {"scale-1e99", "200 turned boxes of size 1e99", "crash", 0, false, 1, make_scaled, 200, 1e99},
    {"scale-1e100", "200 turned boxes of size 1e100", "crash", 0, false, 1, make_scaled, 200, 1e100},
    {"scale-2e100", "200 turned boxes of size 2e100: what is beyond 1e100 is rejected", "crash", 0, false, 1,
     make_scaled, 200, 2e100},
    {"one-nan", "200 turned boxes, one coordinate NaN", "hang", 0, false, 1, make_strange, 200, NAN},
    {"one-inf", "200 turned boxes, one coordinate infinite", "crash", 0, false, 1, make_strange, 200,
     INFINITY},
    {"one-1e308", "200 turned boxes, one coordinate 1e308", "crash", 0, false, 1, make_strange, 200, 1e308},
};

const enf_stress_hard *enf_stress_hard_find(int index) {
    return index >= 0 && index < (int)(sizeof soups / sizeof *soups) ? &soups[index] : NULL;
}

enf_status enf_stress_hard_make(enf_stress_case *made, const enf_stress_hard *soup, enf_error *error) {
    *made = (enf_stress_case){.weld = -1, .state = enf_hash_mix(1)};
    soup->make(made, soup);
    return made->failed ? enf_fail_memory(error, "a soup") : ENF_OK;
}
