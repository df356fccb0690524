// SPDX-License-Identifier: GPL-3.0-or-later
#include "stress/stress_case.h"

#include "base/array.h"
#include "build/gen_world.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void enf_stress_case_free(enf_stress_case *made) {
    enf_soup_free(&made->soup);
    free(made->planes);
    free(made->solid_plane);
    memset(made, 0, sizeof *made);
}

// ---------------------------------------------------------------------------------------------- numbers

double enf_stress_uniform(enf_stress_case *made, double low, double high) {
    return low + (high - low) * (double)(enf_gen_random(&made->state) >> 11) * 0x1p-53;
}

int enf_stress_whole(enf_stress_case *made, int count) {
    return (int)(enf_gen_random(&made->state) % (uint64_t)count);
}

double enf_stress_power_of_ten(int exponent) {
    double power = 1;
    for (int i = 0; i < exponent; i++) power *= 10;
    for (int i = 0; i > exponent; i--) power /= 10;
    return power;
}

double enf_stress_magnitude(enf_stress_case *made, int low, int high) {
    double power = enf_stress_power_of_ten(low + enf_stress_whole(made, high - low));
    return power * enf_stress_uniform(made, 1, 10);
}

// ---------------------------------------------------------------------------------------------- polygons

static int32_t add_point(enf_stress_case *made, const double at[3]) {
    made->failed = made->failed || !enf_soup_add_point(&made->soup, at[0], at[1], at[2]);
    return made->failed ? 0 : (int32_t)made->soup.point_count - 1;
}

static void add_ring(enf_stress_case *made, int count, const int32_t *corners) {
    made->failed = made->failed || enf_soup_group(&made->soup, "") < 0 ||
                   !enf_soup_add_polygon(&made->soup, (size_t)count, corners, NULL, NULL, -1,
                                         (int64_t)made->soup.polygon_count + 1, 0, -1);
}

void enf_stress_add_polygon(enf_stress_case *made, int count, const double (*corners)[3]) {
    int32_t ring[16];
    for (int i = 0; i < count && i < 16; i++) ring[i] = add_point(made, corners[i]);
    add_ring(made, count, ring);
}

// ---------------------------------------------------------------------------------------------- solids

static void begin_solid(enf_stress_case *made) {
    if (made->failed || !enf_array_reserve(made->solid_plane, made->solid_capacity, made->solid_count + 1)) {
        made->failed = true;
        return;
    }
    made->solid_plane[made->solid_count++] = made->plane_count;
}

static void add_plane(enf_stress_case *made, int32_t a, int32_t b, int32_t c) {
    if (made->failed || !enf_array_reserve(made->planes, made->plane_capacity, made->plane_count + 1)) {
        made->failed = true;
        return;
    }
    int32_t *plane = made->planes[made->plane_count++];
    plane[0] = a, plane[1] = b, plane[2] = c;
}

static void mix(const double p[3], const double q[3], double share, double out[3]) {
    for (int a = 0; a < 3; a++) out[a] = p[a] + share * (q[a] - p[a]);
}

/// Two to four strips between the edges 0-1 and 3-2; their ends are new points on those edges.
static void add_strips(enf_stress_case *made, const int32_t ring[4]) {
    int count = 2 + enf_stress_whole(made, 3);
    int32_t low = ring[0], high = ring[3];
    for (int i = 1; i <= count && !made->failed; i++) {
        int32_t next_low = ring[1], next_high = ring[2];
        if (i < count) {
            const double *points = made->soup.points;
            double at[2][3], share = i / 4.0; // exact on a lattice
            mix(points + 3 * (size_t)ring[0], points + 3 * (size_t)ring[1], share, at[0]);
            mix(points + 3 * (size_t)ring[3], points + 3 * (size_t)ring[2], share, at[1]);
            next_low = add_point(made, at[0]);
            next_high = add_point(made, at[1]);
        }
        add_ring(made, 4, (const int32_t[]){low, next_low, next_high, high});
        low = next_low, high = next_high;
    }
}

