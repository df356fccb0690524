// SPDX-License-Identifier: GPL-3.0-or-later
// Silhouette areas against figures with known areas, and against polygons cut into pieces one by one.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#include "build/moments.h"
#include "build/silhouette.h"

static uint64_t next_random(uint64_t *state) {
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static double random_unit(uint64_t *state) {
    return (double)(next_random(state) >> 11) * 0x1p-53;
}

static void add_outline(enf_silhouette *work, const double (*corners)[2], int count) {
    for (int i = 0; i < count; ++i)
        assert_true(enf_silhouette_add(work, corners[i], corners[(i + 1) % count], 1));
}

static double area_of(enf_silhouette *work) {
    double area;
    assert_true(enf_silhouette_area(work, &area));
    return area;
}

static void nothing_has_no_area(void **state) {
    (void)state;
    enf_silhouette work = {0};
    assert_true(area_of(&work) == 0);
    enf_silhouette_free(&work);
}

static void overlap_counts_once(void **state) {
    (void)state;
    const double a[][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}}, b[][2] = {{1, 1}, {3, 1}, {3, 3}, {1, 3}};
    enf_silhouette work = {0};
    add_outline(&work, a, 4);
    add_outline(&work, b, 4);
    assert_true(area_of(&work) == 7);
    add_outline(&work, a, 4);
    add_outline(&work, a, 4);
    assert_true(area_of(&work) == 4);
    enf_silhouette_free(&work);
}

static void a_star_of_two_triangles_is_cut_at_its_crossings(void **state) {
    (void)state;
    const double h = sqrt(3.0);
    const double a[][2] = {{-1, 0}, {1, 0}, {0, h}}, b[][2] = {{0, -h / 3}, {1, 2 * h / 3}, {-1, 2 * h / 3}};
    enf_silhouette work = {0};
    add_outline(&work, a, 3);
    add_outline(&work, b, 3);
    // Twelve small triangles of a ninth of the large one each.
    assert_true(fabs(area_of(&work) - 12.0 / 9 * h) < 1e-14);
    enf_silhouette_free(&work);
}

static void shared_edges_and_t_junctions_leave_no_gap(void **state) {
    (void)state;
    uint64_t seed = 5;
    enf_silhouette work = {0};
    for (int round = 0; round < 200; ++round) {
        // A triangle cut from its apex to points on its base that are on the base only up to rounding.
        double base[2][2], apex[2], area = 0;
        for (int k = 0; k < 2; ++k) {
            base[0][k] = random_unit(&seed);
            base[1][k] = random_unit(&seed);
        }
        apex[0] = (base[0][0] + base[1][0]) / 2 - (base[1][1] - base[0][1]);
        apex[1] = (base[0][1] + base[1][1]) / 2 + (base[1][0] - base[0][0]);
        double length = hypot(base[1][0] - base[0][0], base[1][1] - base[0][1]);
        area = length * length / 2;
        double last[2] = {base[0][0], base[0][1]};
        for (int i = 1; i <= 7; ++i) {
            double at = i / 7.0;
            double next[2] = {base[0][0] + (base[1][0] - base[0][0]) * at,
                              base[0][1] + (base[1][1] - base[0][1]) * at};
            if (i == 7) next[0] = base[1][0], next[1] = base[1][1];
            const double part[][2] = {{last[0], last[1]}, {next[0], next[1]}, {apex[0], apex[1]}};
            add_outline(&work, part, 3);
            last[0] = next[0], last[1] = next[1];
        }
        assert_true(fabs(area_of(&work) - area) < 1e-14);
    }
    enf_silhouette_free(&work);
}

enum { MOST_CORNERS = 64 };

typedef struct polygon {
    int count;
    double corners[MOST_CORNERS][2];
} polygon;

static double polygon_area(const polygon *p) {
    double area = 0;
    for (int i = 1; i + 1 < p->count; ++i)
        area += (p->corners[i][0] - p->corners[0][0]) * (p->corners[i + 1][1] - p->corners[0][1]) -
                (p->corners[i][1] - p->corners[0][1]) * (p->corners[i + 1][0] - p->corners[0][0]);
    return area / 2;
}

