// SPDX-License-Identifier: GPL-3.0-or-later
// Planes by Cramer's rule from their points, vertices by Cramer's rule from their planes, both divided by
// their greatest common divisor. Signs are read off doubles where these are far enough from zero, and
// computed with GMP otherwise.
#include "build/check_exact.h"

#include "base/array.h"
#include "base/hash.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

__extension__ typedef __int128 wide;
__extension__ typedef unsigned __int128 unsigned_wide;

enum { TERMS = 12 };

/// Relative to the sum of the terms' magnitudes: coefficients and coordinates are off by less than 2^-50
/// each, and a few roundings of 2^-53 come on top.
static const double near_zero = 0x1p-46;

// ---------------------------------------------------------------------------------------------- tuples

static mpz_srcptr read_number(const enf_check_exact *exact, const enf_check_tuple *tuple, int i, mpz_t view) {
    int64_t at = tuple->first;
    for (int k = 0; k < i; k++) at += abs(tuple->size[k]);
    return mpz_roinit_n(view, exact->limbs + at, tuple->size[i]);
}

/// Divides four numbers by their greatest common divisor and appends them to the arena. Returns 0 without
/// memory.
static bool store(enf_check_exact *exact, mpz_t number[4], enf_check_tuple *tuple) {
    mpz_ptr divisor = exact->term[TERMS - 1];
    mpz_gcd(divisor, number[0], number[1]);
    mpz_gcd(divisor, divisor, number[2]);
    mpz_gcd(divisor, divisor, number[3]);
    size_t total = 0;
    for (int i = 0; i < 4; i++) {
        if (mpz_cmp_ui(divisor, 1) > 0) mpz_divexact(number[i], number[i], divisor);
        total += mpz_size(number[i]);
    }
    if (!enf_array_reserve(exact->limbs, exact->limb_capacity, exact->limb_count + total)) return false;
    tuple->first = (int64_t)exact->limb_count;
    for (int i = 0; i < 4; i++) {
        size_t size = mpz_size(number[i]);
        if (size)
            memcpy(exact->limbs + exact->limb_count, mpz_limbs_read(number[i]), size * sizeof *exact->limbs);
        tuple->size[i] = (int16_t)(mpz_sgn(number[i]) < 0 ? -(int)size : (int)size);
        exact->limb_count += size;
    }
    return true;
}

static size_t tuple_limbs(const enf_check_tuple *tuple) {
    return (size_t)(abs(tuple->size[0]) + abs(tuple->size[1]) + abs(tuple->size[2]) + abs(tuple->size[3]));
}

static uint64_t tuple_hash(const enf_check_exact *exact, const enf_check_tuple *tuple) {
    uint64_t hash = enf_hash64(tuple->size, sizeof tuple->size, 0);
    return enf_hash64(exact->limbs + tuple->first, tuple_limbs(tuple) * sizeof *exact->limbs, hash);
}

static bool same_tuple(const enf_check_exact *exact, const enf_check_tuple *a, const enf_check_tuple *b) {
    return memcmp(a->size, b->size, sizeof a->size) == 0 &&
           memcmp(exact->limbs + a->first, exact->limbs + b->first, tuple_limbs(a) * sizeof *exact->limbs) ==
               0;
}

static bool table_make(enf_check_table *table, size_t count) {
    size_t slots = 16;
    while (slots < 2 * count) slots *= 2;
    table->slots = enf_array_new(slots, sizeof *table->slots);
    table->mask = slots - 1;
    for (size_t i = 0; table->slots && i < slots; i++) table->slots[i] = -1;
    return table->slots != NULL;
}

/// The slot that holds a tuple equal to `tuple`, or the empty one where it belongs.
static int32_t *table_find(const enf_check_exact *exact, const enf_check_table *table,
                           const enf_check_tuple *tuples, const enf_check_tuple *tuple) {
    size_t slot = tuple_hash(exact, tuple) & table->mask;
    while (table->slots[slot] >= 0 && !same_tuple(exact, &tuples[table->slots[slot]], tuple))
        slot = (slot + 1) & table->mask;
    return &table->slots[slot];
}

