// SPDX-License-Identifier: GPL-3.0-or-later
// One function per family. Every third seed compiles without welding where the soup is closed to the last
// bit.
#include "stress/stress_family.h"

#include "base/hash.h"
#include "build/gen_world.h"

#include <string.h>

static const enf_stress_motion stay = {.scale = 1};

static void random_point(enf_stress_case *made, double size, double at[3]) {
    for (int a = 0; a < 3; a++) at[a] = enf_stress_uniform(made, -size, size);
}

/// Boxes with corners on a lattice: they overlap, touch, and share planes.
static void add_lattice_boxes(enf_stress_case *made, int count, bool strips) {
    for (int i = 0; i < count; i++) {
        double low[3], high[3];
        for (int a = 0; a < 3; a++) {
            low[a] = enf_stress_whole(made, 6);
            high[a] = low[a] + 1 + enf_stress_whole(made, 5);
        }
        int kinds = strips ? 3 : 2;
        enf_stress_add_box(made, low, high, (enf_stress_faces)enf_stress_whole(made, kinds));
    }
    made->truth = ENF_STRESS_SOLIDS;
}

static void turn_all(enf_stress_case *made) {
    enf_stress_motion motion = stay;
    enf_stress_choose_turn(made, motion.turn);
    enf_stress_move(made, 0, &motion);
}

// ---------------------------------------------------------------------------------------------- moved solids

static void make_rotations(enf_stress_case *made) {
    add_lattice_boxes(made, 5, false);
    turn_all(made);
}

static void make_offsets(enf_stress_case *made) {
    add_lattice_boxes(made, 5, false);
    if (enf_stress_whole(made, 2)) turn_all(made);
    enf_stress_motion motion = stay;
    for (int a = 0; a < 3; a++)
        motion.move[a] = enf_stress_magnitude(made, 0, 7) * (enf_stress_whole(made, 2) ? 1 : -1);
    enf_stress_move(made, 0, &motion);
}

static void make_scales(enf_stress_case *made) {
    add_lattice_boxes(made, 5, false);
    if (enf_stress_whole(made, 2)) turn_all(made);
    enf_stress_motion motion = stay;
    motion.scale = enf_stress_magnitude(made, -60, 98);
    enf_stress_move(made, 0, &motion);
}

// ---------------------------------------------------------------------------------------------- jitter

/// Copies of one turned cube, each moved and turned as a whole by so much.
static void add_jittered_cubes(enf_stress_case *made, int count, double jitter) {
    enf_stress_motion place = stay;
    enf_stress_choose_turn(made, place.turn);
    for (int i = 0; i < count; i++) {
        enf_stress_motion nudge = stay;
        for (int a = 0; a < 3; a++) {
            nudge.turn[a] = enf_stress_uniform(made, -10 * jitter, 10 * jitter);
            nudge.move[a] = enf_stress_uniform(made, -jitter, jitter);
        }
        size_t first = made->soup.point_count;
        enf_stress_add_box(made, (const double[]){-2, -2, -2}, (const double[]){2, 2, 2}, ENF_STRESS_WHOLE);
        enf_stress_move(made, first, &place);
        enf_stress_move(made, first, &nudge);
    }
}

/// Copies of one tetrahedron, each corner moved on its own.
static void add_jittered_tetrahedra(enf_stress_case *made, int count, double jitter) {
    double corners[4][3];
    for (int k = 0; k < 4; k++) {
        for (int a = 0; a < 3; a++) corners[k][a] = (a == k - 1 ? 4 : 0) + enf_stress_uniform(made, -1, 1);
    }
    for (int i = 0; i < count; i++) {
        double moved[4][3];
        for (int k = 0; k < 12; k++)
            moved[k / 3][k % 3] = corners[k / 3][k % 3] + enf_stress_uniform(made, -jitter, jitter);
        enf_stress_add_tetrahedron(made, (const double(*)[3])moved);
    }
}