/// The part of a convex polygon to the left of the line from a to b (sign 1) or to the right (sign -1).
static polygon cut(const polygon *p, const double a[2], const double b[2], double sign) {
    polygon out = {0};
    for (int i = 0; i < p->count; ++i) {
        const double *u = p->corners[i], *v = p->corners[(i + 1) % p->count];
        double du = sign * ((b[0] - a[0]) * (u[1] - a[1]) - (b[1] - a[1]) * (u[0] - a[0]));
        double dv = sign * ((b[0] - a[0]) * (v[1] - a[1]) - (b[1] - a[1]) * (v[0] - a[0]));
        if (du >= 0 && out.count < MOST_CORNERS) {
            out.corners[out.count][0] = u[0];
            out.corners[out.count++][1] = u[1];
        }
        if (((du > 0 && dv < 0) || (du < 0 && dv > 0)) && out.count < MOST_CORNERS)
            for (int k = 0; k < 2; ++k) out.corners[out.count][k] = u[k] + (v[k] - u[k]) * (du / (du - dv));
        if ((du > 0 && dv < 0) || (du < 0 && dv > 0)) ++out.count;
    }
    return out;
}

/// Area of what is left of `p` outside the polygons first..last-1, by cutting off what lies outside each of
/// their edges.
static double area_outside(polygon p, const polygon *others, int first, int last) {
    if (p.count < 3) return 0;
    if (first == last) return polygon_area(&p);
    double area = 0;
    const polygon *other = &others[first];
    for (int i = 0; i < other->count && p.count >= 3; ++i) {
        const double *a = other->corners[i], *b = other->corners[(i + 1) % other->count];
        area += area_outside(cut(&p, a, b, -1), others, first + 1, last);
        p = cut(&p, a, b, 1);
    }
    return area;
}

static polygon random_polygon(uint64_t *seed, bool on_lattice) {
    polygon p = {.count = 3 + (int)(next_random(seed) % 3)};
    double x = random_unit(seed), y = random_unit(seed), r = 0.1 + 0.4 * random_unit(seed),
           turn = random_unit(seed);
    for (int i = 0; i < p.count; ++i) {
        p.corners[i][0] = x + r * cos(6.283185307179586 * (i + turn) / p.count);
        p.corners[i][1] = y + r * sin(6.283185307179586 * (i + turn) / p.count);
    }
    if (!on_lattice) return p;
    // Boxes and right triangles on a coarse lattice: edges on edges, corners on edges.
    double u = (double)(next_random(seed) % 5), v = (double)(next_random(seed) % 5);
    double w = 1 + (double)(next_random(seed) % 3), h = 1 + (double)(next_random(seed) % 3);
    const double box[4][2] = {{u, v}, {u + w, v}, {u + w, v + h}, {u, v + h}};
    p.count = next_random(seed) % 2 ? 4 : 3;
    for (int i = 0; i < p.count; ++i) p.corners[i][0] = box[i][0], p.corners[i][1] = box[i][1];
    return p;
}

static void the_area_of_a_union_is_that_of_its_disjoint_parts(void **state) {
    (void)state;
    uint64_t seed = 991;
    print_message("seed %llu\n", (unsigned long long)seed);
    enf_silhouette work = {0};
    for (int round = 0; round < 3000; ++round) {
        polygon polygons[8];
        int count = 1 + (int)(next_random(&seed) % 8);
        double expected = 0;
        for (int i = 0; i < count; ++i) {
            polygons[i] = random_polygon(&seed, round % 2);
            expected += area_outside(polygons[i], polygons, 0, i);
        }
        for (int i = 0; i < count; ++i)
            add_outline(&work, (const double(*)[2])polygons[i].corners, polygons[i].count);
        double area = area_of(&work);
        if (fabs(area - expected) > 1e-12)
            fail_msg("round %d: %.17g instead of %.17g", round, area, expected);
    }
    enf_silhouette_free(&work);
}

static void the_order_of_the_edges_does_not_change_a_bit(void **state) {
    (void)state;
    uint64_t seed = 17;
    enf_silhouette work = {0};
    for (int round = 0; round < 50; ++round) {
        polygon polygons[12];
        for (int i = 0; i < 12; ++i) polygons[i] = random_polygon(&seed, round % 2);
        double areas[2];
        for (int turn = 0; turn < 2; ++turn) {
            for (int i = 0; i < 12; ++i) {
                const polygon *p = &polygons[turn ? 11 - i : i];
                add_outline(&work, (const double(*)[2])p->corners, p->count);
            }
            areas[turn] = area_of(&work);
        }
        assert_true(areas[0] == areas[1]);
    }
    enf_silhouette_free(&work);
}