// ---------------------------------------------------------------------------------------------- points and
// planes

static int64_t coordinate(const enf_check_exact *exact, int32_t point, int axis) {
    return (int64_t)(exact->view->points[point][axis] / exact->unit);
}

static void set_wide(mpz_t out, wide value) {
    unsigned_wide magnitude = value < 0 ? -(unsigned_wide)value : (unsigned_wide)value;
    mpz_set_ui(out, (uint64_t)(magnitude >> 64));
    mpz_mul_2exp(out, out, 64);
    mpz_add_ui(out, out, (uint64_t)magnitude);
    if (value < 0) mpz_neg(out, out);
}

/// Axis numbers of the third point are handled here: any step along the axis spans the same plane.
static void normal_of(const enf_check_exact *exact, const int32_t points[3], wide normal[3]) {
    int64_t u[3], v[3];
    for (int i = 0; i < 3; i++) {
        u[i] = coordinate(exact, points[1], i) - coordinate(exact, points[0], i);
        v[i] = points[2] >= 0 ? coordinate(exact, points[2], i) - coordinate(exact, points[0], i)
                              : i == -1 - points[2];
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        normal[i] = (wide)u[j] * v[k] - (wide)u[k] * v[j];
    }
}

int enf_check_normal_sign(const enf_check_exact *exact, const int32_t points[3], int axis) {
    wide normal[3];
    normal_of(exact, points, normal);
    return (normal[axis] > 0) - (normal[axis] < 0);
}

static enf_check_fault check_points(enf_check_exact *exact, int32_t *which) {
    const enf_file_view *view = exact->view;
    uint64_t bits = UINT64_C(1) << 53;
    for (int32_t p = 0; p < view->point_count; p++) {
        bool differs = p == 0;
        for (int i = 0; i < 3; i++) {
            double x = view->points[p][i];
            *which = p;
            if (x != floor(x)) return ENF_CHECK_FAULT_POINT;
            bits |= (uint64_t)(int64_t)x;
            differs = differs || x != view->points[p - 1][i];
        }
        if (!differs) return ENF_CHECK_FAULT_POINT;
    }
    exact->unit = (double)(bits & -bits);
    return ENF_CHECK_FAULT_NONE;
}

static bool add_class(enf_check_exact *exact, const enf_check_tuple *tuple, mpz_t number[4]) {
    size_t count = (size_t)exact->class_count + 1;
    if (!enf_array_reserve(exact->classes, exact->class_capacity, count) ||
        !enf_array_reserve(exact->class_near, exact->class_near_capacity, count) ||
        !enf_array_reserve(exact->class_whole, exact->class_whole_capacity, count))
        return false;
    exact->classes[count - 1] = *tuple;
    exact->class_whole[count - 1] = true;
    for (int i = 0; i < 4; i++) {
        exact->class_near[count - 1][i] = mpz_get_d(number[i]);
        if (mpz_sizeinbase(number[i], 2) > 53) exact->class_whole[count - 1] = false;
    }
    exact->class_count++;
    return true;
}

/// number[0..3] = a, b, c, d of the plane through three points, the first of a, b, c that is not zero made
/// positive. Returns 1, or -1 if it was turned over for that, or 0 if the points span no plane.
static int8_t make_plane_numbers(const enf_check_exact *exact, const int32_t points[3], mpz_t *number) {
    wide normal[3];
    normal_of(exact, points, normal);
    int first = normal[0] ? 0 : normal[1] ? 1 : 2;
    if (normal[first] == 0) return 0;
    mpz_set_ui(number[3], 0);
    for (int i = 0; i < 3; i++) {
        set_wide(number[i], normal[first] > 0 ? normal[i] : -normal[i]);
        set_wide(number[4], coordinate(exact, points[0], i));
        mpz_submul(number[3], number[i], number[4]);
    }
    return normal[first] > 0 ? 1 : -1;
}

