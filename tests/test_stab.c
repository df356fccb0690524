// SPDX-License-Identifier: GPL-3.0-or-later
// Stabbing against the oracle: random portal sequences, many of them degenerate, and known ones.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "oracle_stab.h"
#include "visibility/stab_parts.h"

enum { LENGTH = 40, CORNERS = 8, EDGES = LENGTH * CORNERS, KINDS = 13 };

static const uint64_t seed = 4711;

static uint64_t next_random(uint64_t *state) {
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

static int between(uint64_t *state, int low, int high) {
    return low + (int)(next_random(state) % (uint64_t)(high - low + 1));
}

/// Between -1 and 1.
static double real(uint64_t *state) {
    return (double)(int64_t)next_random(state) * 0x1p-63;
}

/// How many cases: `usual`, times the environment variable ENFILADE_TEST_SCALE.
static long scaled(long usual) {
    const char *text = getenv("ENFILADE_TEST_SCALE");
    double scale = text ? atof(text) : 1;
    return scale > 0 ? (long)ceil((double)usual * scale) : usual;
}

// ---- Sequences ----

typedef struct passage {
    enf_portal_graph graph;
    enf_pluecker pluecker;
    enf_stabber *stabber;
    int32_t sequence[LENGTH];
    int count;
    oracle_edge edges[EDGES];
    int edge_count;
    bool blocked;     ///< a winding has no edges
    double factor;    ///< if not 0, coordinates are multiplied by it, rounded,
    uint64_t *jitter; ///< and now and then moved to the next double
} passage;

static bool same_point(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static void add_portal(passage *p, const double (*given)[3], int count, bool turned) {
    double corners[CORNERS][3];
    for (int i = 0; i < 3 * count; i++) {
        double x = given[i / 3][i % 3];
        if (p->factor != 0) x *= p->factor;
        if (p->jitter && !between(p->jitter, 0, 9)) x = nextafter(x, between(p->jitter, 0, 1) ? 1e9 : -1e9);
        corners[i / 3][i % 3] = x;
    }
    assert_true(enf_portal_graph_add(&p->graph, 0, 1, (const double(*)[3])corners, count));
    p->sequence[p->count] = 2 * p->count + turned;
    p->count++;
    const int edges = p->edge_count;
    for (int i = 0, before = count - 1; i < count; before = i++) {
        if (same_point(corners[before], corners[i])) continue;
        oracle_edge *edge = &p->edges[p->edge_count++];
        memcpy(edge->a, corners[turned ? i : before], sizeof edge->a);
        memcpy(edge->b, corners[turned ? before : i], sizeof edge->b);
    }
    p->blocked |= p->edge_count == edges;
}

static void finish(passage *p) {
    p->graph.cell_count = 2;
    assert_int_equal(enf_portal_graph_finish(&p->graph, NULL), ENF_OK);
    assert_true(enf_pluecker_make(&p->pluecker, &p->graph));
    p->stabber = enf_stabber_new(&p->pluecker);
    assert_non_null(p->stabber);
}

static void destroy(passage *p) {
    enf_stabber_free(p->stabber);
    enf_pluecker_free(&p->pluecker);
    enf_portal_graph_free(&p->graph);
    free(p);
}

/// A polygon about `middle`, along the z axis if not tilted, turned round its normal; counter-clockwise from
/// +z.
static void add_polygon(passage *p, const double middle[3], double wide, double high, double turn,
                        double tilt_x, double tilt_y, int corners, double grid) {
    double corner[CORNERS][3];
    for (int i = 0; i < corners; i++) {
        const double angle = 2 * 3.141592653589793 * (i + 0.5) / corners;
        const double u = wide * cos(angle), v = high * sin(angle);
        const double x = u * cos(turn) - v * sin(turn), y = u * sin(turn) + v * cos(turn);
        const double at[3] = {middle[0] + x, middle[1] + y, middle[2] + tilt_x * x + tilt_y * y};
        for (int k = 0; k < 3; k++) corner[i][k] = grid > 0 ? rint(at[k] / grid) * grid : at[k];
    }
    add_portal(p, (const double(*)[3])corner, corners, false);
}

/// Doors along a corridor that moves aside from time to time.
static void tunnel(passage *p, int length, double aside, double size, double grid, uint64_t *state) {
    double middle[3] = {0, 0, 0}, step[2] = {real(state) * aside, real(state) * aside};
    for (int i = 0; i < length; i++) {
        add_polygon(p, middle, size * (1.2 + real(state)), size * (1.2 + real(state)), 3 * real(state),
                    real(state) / 3, real(state) / 3, between(state, 3, 6), grid);
        for (int k = 0; k < 2; k++) middle[k] += step[k] + real(state) * aside / 2;
        middle[2] += 100 + 90 * real(state);
    }
}

/// Teller's: long slits one behind the other, each turned. Six are more than the relaxation allows, five more
/// than lines do.
static void slits(passage *p, int length, double grid, uint64_t *state) {
    const double thin = ldexp(40, -between(state, 0, 6));
    for (int i = 0; i < length; i++) {
        const double middle[3] = {20 * real(state), 20 * real(state), 100 * i};
        add_polygon(p, middle, 400, thin * (1.1 + real(state)), 4 * real(state), real(state) / 4,
                    real(state) / 4, 4, grid);
    }
}

/// Slits along lines of one ruling of a hyperboloid, in whole numbers. All lines of the other ruling meet
/// them; one is (64, -s, s). Each slit is moved sideways by up to `off` times its width: 1 touches that line.
static void hyperboloid(passage *p, int length, double off, bool whole, uint64_t *state) {
    for (int i = 0; i < length; i++) {
        const int q = between(state, -12, 12), wide = between(state, 1, 3);
        const double along[3] = {-8 * q, 16 - q * q, 16 + q * q}, across[3] = {-4, -q, -q};
        const double aside = off * real(state) * wide, moved = whole ? rint(aside) : aside;
        double corner[4][3];
        for (int k = 0; k < 4; k++) {
            const double u = k == 1 || k == 2 ? 2 : -2, v = (k >= 2 ? -wide : wide) + moved;
            corner[k][0] = 64 + u * along[0] + v * across[0];
            corner[k][1] = 16 * q + u * along[1] + v * across[1];
            corner[k][2] = -16 * q + u * along[2] + v * across[2];
        }
        add_portal(p, (const double(*)[3])corner, 4, false);
    }
}

/// Rectangles of whole numbers across the axes.
static void rectangles(passage *p, int length, int range, uint64_t *state) {
    const int usual = between(state, 0, 2);
    int way = 0;
    for (int i = 0; i < length; i++) {
        const int axis = between(state, 0, 4) ? usual : between(state, 0, 2);
        const int a = (axis + 1) % 3, b = (axis + 2) % 3;
        const int low_a = between(state, -range, range - 1), low_b = between(state, -range, range - 1);
        const int high_a = between(state, low_a + 1, range), high_b = between(state, low_b + 1, range);
        double corner[4][3];
        for (int k = 0; k < 4; k++) {
            corner[k][axis] = axis == usual ? way : between(state, 0, range);
            corner[k][a] = k == 1 || k == 2 ? high_a : low_a;
            corner[k][b] = k >= 2 ? high_b : low_b;
        }
        for (int k = 1; k < 4; k++) corner[k][axis] = corner[0][axis];
        way += between(state, 0, 3);
        add_portal(p, (const double(*)[3])corner, 4, axis == usual ? false : between(state, 0, 1));
    }
}

/// Triangles of a small lattice, the same way along z or any way; some of them repeated.
static void triangles(passage *p, int length, int range, uint64_t *state) {
    double corner[3][3];
    for (int i = 0; i < length; i++) {
        for (int k = 0; k < 9 && (i == 0 || between(state, 0, 7)); k++)
            corner[k / 3][k % 3] = between(state, -range, range);
        const double turn = (corner[1][0] - corner[0][0]) * (corner[2][1] - corner[0][1]) -
                            (corner[1][1] - corner[0][1]) * (corner[2][0] - corner[0][0]);
        add_portal(p, (const double(*)[3])corner, 3, between(state, 0, 9) ? turn < 0 : between(state, 0, 1));
    }
}

static int random_length(uint64_t *state) {
    int length = between(state, 2, 8);
    if (!between(state, 0, 3)) length = between(state, 2, LENGTH);
    return length;
}

static passage *random_passage(int kind, uint64_t *state) {
    passage *p = calloc(1, sizeof *p);
    assert_non_null(p);
    const int length = random_length(state), few = between(state, 2, 6);
    if (kind >= 10) { // nearly degenerate: the same to the last bits
        p->factor = between(state, 1, 99) / 10.0;
        p->jitter = state;
    }
    switch (kind) {
    case 0:
        tunnel(p, length, 20, 40, 0, state);
        break;
    case 1:
        tunnel(p, length, 60, 60, 1, state);
        break;
    case 2:
        tunnel(p, length, 5, 40, 8, state);
        break;
    case 3:
        slits(p, few, 0, state);
        break;
    case 4:
        slits(p, few, 1, state);
        break;
    case 5:
        hyperboloid(p, few + 2, 1.2, false, state);
        break;
    case 6:
        hyperboloid(p, few + 1, 1.3, true, state);
        break;
    case 7:
        rectangles(p, length, between(state, 2, 6), state);
        break;
    case 8:
        triangles(p, few, between(state, 1, 4), state);
        break;
    case 9:
        rectangles(p, few, between(state, 2, 3), state);
        break;
    case 10:
        rectangles(p, length, between(state, 2, 6), state);
        break;
    case 11:
        triangles(p, few, between(state, 1, 4), state);
        break;
    default:
        rectangles(p, few, between(state, 2, 3), state);
        break;
    }
    finish(p);
    return p;
}

typedef struct tally {
    long hidden, relaxed_only, with_line, long_line;
    enf_stab_counts counts;
} tally;

static void check_passage(passage *p, tally *sum) {
    enf_stab relaxed, exact;
    const bool program = !p->blocked && oracle_stab_program(p->edges, p->edge_count);
    assert_int_equal(enf_stab_lp(p->stabber, p->sequence, p->count, NULL, &relaxed, NULL), ENF_OK);
    assert_int_equal(enf_stab_exact(p->stabber, p->sequence, p->count, NULL, &exact, NULL), ENF_OK);
    assert_int_equal(relaxed.answer != ENF_STAB_HIDDEN, program);
    if (relaxed.answer == ENF_STAB_VISIBLE) {
        assert_true(relaxed.has_line);
        assert_true(oracle_stab_passes(p->edges, p->edge_count, relaxed.line.from, relaxed.line.to));
    }
    assert_int_not_equal(exact.answer, ENF_STAB_OPEN);
    if (exact.answer == ENF_STAB_VISIBLE) {
        assert_true(exact.has_line != (exact.long_line != NULL));
        assert_true(exact.has_line
                        ? oracle_stab_passes(p->edges, p->edge_count, exact.line.from, exact.line.to)
                        : oracle_stab_passes_text(p->edges, p->edge_count, exact.long_line));
    } else {
        assert_false(program && oracle_stab_line(p->edges, p->edge_count));
    }
    sum->hidden += !program;
    sum->relaxed_only += program && exact.answer == ENF_STAB_HIDDEN;
    sum->with_line += exact.has_line;
    sum->long_line += exact.long_line != NULL;
    const enf_stab_counts *counts = enf_stabber_counts(p->stabber);
    sum->counts.lines_fine += counts->lines_fine;
    sum->counts.zero_by_double += counts->zero_by_double;
    sum->counts.zero_by_whole += counts->zero_by_whole;
    sum->counts.programs += counts->programs;
    sum->counts.quadrics += counts->quadrics;
    sum->counts.undecided += counts->undecided;
}

static void answers_are_the_oracles(void **unused) {
    (void)unused;
    uint64_t state = seed;
    const long cases = scaled(5000);
    tally sum[KINDS] = {{0}};
    for (long i = 0; i < cases; i++) {
        passage *p = random_passage((int)(i % KINDS), &state);
        check_passage(p, &sum[i % KINDS]);
        destroy(p);
    }
    print_message("seed %llu, %ld sequences\n", (unsigned long long)seed, cases);
    for (int k = 0; k < KINDS; k++) {
        const tally *t = &sum[k];
        print_message(
            "kind %d: hidden %ld, by the quadric only %ld, line %ld, from a long one %lld, long %ld; "
            "zero by double %lld, by whole %lld, programs %lld, quadrics %lld\n",
            k, t->hidden, t->relaxed_only, t->with_line, (long long)t->counts.lines_fine, t->long_line,
            (long long)t->counts.zero_by_double, (long long)t->counts.zero_by_whole,
            (long long)t->counts.programs, (long long)t->counts.quadrics);
        assert_int_equal(t->counts.undecided, 0);
    }
}

// ---- What must not change an answer ----

static enf_stab_answer answer_of(passage *p, const int32_t *sequence, const enf_line *hint, bool exact) {
    enf_stab stab;
    if (exact)
        assert_int_equal(enf_stab_exact(p->stabber, sequence, p->count, hint, &stab, NULL), ENF_OK);
    else
        assert_int_equal(enf_stab_lp(p->stabber, sequence, p->count, hint, &stab, NULL), ENF_OK);
    for (int i = 0; stab.has_line && i < p->count; i++)
        assert_true(enf_line_passes(&stab.line, &p->graph, sequence[i]));
    if (exact) assert_int_equal(stab.answer == ENF_STAB_VISIBLE, stab.has_line || stab.long_line);
    return stab.answer;
}

static bool same_answer(enf_stab_answer a, enf_stab_answer b) {
    return (a == ENF_STAB_HIDDEN) == (b == ENF_STAB_HIDDEN);
}

/// The other way round through the twins; in another order; with any hint.
static void neither_order_nor_hint_matters(void **unused) {
    (void)unused;
    uint64_t state = seed + 1;
    const long cases = scaled(2000);
    for (long i = 0; i < cases; i++) {
        passage *p = random_passage((int)(i % KINDS), &state);
        const enf_stab_answer relaxed = answer_of(p, p->sequence, NULL, false),
                              exact = answer_of(p, p->sequence, NULL, true);
        int32_t back[LENGTH], mixed[LENGTH] = {0};
        for (int k = 0; k < p->count; k++) {
            back[k] = p->sequence[p->count - 1 - k] ^ 1;
            const int at = between(&state, 0, k);
            mixed[k] = mixed[at];
            mixed[at] = p->sequence[k];
        }
        enf_line hint;
        for (int k = 0; k < 3; k++) {
            hint.from[k] = 300 * real(&state);
            hint.to[k] = between(&state, 0, 9) ? 300 * real(&state) : hint.from[k];
        }
        assert_true(same_answer(relaxed, answer_of(p, back, NULL, false)));
        assert_true(same_answer(relaxed, answer_of(p, mixed, &hint, false)));
        assert_true(same_answer(exact, answer_of(p, back, &hint, true)));
        assert_true(same_answer(exact, answer_of(p, mixed, NULL, true)));
        destroy(p);
    }
}

/// All coordinates times powers of two, which may leave the range in which doubles are trusted.
static void scale_does_not_matter(void **unused) {
    (void)unused;
    uint64_t state = seed + 2;
    const long cases = scaled(1000);
    for (long i = 0; i < cases; i++) {
        passage *p = random_passage((int)(i % KINDS), &state);
        const enf_stab_answer relaxed = answer_of(p, p->sequence, NULL, false),
                              exact = answer_of(p, p->sequence, NULL, true);
        const int shift =
            between(&state, p->jitter ? 0 : -900, 1000); // down, the least doubles would be lost
        for (int32_t k = 0; k < p->graph.opening_corner[p->count]; k++) {
            for (int j = 0; j < 3; j++) p->graph.corners[k][j] = ldexp(p->graph.corners[k][j], shift);
        }
        enf_pluecker_free(&p->pluecker);
        assert_true(enf_pluecker_make(&p->pluecker, &p->graph));
        assert_true(same_answer(relaxed, answer_of(p, p->sequence, NULL, false)));
        assert_true(same_answer(exact, answer_of(p, p->sequence, NULL, true)));
        destroy(p);
    }
}

static double any_finite(uint64_t *state) {
    const uint64_t bits = next_random(state);
    double value;
    memcpy(&value, &bits, sizeof value);
    return isfinite(value) ? value : 0;
}

/// Windings of nonsense, with huge and tiny numbers side by side.
static void any_finite_doubles_are_answered(void **unused) {
    (void)unused;
    uint64_t state = seed + 3;
    const long cases = scaled(300);
    for (long i = 0; i < cases; i++) {
        passage *p = calloc(1, sizeof *p);
        assert_non_null(p);
        const int length = between(&state, 1, 4), mostly = between(&state, 0, 1);
        for (int k = 0; k < length; k++) {
            double corner[4][3];
            const int corners = between(&state, 3, 4);
            for (int c = 0; c < 3 * corners; c++)
                corner[c / 3][c % 3] =
                    between(&state, 0, 3 * mostly) ? between(&state, -2, 2) : any_finite(&state);
            add_portal(p, (const double(*)[3])corner, corners, between(&state, 0, 1));
        }
        finish(p);
        enf_line hint;
        for (int k = 0; k < 3; k++) {
            hint.from[k] = any_finite(&state);
            hint.to[k] = any_finite(&state);
        }
        const enf_stab_answer relaxed = answer_of(p, p->sequence, &hint, false);
        assert_int_equal(relaxed != ENF_STAB_HIDDEN,
                         !p->blocked && oracle_stab_program(p->edges, p->edge_count));
        if (relaxed == ENF_STAB_HIDDEN)
            assert_int_equal(answer_of(p, p->sequence, NULL, true), ENF_STAB_HIDDEN);
        destroy(p);
    }
}

// ---- The exact tiers by themselves ----

/// Some of the edges of degenerate passages: whoever says that they hold 0 must be right, and one of them
/// must say so if only one combination gives 0.
static void certificates_hold(void **unused) {
    (void)unused;
    uint64_t state = seed + 5;
    const long cases = scaled(5000);
    long small = 0, whole = 0;
    for (long i = 0; i < cases; i++) {
        passage *p = random_passage(7 + (int)(i % 3), &state);
        oracle_edge chosen[ENF_HULL_MAX];
        int32_t members[ENF_HULL_MAX];
        int count = 0;
        if (p->blocked) { // the oracle's edges are not numbered like the stabber's
            destroy(p);
            continue;
        }
        assert_true(enf_stabber_take(p->stabber, p->sequence, p->count));
        for (int wanted = between(&state, 2, 5); count < wanted; count++)
            members[count] = between(&state, 0, p->edge_count - 1);
        for (int n = 0; n < count; n++) chosen[n] = p->edges[members[n]];
        const bool holds = !oracle_stab_program(chosen, count);
        const bool by_small = enf_stabber_zero_by_small(p->stabber, members, count),
                   by_whole = enf_stabber_zero_by_whole(p->stabber, members, count);
        assert_int_equal(by_small, by_whole); // the numbers are small
        assert_true(holds || !by_whole);
        small += by_small;
        whole += holds;
        destroy(p);
    }
    assert_true(small > cases / 200 && whole > small);
}

/// Sides of small whole numbers, lines or not; a few point much the same way, so that the form is more often
/// not below 0.
static int random_sides(double (*sides)[6], uint64_t *state) {
    const int count = between(state, 6, 10), range = between(state, 1, 9),
              sign = between(state, 0, 1) ? 1 : -1;
    const double spread = between(state, 1, 4);
    for (int k = 0; k < count; k++) {
        for (int i = 0; i < 6; i++) sides[k][i] = between(state, -range, range);
        for (int i = 0; i < 3; i++) {
            if (between(state, 0, 1)) sides[k][3 + i] = sign * spread * sides[k][i] + between(state, -1, 1);
        }
    }
    return count;
}

static void cones_are_the_oracles(void **unused) {
    (void)unused;
    uint64_t state = seed + 6;
    const long cases = scaled(600);
    long falling = 0, pointed = 0, by_faces = 0;
    enf_quadric q;
    enf_quadric_init(&q);
    for (long i = 0; i < cases; i++) {
        double sides[10][6];
        bool falls;
        const int count = random_sides(sides, &state),
                  rays = oracle_stab_cone((const double(*)[6])sides, 6, 1, &falls);
        if (rays == 0) continue; // the first six are not independent
        mpz_t number[10][6], *first[6];
        for (int k = 0; k < count; k++) {
            for (int j = 0; j < 6; j++) mpz_init_set_d(number[k][j], sides[k][j]);
            if (k < 6) first[k] = number[k];
        }
        assert_true(enf_cone_start(&q.cone, first));
        for (int k = 6; k < count; k++) assert_true(enf_cone_cut(&q.cone, number[k]));
        for (q.sign = -1; q.sign <= 1; q.sign += 2) {
            assert_int_equal(q.cone.ray_count,
                             oracle_stab_cone((const double(*)[6])sides, count, q.sign, &falls));
            assert_int_equal(enf_quadric_falls(&q), falls);
            falling += falls;
            by_faces += falls && q.steps == 3;
            pointed++;
        }
        for (int k = 0; k < 6 * count; k++) mpz_clear(number[k / 6][k % 6]);
    }
    enf_quadric_free(&q);
    print_message("seed %llu, %ld cones: below 0 in %ld, inside larger faces only in %ld\n",
                  (unsigned long long)(seed + 6), pointed, falling, by_faces);
    assert_true(by_faces > 0 && falling < pointed);
}

// ---- Lines ----

/// Small whole numbers, so that many lines touch, and their neighbours; every third time numbers of all sizes
/// among them.
static double line_number(bool wild, uint64_t *state) {
    if (wild && !between(state, 0, 3)) return ldexp(real(state), between(state, -1070, 1000));
    const double x = between(state, -3, 3);
    return between(state, 0, 7) ? x : nextafter(x, HUGE_VAL);
}

static void lines_pass_as_the_oracle_says(void **unused) {
    (void)unused;
    uint64_t state = seed + 4;
    const long cases = scaled(20000);
    long passing = 0;
    for (long i = 0; i < cases; i++) {
        passage *p = calloc(1, sizeof *p);
        assert_non_null(p);
        double number[5][3];
        for (int k = 0; k < 15; k++) number[k / 3][k % 3] = line_number(i % 3 == 0, &state);
        enf_line line;
        memcpy(line.from, number[3], sizeof line.from);
        memcpy(line.to, number[4], sizeof line.to);
        add_portal(p, (const double(*)[3])number, 3, between(&state, 0, 1));
        const bool passes = !p->blocked && oracle_stab_passes(p->edges, p->edge_count, line.from, line.to);
        const int quickly = enf_line_passes_quickly(&line, &p->graph, p->sequence[0]);
        assert_int_equal(enf_line_passes(&line, &p->graph, p->sequence[0]), passes);
        assert_true(quickly == 0 || (quickly > 0) == passes);
        passing += passes;
        destroy(p);
    }
    assert_true(passing > cases / 100);
}

// ---- Known ----

static passage *passage_of(int count, const double (*corners)[4][3]) {
    passage *p = calloc(1, sizeof *p);
    assert_non_null(p);
    for (int i = 0; i < count; i++) add_portal(p, corners[i], 4, false);
    finish(p);
    return p;
}

static void expect(passage *p, enf_stab_answer relaxed, enf_stab_answer exact) {
    assert_int_equal(answer_of(p, p->sequence, NULL, false) == ENF_STAB_HIDDEN, relaxed == ENF_STAB_HIDDEN);
    assert_int_equal(answer_of(p, p->sequence, NULL, true), exact);
    destroy(p);
}

#define DOOR(low_x, low_y, high_x, high_y, z)                         \
    {                                                                 \
        {low_x, low_y, z}, {high_x, low_y, z}, {high_x, high_y, z}, { \
            low_x, high_y, z                                          \
        }                                                             \
    }

static void one_portal_is_always_passed(void **unused) {
    (void)unused;
    expect(passage_of(1, (const double[1][4][3]){DOOR(0, 0, 1, 1, 0)}), ENF_STAB_OPEN, ENF_STAB_VISIBLE);
    expect(passage_of(1, (const double[1][4][3]){DOOR(0, 0, 0x1p-40, 0x1p40, 7)}), ENF_STAB_OPEN,
           ENF_STAB_VISIBLE);
}

static void a_portal_and_its_twin_are_not_passed_together(void **unused) {
    (void)unused;
    passage *p = passage_of(2, (const double[2][4][3]){DOOR(0, 0, 1, 1, 0), DOOR(0, 0, 1, 1, 1)});
    p->sequence[1] = 1;
    expect(p, ENF_STAB_HIDDEN, ENF_STAB_HIDDEN);
}

/// In one plane, two doors with a common edge; one in the other; and two with nothing in common.
static void doors_in_one_plane_need_common_area(void **unused) {
    (void)unused;
    expect(passage_of(2, (const double[2][4][3]){DOOR(0, 0, 1, 1, 0), DOOR(1, 0, 2, 1, 0)}), ENF_STAB_HIDDEN,
           ENF_STAB_HIDDEN);
    expect(passage_of(2, (const double[2][4][3]){DOOR(0, 0, 3, 3, 0), DOOR(1, 1, 2, 2, 0)}), ENF_STAB_OPEN,
           ENF_STAB_VISIBLE);
    expect(passage_of(2, (const double[2][4][3]){DOOR(0, 0, 1, 1, 0), DOOR(5, 0, 6, 1, 0)}), ENF_STAB_HIDDEN,
           ENF_STAB_HIDDEN);
}

/// Three doors whose only common lines lie in the plane x = 1: they would have to touch two edges.
static void touching_is_not_passing(void **unused) {
    (void)unused;
    expect(
        passage_of(3, (const double[3][4][3]){DOOR(0, 0, 1, 1, 0), DOOR(1, 0, 2, 1, 1), DOOR(0, 0, 1, 1, 2)}),
        ENF_STAB_HIDDEN, ENF_STAB_HIDDEN);
    const double more = 1 + 0x1p-52;
    expect(passage_of(3, (const double[3][4][3]){DOOR(0, 0, more, 1, 0), DOOR(1, 0, 2, 1, 1),
                                                 DOOR(0, 0, more, 1, 2)}),
           ENF_STAB_OPEN, ENF_STAB_VISIBLE);
}

/// Three doors that leave a slit between two neighbouring doubles: few lines between doubles pass, if any.
static void the_thinnest_slits_have_lines(void **unused) {
    (void)unused;
    const double more = nextafter(1001, 1e9);
    for (double at = 0; at < 1000; at += 0.7) {
        passage *p = passage_of(3, (const double[3][4][3]){DOOR(1000, at, more, at + 1, 1000),
                                                           DOOR(1001, at, 1002, at + 2, 1001),
                                                           DOOR(1000, at, more, at + 3, 1005 + at / 7)});
        enf_stab stab;
        assert_int_equal(enf_stab_exact(p->stabber, p->sequence, 3, NULL, &stab, NULL), ENF_OK);
        assert_int_equal(stab.answer, ENF_STAB_VISIBLE);
        assert_true(stab.has_line
                        ? oracle_stab_passes(p->edges, p->edge_count, stab.line.from, stab.line.to)
                        : stab.long_line && oracle_stab_passes_text(p->edges, p->edge_count, stab.long_line));
        assert_false(oracle_stab_passes_text(p->edges, p->edge_count, "1001 0 0 1001 1 1005"));
        destroy(p);
    }
}

static void equal_corners_are_no_edge(void **unused) {
    (void)unused;
    const double twice[2][4][3] = {{{0, 0, 0}, {1, 0, 0}, {1, 0, -0.0}, {0, 1, 0}}, DOOR(0, 0, 1, 1, 1)};
    expect(passage_of(2, twice), ENF_STAB_OPEN, ENF_STAB_VISIBLE);
    const double nothing[1][4][3] = {DOOR(1, 1, 1, 1, 1)}, flat[1][4][3] = {DOOR(0, 1, 1, 1, 1)};
    expect(passage_of(1, nothing), ENF_STAB_HIDDEN, ENF_STAB_HIDDEN);
    expect(passage_of(1, flat), ENF_STAB_HIDDEN, ENF_STAB_HIDDEN);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_portal_is_always_passed),
        cmocka_unit_test(a_portal_and_its_twin_are_not_passed_together),
        cmocka_unit_test(doors_in_one_plane_need_common_area),
        cmocka_unit_test(touching_is_not_passing),
        cmocka_unit_test(the_thinnest_slits_have_lines),
        cmocka_unit_test(equal_corners_are_no_edge),
        cmocka_unit_test(lines_pass_as_the_oracle_says),
        cmocka_unit_test(certificates_hold),
        cmocka_unit_test(cones_are_the_oracles),
        cmocka_unit_test(answers_are_the_oracles),
        cmocka_unit_test(neither_order_nor_hint_matters),
        cmocka_unit_test(scale_does_not_matter),
        cmocka_unit_test(any_finite_doubles_are_answered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