static void many_needles_through_one_point_are_done(void **state) {
    (void)state;
    enf_silhouette work = {0};
    enum { NEEDLES = 300 };
    for (int i = 0; i < NEEDLES; ++i) {
        double c = cos(3.14159265358979 * i / NEEDLES), s = sin(3.14159265358979 * i / NEEDLES), w = 1e-4;
        const double needle[][2] = {{-c + s * w, -s - c * w},
                                    {c + s * w, s - c * w},
                                    {c - s * w, s + c * w},
                                    {-c - s * w, -s + c * w}};
        add_outline(&work, needle, 4);
    }
    double area = area_of(&work);
    assert_true(area > 0.1 && area < NEEDLES * 4e-4);
    enf_silhouette_free(&work);
}

static void numbers_that_are_none_do_no_harm(void **state) {
    (void)state;
    enf_silhouette work = {0};
    const double bad[][2] = {{NAN, 0}, {1, INFINITY}, {-INFINITY, 2}, {0, 0}},
                 good[][2] = {{0, 0}, {1, 0}, {0, 1}};
    add_outline(&work, bad, 4);
    add_outline(&work, good, 3);
    double area;
    assert_true(enf_silhouette_area(&work, &area));
    enf_silhouette_free(&work);
}

/// The moments of a parallelepiped that spans from the origin along three edges, as six tetrahedra joined.
static enf_moments measure_block(const double edge[3][3]) {
    static const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    static const double origin[3] = {0, 0, 0};
    enf_moments block = {0};
    for (int t = 0; t < 6; ++t) {
        double corner[4][3] = {{0}};
        for (int i = 1; i < 4; ++i)
            for (int k = 0; k < 3; ++k) corner[i][k] = corner[i - 1][k] + edge[orders[t][i - 1]][k];
        const double *const face[3] = {corner[1], corner[2], corner[3]};
        enf_moments part = {0};
        enf_moments_add_cone(&part, origin, face, t < 3 ? 1 : -1);
        enf_moments_finish(&part, origin);
        if (t == 0)
            block = part;
        else
            enf_moments_join(&block, &part);
    }
    return block;
}

static void moments_bound_the_silhouette_of_a_block(void **state) {
    (void)state;
    static const double edge[3][3] = {{3, 0, 0}, {1, 2, 0}, {0.5, -0.25, 1}};
    const enf_moments block = measure_block(edge);
    assert_true(fabs(block.volume - 6) < 1e-12);
    for (int i = 0; i < 400; ++i) {
        double n[3] = {sin(i), sin(i * 1.7), cos(i * 0.3)}, truth = 0;
        for (int k = 0; k < 3 && i < 3; ++k) n[k] = edge[i][k];
        double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (int k = 0; k < 3; ++k) n[k] /= length;
        for (int a = 0; a < 3; ++a) {
            const double *u = edge[a], *v = edge[(a + 1) % 3];
            truth += fabs(n[0] * (u[1] * v[2] - u[2] * v[1]) + n[1] * (u[2] * v[0] - u[0] * v[2]) +
                          n[2] * (u[0] * v[1] - u[1] * v[0]));
        }
        double bound = enf_moments_silhouette_bound(&block, n);
        assert_true(bound <= truth);
        assert_true(bound >= truth * (i < 3 ? 0.9999 : 0.5)); // exact along an edge
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_has_no_area),
        cmocka_unit_test(overlap_counts_once),
        cmocka_unit_test(a_star_of_two_triangles_is_cut_at_its_crossings),
        cmocka_unit_test(shared_edges_and_t_junctions_leave_no_gap),
        cmocka_unit_test(the_area_of_a_union_is_that_of_its_disjoint_parts),
        cmocka_unit_test(the_order_of_the_edges_does_not_change_a_bit),
        cmocka_unit_test(many_needles_through_one_point_are_done),
        cmocka_unit_test(numbers_that_are_none_do_no_harm),
        cmocka_unit_test(moments_bound_the_silhouette_of_a_block),
    };
    return cmocka_run_group_tests_name("silhouette", tests, NULL, NULL);
}