static void add_quad(enf_stress_case *made, const int32_t ring[4], enf_stress_faces faces) {
    add_plane(made, ring[0], ring[1], ring[2]);
    if (faces == ENF_STRESS_WHOLE) {
        add_ring(made, 4, ring);
    } else if (faces == ENF_STRESS_CUT) {
        int first = enf_stress_whole(made, 2);
        for (int i = 0; i < 2; i++) {
            const int32_t *at[3] = {&ring[(first + 2 * i) % 4], &ring[(first + 2 * i + 1) % 4],
                                    &ring[(first + 2 * i + 2) % 4]};
            add_ring(made, 3, (const int32_t[]){*at[0], *at[1], *at[2]});
        }
    } else {
        add_strips(made, ring);
    }
}

void enf_stress_add_hexahedron(enf_stress_case *made, const double corners[8][3], enf_stress_faces faces) {
    static const int sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                    {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    int32_t points[8];
    begin_solid(made);
    for (int i = 0; i < 8; i++) points[i] = add_point(made, corners[i]);
    for (int s = 0; s < 6; s++) {
        int32_t ring[4];
        for (int k = 0; k < 4; k++) ring[k] = points[sides[s][k]];
        add_quad(made, ring, faces);
    }
}

void enf_stress_add_box(enf_stress_case *made, const double low[3], const double high[3],
                        enf_stress_faces faces) {
    double corners[8][3];
    for (int i = 0; i < 8; i++)
        for (int a = 0; a < 3; a++) corners[i][a] = i >> a & 1 ? high[a] : low[a];
    enf_stress_add_hexahedron(made, (const double(*)[3])corners, faces);
}

void enf_stress_add_tetrahedron(enf_stress_case *made, const double corners[4][3]) {
    static const int sides[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    double e[3][3];
    for (int i = 0; i < 3; i++)
        for (int a = 0; a < 3; a++) e[i][a] = corners[i + 1][a] - corners[0][a];
    double volume = e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
                    e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
                    e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
    int32_t points[4];
    begin_solid(made);
    for (int i = 0; i < 4; i++) points[i] = add_point(made, corners[i]);
    for (int s = 0; s < 4; s++) {
        int32_t a = points[sides[s][0]], b = points[sides[s][volume > 0 ? 1 : 2]],
                c = points[sides[s][volume > 0 ? 2 : 1]];
        add_plane(made, a, b, c);
        add_ring(made, 3, (const int32_t[]){a, b, c});
    }
}

// ---------------------------------------------------------------------------------------------- motion

void enf_stress_move(enf_stress_case *made, size_t first, const enf_stress_motion *motion) {
    double matrix[3][3];
    enf_gen_rotation(motion->turn, matrix);
    bool turns = motion->turn[0] != 0 || motion->turn[1] != 0 || motion->turn[2] != 0;
    for (size_t i = first; i < made->soup.point_count; i++) {
        double *point = made->soup.points + 3 * i;
        if (turns) enf_gen_rotate(matrix, point, point);
        for (int a = 0; a < 3; a++) point[a] = point[a] * motion->scale + motion->move[a];
    }
}

void enf_stress_choose_turn(enf_stress_case *made, double turn[3]) {
    int kind = enf_stress_whole(made, 5);
    for (int a = 0; a < 3; a++) {
        if (kind == 0)
            turn[a] = 90.0 * enf_stress_whole(made, 4);
        else if (kind == 1)
            turn[a] = enf_stress_magnitude(made, -15, -6);
        else
            turn[a] = enf_stress_uniform(made, -180, 180);
    }
}

void enf_stress_tear(enf_stress_case *made, double length) {
    enf_soup *soup = &made->soup;
    for (size_t c = 0; c < soup->corner_count && !made->failed; c++) {
        double at[3];
        memcpy(at, soup->points + 3 * (size_t)soup->corner_point[c], sizeof at);
        for (int a = 0; a < 3; a++) at[a] += enf_stress_uniform(made, -length, length);
        soup->corner_point[c] = add_point(made, at);
    }
}

bool enf_stress_bounds(const enf_stress_case *made, double low[3], double high[3]) {
    for (int a = 0; a < 3; a++) low[a] = HUGE_VAL, high[a] = -HUGE_VAL;
    for (size_t i = 0; i < 3 * made->soup.point_count; i++) {
        double x = made->soup.points[i];
        if (!(fabs(x) <= 1e100)) continue;
        low[i % 3] = fmin(low[i % 3], x);
        high[i % 3] = fmax(high[i % 3], x);
    }
    return low[0] <= high[0] && low[1] <= high[1] && low[2] <= high[2];
}