static void make_jitter(enf_stress_case *made) {
    double jitter = enf_stress_magnitude(made, -15, -2);
    made->truth = ENF_STRESS_SOLIDS;
    switch (enf_stress_whole(made, 4)) {
    case 0:
        add_jittered_tetrahedra(made, 5, jitter);
        break;
    case 1: // torn apart, by less than the default weld distance closes again
        add_lattice_boxes(made, 4, false);
        enf_stress_tear(made, jitter < 1e-10 ? jitter : 1e-10 * enf_stress_uniform(made, 0, 1));
        made->weld = -1;
        break;
    case 2: // torn apart for good: what is inside is nobody's to say
        add_lattice_boxes(made, 3, false);
        enf_stress_tear(made, jitter);
        made->truth = ENF_STRESS_UNKNOWN;
        break;
    default:
        add_jittered_cubes(made, 4, jitter);
        break;
    }
}

// ---------------------------------------------------------------------------------------------- coplanar

/// Bricks that share faces, edges and corners with their neighbours.
static void make_lattices(enf_stress_case *made) {
    double cut[3][5];
    for (int a = 0; a < 3; a++) {
        cut[a][0] = 0;
        for (int i = 1; i < 5; i++)
            cut[a][i] = cut[a][i - 1] + (enf_stress_whole(made, 2) ? 1 : enf_stress_uniform(made, 0.1, 2));
    }
    int fullness = 3 + enf_stress_whole(made, 5);
    for (int i = 0; i < 3 * 3 * 2; i++) {
        int at[3] = {i % 3, i / 3 % 3, i / 9};
        if (enf_stress_whole(made, 8) > fullness) continue;
        double low[3], high[3];
        for (int a = 0; a < 3; a++) {
            low[a] = cut[a][at[a]];
            high[a] = cut[a][at[a] + 1 + enf_stress_whole(made, 8) / 7];
        }
        enf_stress_add_box(made, low, high, (enf_stress_faces)enf_stress_whole(made, 2));
    }
    if (made->solid_count == 0)
        enf_stress_add_box(made, (const double[]){0, 0, 0}, (const double[]){1, 1, 1}, ENF_STRESS_WHOLE);
    made->truth = ENF_STRESS_SOLIDS;
    if (enf_stress_whole(made, 2)) turn_all(made);
}

/// Plates whose tops and bottoms lie in a few planes, some of them next to each other; sheared.
static void add_plates(enf_stress_case *made) {
    double tilt = enf_stress_uniform(made, -1, 1), gap = enf_stress_magnitude(made, -12, -1);
    const double level[4] = {0, gap, 1, 1 + gap};
    for (int i = 0; i < 6; i++) {
        double x = enf_stress_uniform(made, 0, 6), y = enf_stress_uniform(made, 0, 6),
               w = enf_stress_uniform(made, 1, 5), h = enf_stress_uniform(made, 1, 5),
               bottom = level[enf_stress_whole(made, 2)], top = level[2 + enf_stress_whole(made, 2)];
        double corners[8][3];
        for (int k = 0; k < 8; k++) {
            corners[k][0] = k & 1 ? x + w : x;
            corners[k][1] = k & 2 ? y + h : y;
            corners[k][2] = (k & 4 ? top : bottom) + tilt * corners[k][0];
        }
        enf_stress_add_hexahedron(made, (const double(*)[3])corners, ENF_STRESS_WHOLE);
    }
    made->truth = ENF_STRESS_SOLIDS;
}

/// Overlapping rectangles without thickness in one plane, and some in planes next to it.
static void add_sheets(enf_stress_case *made) {
    double tilt = enf_stress_uniform(made, -1, 1), gap = enf_stress_magnitude(made, -12, -6);
    for (int i = 0; i < 12; i++) {
        double x = enf_stress_uniform(made, 0, 6), y = enf_stress_uniform(made, 0, 6),
               w = enf_stress_uniform(made, 1, 5), h = enf_stress_uniform(made, 1, 5),
               z = i % 3 ? 0 : gap * i;
        const double at[4][3] = {{x, y, tilt * x + z},
                                 {x + w, y, tilt * (x + w) + z},
                                 {x + w, y + h, tilt * (x + w) + z},
                                 {x, y + h, tilt * x + z}};
        enf_stress_add_polygon(made, 4, at);
    }
    enf_stress_add_box(made, (const double[]){-1, -1, -20}, (const double[]){20, 20, 20}, ENF_STRESS_WHOLE);
}