static enf_check_fault make_plane(enf_check_exact *exact, int32_t plane) {
    mpz_t *number = exact->term;
    exact->plane_sign[plane] = make_plane_numbers(exact, exact->view->planes[plane], number);
    if (exact->plane_sign[plane] == 0) return ENF_CHECK_FAULT_PLANE;
    size_t limbs = exact->limb_count;
    enf_check_tuple tuple;
    if (!store(exact, number, &tuple)) return ENF_CHECK_FAULT_MEMORY;
    int32_t *slot = table_find(exact, &exact->class_table, exact->classes, &tuple);
    if (*slot >= 0) {
        exact->limb_count = limbs;
    } else {
        *slot = exact->class_count;
        if (!add_class(exact, &tuple, number)) return ENF_CHECK_FAULT_MEMORY;
    }
    exact->plane_class[plane] = *slot;
    return ENF_CHECK_FAULT_NONE;
}

int32_t enf_check_class_through(enf_check_exact *exact, const int32_t points[3], int8_t *sign) {
    enf_check_tuple tuple;
    size_t limbs = exact->limb_count;
    *sign = make_plane_numbers(exact, points, exact->term);
    if (*sign == 0) return -1;
    if (!store(exact, exact->term, &tuple)) *sign = 0;
    if (*sign == 0) return -1;
    exact->limb_count = limbs;
    return *table_find(exact, &exact->class_table, exact->classes, &tuple);
}

// ---------------------------------------------------------------------------------------------- vertices

/// out[0..3] = the crossing of three classes as x, y, z, w; w = 0 if they do not cross in one point.
static void cross_planes(enf_check_exact *exact, const int32_t classes[3], mpz_t out[4]) {
    mpz_t view[3][4];
    mpz_srcptr plane[3][4];
    for (int p = 0; p < 3; p++) {
        for (int i = 0; i < 4; i++)
            plane[p][i] = read_number(exact, &exact->classes[classes[p]], i, view[p][i]);
    }
    mpz_ptr minor = exact->term[4];
    for (int i = 0; i < 4; i++) mpz_set_ui(out[i], 0);
    for (int p = 0; p < 3; p++) {
        mpz_srcptr *q = plane[(p + 1) % 3], *r = plane[(p + 2) % 3];
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            mpz_mul(minor, q[j], r[k]);
            mpz_submul(minor, q[k], r[j]);
            mpz_submul(out[i], plane[p][3], minor);
            if (p == 0) mpz_addmul(out[3], plane[0][i], minor);
        }
    }
    if (mpz_sgn(out[3]) < 0) {
        for (int i = 0; i < 4; i++) mpz_neg(out[i], out[i]);
    }
}

/// x / w of two numbers of any size, with a relative error below 2^-50.
static double quotient(mpz_srcptr x, mpz_srcptr w) {
    long above, below;
    double a = mpz_get_d_2exp(&above, x), b = mpz_get_d_2exp(&below, w);
    return a == 0 ? 0 : ldexp(a / b, (int)(above - below));
}

/// Stores number[0..3] = x, y, z, w as a vertex. False without memory.
static bool set_vertex(enf_check_exact *exact, int32_t vertex, mpz_t number[4]) {
    if (!store(exact, number, &exact->vertices[vertex])) return false;
    exact->vertex_whole[vertex] = mpz_cmp_ui(number[3], 1) == 0;
    for (int i = 0; i < 3; i++) {
        exact->near[vertex][i] = quotient(number[i], number[3]);
        if (mpz_sizeinbase(number[i], 2) > 53) exact->vertex_whole[vertex] = false;
    }
    return true;
}