static void make_stacks(enf_stress_case *made) {
    if (enf_stress_whole(made, 2))
        add_plates(made);
    else
        add_sheets(made);
    if (enf_stress_whole(made, 3) == 0) turn_all(made);
}

// ---------------------------------------------------------------------------------------------- thin and
// wild

static void add_sliver_triangles(enf_stress_case *made) {
    double width = enf_stress_magnitude(made, -12, -3);
    for (int i = 0; i < 16; i++) {
        double at[3][3];
        random_point(made, 10, at[0]);
        random_point(made, 10, at[1]);
        for (int a = 0; a < 3; a++)
            at[2][a] = (at[0][a] + at[1][a]) / 2 + enf_stress_uniform(made, -width, width);
        enf_stress_add_polygon(made, 3, (const double(*)[3])at);
    }
}

/// Plates and needles.
static void add_thin_boxes(enf_stress_case *made) {
    for (int i = 0; i < 5; i++) {
        double high[3], low[3];
        int thin = 1 + enf_stress_whole(made, 6); // at least one axis, at most two
        for (int a = 0; a < 3; a++) {
            high[a] = thin >> a & 1 ? enf_stress_magnitude(made, -6, -1) : enf_stress_uniform(made, 1, 5);
            low[a] = -high[a];
        }
        enf_stress_motion motion = stay;
        enf_stress_choose_turn(made, motion.turn);
        for (int a = 0; a < 3; a++) motion.move[a] = enf_stress_uniform(made, -2, 2);
        size_t first = made->soup.point_count;
        enf_stress_add_box(made, low, high, (enf_stress_faces)enf_stress_whole(made, 2));
        enf_stress_move(made, first, &motion);
    }
    made->truth = ENF_STRESS_SOLIDS;
}

static void make_slivers(enf_stress_case *made) {
    if (enf_stress_whole(made, 2))
        add_thin_boxes(made);
    else
        add_sliver_triangles(made);
}

/// In general position, or with corners on a small lattice: coplanar, collinear, and shared in every way.
static void make_triangles(enf_stress_case *made) {
    bool lattice = enf_stress_whole(made, 2);
    int count = lattice ? 40 : 16;
    for (int i = 0; i < count; i++) {
        double at[3][3];
        for (int k = 0; k < 3; k++) {
            random_point(made, 10, at[k]);
            for (int a = 0; a < 3 && lattice; a++) at[k][a] = enf_stress_whole(made, 4);
        }
        enf_stress_add_polygon(made, 3, (const double(*)[3])at);
    }
}

/// No area: a point, a segment there and back, corners in a row, corners next to each other.
static void add_junk(enf_stress_case *made) {
    double at[5][3], end[3], tiny = enf_stress_magnitude(made, -15, -11);
    random_point(made, 8, at[0]);
    random_point(made, 8, end);
    int kind = enf_stress_whole(made, 4), count = 3 + enf_stress_whole(made, 3);
    for (int k = 1; k < 5; k++) {
        for (int a = 0; a < 3; a++) {
            double share = kind == 0 ? 0 : (kind == 1 ? k % 2 : k * 0.25);
            at[k][a] = at[0][a] + share * (end[a] - at[0][a]) +
                       (kind == 3 ? enf_stress_uniform(made, -tiny, tiny) : 0);
        }
    }
    enf_stress_add_polygon(made, count, (const double(*)[3])at);
}

/// Solids with T-junctions, among copies of themselves and polygons without area.
static void make_degenerate(enf_stress_case *made) {
    made->weld = -1;
    add_lattice_boxes(made, 4, true);
    size_t copied = made->solid_count;
    for (size_t s = 0; s < copied && enf_stress_whole(made, 2); s++) { // the same box in another skin
        const double *points = made->soup.points;
        const int32_t *first = made->planes[made->solid_plane[s]],
                      *last = made->planes[made->solid_plane[s] + 1];
        double low[3], high[3];
        memcpy(low, points + 3 * (size_t)first[0], sizeof low);
        memcpy(high, points + 3 * (size_t)last[2], sizeof high);
        enf_stress_add_box(made, low, high, (enf_stress_faces)enf_stress_whole(made, 3));
    }
    int junk = 20 + enf_stress_whole(made, 20);
    for (int i = 0; i < junk; i++) add_junk(made);
    if (enf_stress_whole(made, 2)) turn_all(made);
}

// ---------------------------------------------------------------------------------------------- worlds

static void take_world(enf_stress_case *made, const enf_gen_world *world) {
    enf_soup *soup = &made->soup;
    made->failed = made->failed || world->failed || enf_soup_group(soup, "") < 0;
    for (size_t i = 0; i < world->point_count && !made->failed; i++)
        made->failed =
            !enf_soup_add_point(soup, world->points[i][0], world->points[i][1], world->points[i][2]);
    for (size_t i = 0; i < world->triangle_count && !made->failed; i++)
        made->failed =
            !enf_soup_add_polygon(soup, 3, world->triangles[i], NULL, NULL, -1, (int64_t)i + 1, 0, -1);
}

/// The built-in worlds, every corner of them moved a little. No spawn points: the polygons have to say what
/// is air.
static void make_worlds(enf_stress_case *made) {
    typedef void generator(enf_gen_world *, const enf_gen_options *);
    static generator *const worlds[] = {enf_gen_four_rooms, enf_gen_cavern, enf_gen_furnished,
                                        enf_gen_post_world, enf_gen_four_rooms_distorted};
    enf_gen_options options = {.floors = 1, .rooms = 2, .detail = 1, .scale = {1, 1, 1}};
    int which = enf_stress_whole(made, (int)(sizeof worlds / sizeof *worlds));
    options.noise = enf_stress_magnitude(made, -15, -2);
    if (enf_stress_whole(made, 2)) enf_stress_choose_turn(made, options.rotate);
    options.seed = made->state;
    enf_gen_world world = {0};
    worlds[which](&world, &options);
    if (!world.failed) enf_gen_transform(&world, &options);
    take_world(made, &world);
    enf_gen_world_free(&world);
    made->truth = ENF_STRESS_SHELLS;
}

// ---------------------------------------------------------------------------------------------- all

static const struct {
    const char *name, *description;
    void (*make)(enf_stress_case *made);
} families[] = {
    {"rotations", "overlapping boxes, turned: any angle, right angles, next to nothing", make_rotations},
    {"offsets", "overlapping boxes, up to 1e7 away from the origin", make_offsets},
    {"scales", "overlapping boxes of size 1e-60 to 1e99", make_scales},
    {"jitter", "copies of a solid, or of corners, moved by 1e-15 to 1e-2", make_jitter},
    {"lattices", "bricks that share faces, edges and corners", make_lattices},
    {"stacks", "plates and sheets in the same and in almost the same planes", make_stacks},
    {"slivers", "triangles, plates and needles down to 1e-12 thin", make_slivers},
    {"triangles", "random triangles, in general position and on a small lattice", make_triangles},
    {"degenerate", "solids with T-junctions among copies and polygons without area", make_degenerate},
    {"worlds", "the built-in worlds with noise of 1e-15 to 1e-2", make_worlds},
};

enum { FAMILY_COUNT = sizeof families / sizeof *families };

const char *enf_stress_family(int index, const char **description) {
    if (index < 0 || index >= FAMILY_COUNT) return NULL;
    if (description) *description = families[index].description;
    return families[index].name;
}

enf_status enf_stress_make(enf_stress_case *made, int family, uint64_t seed, enf_error *error) {
    *made = (enf_stress_case){.state = enf_hash_mix(seed + 1000003 * (uint64_t)family)};
    made->weld = seed % 3 == 0 ? 0 : -1;
    families[family].make(made);
    return made->failed ? enf_fail_memory(error, "a soup") : ENF_OK;
}