static enf_check_fault make_vertex(enf_check_exact *exact, enf_check_table *table, int32_t vertex) {
    const enf_file_view *view = exact->view;
    mpz_t *number = exact->term;
    const int32_t *planes = view->vertex_planes[vertex];
    bool point = vertex < view->point_count;
    for (int i = 0; i < 3; i++) {
        if (!point && planes[i] < 0) return ENF_CHECK_FAULT_VERTEX;
        exact->vertex_class[vertex][i] = point ? -1 : exact->plane_class[planes[i]];
        if (point) set_wide(number[i], coordinate(exact, vertex, i));
    }
    if (point) {
        mpz_set_ui(number[3], 1);
    } else {
        cross_planes(exact, exact->vertex_class[vertex], number);
    }
    if (mpz_sgn(number[3]) == 0) return ENF_CHECK_FAULT_VERTEX;
    if (!set_vertex(exact, vertex, number)) return ENF_CHECK_FAULT_MEMORY;
    int32_t *slot = table_find(exact, table, exact->vertices, &exact->vertices[vertex]);
    if (*slot < 0) *slot = vertex;
    exact->place[vertex] = *slot;
    return ENF_CHECK_FAULT_NONE;
}

static bool reserve_vertices(enf_check_exact *exact, size_t count) {
    return enf_array_reserve(exact->vertices, exact->vertex_capacity, count) &&
           enf_array_reserve(exact->near, exact->near_capacity, count) &&
           enf_array_reserve(exact->vertex_whole, exact->vertex_whole_capacity, count) &&
           enf_array_reserve(exact->vertex_class, exact->vertex_class_capacity, count);
}

static bool allocate(enf_check_exact *exact) {
    size_t planes = (size_t)exact->view->plane_count, vertices = (size_t)exact->view->vertex_count;
    exact->plane_class = enf_array_new(planes, sizeof *exact->plane_class);
    exact->plane_sign = enf_array_new(planes, sizeof *exact->plane_sign);
    exact->place = enf_array_new(vertices, sizeof *exact->place);
    exact->vertex_count = exact->view->vertex_count;
    return exact->plane_class && exact->plane_sign && exact->place && reserve_vertices(exact, vertices + 1);
}

enf_check_fault enf_check_exact_make(enf_check_exact *exact, const enf_file_view *view, int32_t *which) {
    memset(exact, 0, sizeof *exact);
    exact->view = view;
    for (int i = 0; i < TERMS; i++) mpz_init(exact->term[i]);
    if (!allocate(exact)) return ENF_CHECK_FAULT_MEMORY;
    enf_check_fault fault = check_points(exact, which);
    enf_check_table table = {0};
    if (fault == ENF_CHECK_FAULT_NONE && !table_make(&exact->class_table, (size_t)view->plane_count))
        fault = ENF_CHECK_FAULT_MEMORY;
    for (int32_t p = 0; fault == ENF_CHECK_FAULT_NONE && p < view->plane_count; p++) {
        *which = p;
        fault = make_plane(exact, p);
    }
    if (fault == ENF_CHECK_FAULT_NONE && !table_make(&table, (size_t)view->vertex_count))
        fault = ENF_CHECK_FAULT_MEMORY;
    for (int32_t v = 0; fault == ENF_CHECK_FAULT_NONE && v < view->vertex_count; v++) {
        *which = v;
        fault = make_vertex(exact, &table, v);
    }
    free(table.slots);
    exact->world_limbs = exact->limb_count;
    return fault;
}

int32_t enf_check_cross_edge(enf_check_exact *exact, int32_t from, int32_t to, int32_t plane_class) {
    if (exact->vertex_count == INT32_MAX || !reserve_vertices(exact, (size_t)exact->vertex_count + 1))
        return -1;
    mpz_t view, *number = exact->term; // number[5], [6]: how far the ends are from the plane, times their w
    for (int end = 0; end < 2; end++) {
        mpz_t other;
        mpz_set_ui(number[5 + end], 0);
        for (int i = 0; i < 4; i++) {
            mpz_addmul(number[5 + end], read_number(exact, &exact->classes[plane_class], i, view),
                       read_number(exact, &exact->vertices[end ? to : from], i, other));
        }
        mpz_abs(number[5 + end], number[5 + end]);
    }
    for (int i = 0; i < 4; i++) {
        mpz_mul(number[i], read_number(exact, &exact->vertices[from], i, view), number[6]);
        mpz_addmul(number[i], read_number(exact, &exact->vertices[to], i, view), number[5]);
    }
    int32_t vertex = exact->vertex_count;
    if (!set_vertex(exact, vertex, number)) return -1;
    exact->vertex_class[vertex][0] = plane_class;
    exact->vertex_class[vertex][1] = exact->vertex_class[vertex][2] = -1;
    return exact->vertex_count++;
}

void enf_check_drop_crossings(enf_check_exact *exact) {
    exact->vertex_count = exact->view->vertex_count;
    exact->limb_count = exact->world_limbs;
}

void enf_check_exact_free(enf_check_exact *exact) {
    if (!exact->view) return;
    for (int i = 0; i < TERMS; i++) mpz_clear(exact->term[i]);
    free(exact->plane_class);
    free(exact->plane_sign);
    free(exact->classes);
    free(exact->class_near);
    free(exact->class_whole);
    free(exact->place);
    free(exact->vertices);
    free(exact->near);
    free(exact->vertex_whole);
    free(exact->vertex_class);
    free(exact->limbs);
    free(exact->class_table.slots);
    memset(exact, 0, sizeof *exact);
}

// ---------------------------------------------------------------------------------------------- signs

int enf_check_side_of_class(enf_check_exact *exact, int32_t vertex, int32_t plane_class) {
    const double *n = exact->class_near[plane_class], *x = exact->near[vertex];
    double a = n[0] * x[0], b = n[1] * x[1], c = n[2] * x[2];
    double sum = a + b + c + n[3], magnitude = fabs(a) + fabs(b) + fabs(c) + fabs(n[3]);
    if (fabs(sum) > near_zero * magnitude) return sum > 0 ? 1 : -1;
    const int32_t *own = exact->vertex_class[vertex];
    if (own[0] == plane_class || own[1] == plane_class || own[2] == plane_class) return 0;
    // Whole numbers, and small: nothing was rounded.
    if (exact->class_whole[plane_class] && exact->vertex_whole[vertex] && magnitude < 0x1p53)
        return (sum > 0) - (sum < 0);
    mpz_t one, two;
    mpz_ptr total = exact->term[0];
    mpz_set_ui(total, 0);
    for (int i = 0; i < 4; i++) {
        mpz_addmul(total, read_number(exact, &exact->classes[plane_class], i, one),
                   read_number(exact, &exact->vertices[vertex], i, two));
    }
    return mpz_sgn(total);
}

int enf_check_side(enf_check_exact *exact, int32_t vertex, int32_t plane) {
    return exact->plane_sign[plane] * enf_check_side_of_class(exact, vertex, exact->plane_class[plane]);
}

static double larger(double a, double b) {
    return a > b ? a : b;
}

static int turn_exactly(enf_check_exact *exact, int u, int v, const int32_t corner[3]) {
    mpz_t view[3][3];
    mpz_srcptr x[3], y[3], w[3];
    for (int i = 0; i < 3; i++) {
        const enf_check_tuple *at = &exact->vertices[corner[i]];
        x[i] = read_number(exact, at, u, view[i][0]);
        y[i] = read_number(exact, at, v, view[i][1]);
        w[i] = read_number(exact, at, 3, view[i][2]);
    }
    mpz_ptr total = exact->term[0], minor = exact->term[1];
    mpz_set_ui(total, 0);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        mpz_mul(minor, x[j], y[k]);
        mpz_submul(minor, x[k], y[j]);
        mpz_addmul(total, w[i], minor);
    }
    return mpz_sgn(total);
}

int enf_check_turn(enf_check_exact *exact, int axis, int32_t a, int32_t b, int32_t c) {
    const int32_t *place = exact->place;
    if (place[a] == place[b] || place[b] == place[c] || place[a] == place[c]) return 0;
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double *p = exact->near[a], *q = exact->near[b], *r = exact->near[c];
    double qu = q[u] - p[u], qv = q[v] - p[v], ru = r[u] - p[u], rv = r[v] - p[v];
    double one = qu * rv, two = qv * ru, value = one - two;
    double size = larger(larger(larger(fabs(p[u]), fabs(p[v])), larger(fabs(q[u]), fabs(q[v]))),
                         larger(fabs(r[u]), fabs(r[v])));
    double slip = 0x1p-48 * size; // of each difference
    double error =
        2 * slip * (fabs(qu) + fabs(qv) + fabs(ru) + fabs(rv) + slip) + 0x1p-50 * (fabs(one) + fabs(two));
    if (fabs(value) > error) return value > 0 ? 1 : -1;
    if (exact->vertex_whole[a] && exact->vertex_whole[b] && exact->vertex_whole[c] && size < 0x1p25)
        return (value > 0) - (value < 0);
    return turn_exactly(exact, u, v, (const int32_t[3]){a, b, c});
}

int enf_check_orient(enf_check_exact *exact, int32_t a, int32_t b, int32_t c, int32_t d) {
    wide normal[3];
    normal_of(exact, (const int32_t[3]){a, b, c}, normal);
    double sum = 0, magnitude = 0;
    int64_t span[3];
    for (int i = 0; i < 3; i++) {
        span[i] = coordinate(exact, d, i) - coordinate(exact, a, i);
        double term = (double)normal[i] * (double)span[i];
        sum += term;
        magnitude += fabs(term);
    }
    if (fabs(sum) > near_zero * magnitude) return sum > 0 ? 1 : -1;
    mpz_ptr total = exact->term[0], one = exact->term[1], two = exact->term[2];
    mpz_set_ui(total, 0);
    for (int i = 0; i < 3; i++) {
        set_wide(one, normal[i]);
        set_wide(two, span[i]);
        mpz_addmul(total, one, two);
    }
    return mpz_sgn(total);
}

int enf_check_axis(const enf_check_exact *exact, int32_t plane, int *sign) {
    const double *n = exact->class_near[exact->plane_class[plane]];
    int axis = fabs(n[0]) >= fabs(n[1]) ? 0 : 1;
    if (fabs(n[2]) > fabs(n[axis])) axis = 2;
    *sign = n[axis] > 0 ? exact->plane_sign[plane] : -exact->plane_sign[plane];
    return axis;
}

// ---------------------------------------------------------------------------------------------- rounded
// places

bool enf_check_position_near(enf_check_exact *exact, int32_t vertex, const double position[3]) {
    for (int i = 0; i < 3; i++) {
        double x = exact->near[vertex][i] * exact->unit, bound = 0.5 + 0x1p-50 * fabs(x);
        if (fabs(x - position[i]) < bound - 0x1p-49 * fabs(x)) continue;
        mpz_t above, below;
        mpq_t at, got;
        mpq_inits(at, got, NULL);
        mpq_set_num(at, read_number(exact, &exact->vertices[vertex], i, above));
        mpq_set_den(at, read_number(exact, &exact->vertices[vertex], 3, below));
        mpq_canonicalize(at);
        mpq_set_d(got, position[i] / exact->unit);
        mpq_sub(at, at, got);
        mpq_abs(at, at);
        mpq_set_d(got, bound / exact->unit);
        bool good = mpq_cmp(at, got) <= 0;
        mpq_clears(at, got, NULL);
        if (!good) return false;
    }
    return true;
}

int enf_check_side_of_place(enf_check_exact *exact, const double grid[3], int32_t plane) {
    const enf_check_tuple *tuple = &exact->classes[exact->plane_class[plane]];
    mpz_t view;
    mpq_t total, at, factor;
    mpq_inits(total, at, factor, NULL);
    mpq_set_z(total, read_number(exact, tuple, 3, view));
    for (int i = 0; i < 3; i++) {
        mpq_set_d(at, grid[i] / exact->unit);
        mpq_set_z(factor, read_number(exact, tuple, i, view));
        mpq_mul(at, at, factor);
        mpq_add(total, total, at);
    }
    int sign = mpq_sgn(total);
    mpq_clears(total, at, factor, NULL);
    return sign * exact->plane_sign[plane];
}
