// SPDX-License-Identifier: GPL-3.0-or-later
// Decimation against a slow reference that weighs every portal anew after every collapse, on boxes cut by
// random planes and on lattices full of ties.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "build/decimate.h"
#include "decimate_worlds.h"

// ---- The reference ----

typedef struct shadow {
    int count;
    double corners[MOST_CORNERS][2];
} shadow;

static double left_of(const double a[2], const double b[2], const double p[2]) {
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
}

static double shadow_area(const shadow *p) {
    double area = 0;
    for (int i = 1; i + 1 < p->count; ++i) area += left_of(p->corners[0], p->corners[i], p->corners[i + 1]);
    return area / 2;
}

static shadow cut_shadow(const shadow *p, const double a[2], const double b[2], double sign) {
    shadow out = {0};
    for (int i = 0; i < p->count; ++i) {
        const double *u = p->corners[i], *v = p->corners[(i + 1) % p->count];
        double du = sign * left_of(a, b, u), dv = sign * left_of(a, b, v);
        assert_true(out.count + 2 < MOST_CORNERS);
        if (du >= 0) memcpy(out.corners[out.count++], u, sizeof out.corners[0]);
        if (!((du > 0 && dv < 0) || (du < 0 && dv > 0))) continue;
        for (int k = 0; k < 2; ++k) out.corners[out.count][k] = u[k] + (v[k] - u[k]) * (du / (du - dv));
        ++out.count;
    }
    return out;
}

static bool is_apart(const shadow *p, const shadow *q) {
    for (int i = 0; i < q->count; ++i) {
        const double *a = q->corners[i], *b = q->corners[(i + 1) % q->count];
        double length = hypot(b[0] - a[0], b[1] - a[1]);
        bool outside = length > 1e-9; // a shorter edge is rounding and has no direction
        for (int j = 0; outside && j < p->count; ++j)
            outside = left_of(a, b, p->corners[j]) <= 1e-14 * length;
        if (outside) return true;
    }
    return false;
}

static double area_outside(shadow p, const shadow *others, int first, int last) {
    while (first < last && (is_apart(&p, &others[first]) || is_apart(&others[first], &p))) ++first;
    double area = 0;
    if (p.count < 3 || shadow_area(&p) < 1e-15) return 0;
    if (first == last) return shadow_area(&p);
    const shadow *other = &others[first];
    for (int i = 0; i < other->count && p.count >= 3; ++i) {
        const double *a = other->corners[i], *b = other->corners[(i + 1) % other->count];
        area += area_outside(cut_shadow(&p, a, b, -1), others, first + 1, last);
        p = cut_shadow(&p, a, b, 1);
    }
    return area;
}

typedef struct reference {
    const world *world;
    int32_t *label; ///< for each fine cell the smallest of its cell
    shadow *shadows;
    enf_heuristic heuristic;
} reference;

static double slow_silhouette(const reference *r, int32_t label, const double n[3]) {
    int k = fabs(n[0]) < 0.6 ? 0 : 1, count = 0;
    double u[3] = {0, 0, 0}, v[3], length = 0, area = 0;
    u[k] = 1;
    for (int i = 0; i < 3; ++i) u[i] -= n[k] * n[i];
    for (int i = 0; i < 3; ++i) length += u[i] * u[i];
    for (int i = 0; i < 3; ++i) u[i] /= sqrt(length);
    for (int i = 0; i < 3; ++i) v[i] = n[(i + 1) % 3] * u[(i + 2) % 3] - n[(i + 2) % 3] * u[(i + 1) % 3];
    for (int i = 0; i < r->world->count; ++i) {
        const flat *piece = &r->world->pieces[i];
        int32_t a = piece->cell[0] < 0 ? -1 : r->label[piece->cell[0]];
        int32_t b = piece->cell[1] < 0 ? -1 : r->label[piece->cell[1]];
        if (a == b || (a != label && b != label)) continue;
        shadow *s = &r->shadows[count];
        s->count = piece->count;
        for (int c = 0; c < piece->count; ++c) {
            const double *p = piece->corners[c];
            s->corners[c][0] = u[0] * p[0] + u[1] * p[1] + u[2] * p[2];
            s->corners[c][1] = v[0] * p[0] + v[1] * p[1] + v[2] * p[2];
        }
        // The faces seen from behind: the other half of those that the program looks at.
        if (shadow_area(s) * (a == label ? -1 : 1) <= 0) continue;
        for (int c = 0; a == label && c < piece->count / 2; ++c) {
            double swap[2];
            memcpy(swap, s->corners[c], sizeof swap);
            memcpy(s->corners[c], s->corners[piece->count - 1 - c], sizeof swap);
            memcpy(s->corners[piece->count - 1 - c], swap, sizeof swap);
        }
        area += area_outside(*s, r->shadows, 0, count);
        ++count;
    }
    return area;
}

static double slow_weight(const reference *r, int32_t a, int32_t b) {
    double area = 0, sum[3] = {0, 0, 0}, largest = 0, plane[3] = {0, 0, 1};
    int32_t owner[2] = {INT32_MAX, INT32_MAX};
    for (int i = 0; i < r->world->count; ++i) {
        const flat *piece = &r->world->pieces[i];
        if (!piece->open) continue;
        int32_t p = r->label[piece->cell[0]], q = r->label[piece->cell[1]];
        if (!((p == a && q == b) || (p == b && q == a))) continue;
        double vector[3];
        area_vector(piece, vector);
        double size = sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
        int32_t low = piece->cell[0] < piece->cell[1] ? piece->cell[0] : piece->cell[1];
        int32_t high = piece->cell[0] < piece->cell[1] ? piece->cell[1] : piece->cell[0];
        bool earlier = low < owner[0] || (low == owner[0] && high < owner[1]);
        if (size > largest || (size == largest && earlier)) {
            largest = size;
            owner[0] = low;
            owner[1] = high;
            memcpy(plane, vector, sizeof plane);
        }
        area += size;
        for (int k = 0; k < 3; ++k) sum[k] += p == a ? vector[k] : -vector[k];
    }
    if (area == 0) return -1;
    double length = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    if (length <= area / 1024) {
        memcpy(sum, plane, sizeof sum);
        length = largest;
    }
    double n[3] = {sum[0] / length, sum[1] / length, sum[2] / length};
    double silhouette = fmax(slow_silhouette(r, a, n), slow_silhouette(r, b, n));
    double weight = (r->heuristic == ENF_HEURISTIC_ASPECT_SCALED ? sqrt(silhouette) : silhouette) / area;
    return ldexp(rint(ldexp(frexp(weight, &(int){0}), 32)), ilogb(weight) + 1 - 32);
}

/// All collapses, each the lightest of all portals weighed anew.
static size_t slow_decimate(const world *w, enf_heuristic heuristic, enf_collapse *collapses) {
    reference r = {.world = w, .heuristic = heuristic};
    size_t cells = (size_t)w->cell_count, done = 0;
    r.label = malloc(cells * sizeof *r.label);
    r.shadows = malloc((size_t)w->count * sizeof *r.shadows);
    double *weights = malloc(cells * cells * sizeof *weights);
    assert_true(r.label && r.shadows && weights);
    for (int32_t c = 0; c < w->cell_count; ++c) r.label[c] = c;
    for (size_t i = 0; i < cells * cells; ++i) weights[i] = NAN;
    for (;;) {
        int32_t best[2] = {-1, -1};
        double lightest = INFINITY;
        for (int32_t a = 0; a < w->cell_count; ++a)
            for (int32_t b = a + 1; b < w->cell_count; ++b) {
                if (r.label[a] != a || r.label[b] != b) continue;
                // Weights of pairs that no collapse has touched stay; all others are computed anew.
                double *weight = &weights[(size_t)a * cells + (size_t)b];
                if (isnan(*weight)) *weight = slow_weight(&r, a, b);
                if (*weight < 0 || !(*weight < lightest)) continue;
                lightest = *weight;
                best[0] = a;
                best[1] = b;
            }
        if (best[0] < 0) break;
        collapses[done++] = (enf_collapse){best[0], best[1], lightest};
        for (int32_t c = 0; c < w->cell_count; ++c) {
            if (r.label[c] == best[1]) r.label[c] = best[0];
            for (int k = 0; k < 2; ++k)
                weights[(size_t)c * cells + (size_t)best[k]] = weights[(size_t)best[k] * cells + (size_t)c] =
                    NAN;
        }
    }
    free(r.label);
    free(r.shadows);
    free(weights);
    return done;
}

// ---- Tests ----

static enf_decimation decimate(const world *w, enf_heuristic heuristic, enf_stop stop, double unit) {
    vertex *vertices = vertices_of(w);
    enf_graph graph = graph_of(w, (const vertex *)vertices);
    enf_decimation out;
    enf_error error;
    enf_status status = enf_graph_decimate(&graph, heuristic, &stop, unit, NULL, NULL, &out, &error);
    if (status != ENF_OK) fail_msg("%s", error.text);
    assert_null(graph.corners); // taken
    free(vertices);
    return out;
}

static const enf_stop down_to_one = {.rule = ENF_STOP_CELLS, .cells = 1};

static void expect_reference(const world *w, enf_heuristic heuristic) {
    enf_collapse *expected = malloc((size_t)w->cell_count * sizeof *expected);
    assert_non_null(expected);
    size_t count = slow_decimate(w, heuristic, expected);
    enf_decimation out = decimate(w, heuristic, down_to_one, 1);
    assert_int_equal(out.collapse_count, count);
    for (size_t i = 0; i < count; ++i) {
        const enf_collapse *a = &out.collapses[i], *b = &expected[i];
        if (a->kept != b->kept || a->gone != b->gone || fabs(a->weight - b->weight) > 1e-8 * b->weight)
            fail_msg("%s, collapse %zu: %d <- %d at %.12g instead of %d <- %d at %.12g",
                     enf_heuristic_name(heuristic), i, a->kept, a->gone, a->weight, b->kept, b->gone,
                     b->weight);
    }
    assert_true(isinf(out.next_weight));
    enf_decimation_free(&out);
    free(expected);
}

static void random_cells_collapse_in_the_order_of_the_slow_reference(void **state) {
    (void)state;
    uint64_t seed = 4242;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int round = 0; round < 24; ++round) {
        world w = cut_world(6 + 2 * round, &seed);
        shuffle(&w, &seed);
        expect_reference(&w, round % 2 ? ENF_HEURISTIC_ASPECT : ENF_HEURISTIC_ASPECT_SCALED);
        free(w.pieces);
    }
}

static void lattice_cells_collapse_in_the_order_of_the_slow_reference(void **state) {
    (void)state;
    uint64_t seed = 99;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int round = 0; round < 16; ++round) {
        const int size[3] = {4, 3, 2 + round % 2};
        int32_t cells[48], count = 0;
        for (int i = 0; i < 48; ++i) cells[i] = next_random(&seed) % 10 ? count++ : -1;
        for (int i = 0; i < 48; ++i) {
            // Numbers without any order in space.
            int j = i + (int)(next_random(&seed) % (uint64_t)(48 - i));
            int32_t swap = cells[i];
            cells[i] = cells[j];
            cells[j] = swap;
        }
        world w = lattice_world(size, cells, 0.125, round % 3 * 10, &seed);
        w.cell_count = count;
        expect_reference(&w, round % 4 < 2 ? ENF_HEURISTIC_ASPECT : ENF_HEURISTIC_ASPECT_SCALED);
        free(w.pieces);
    }
}

static void the_order_of_the_pieces_does_not_matter(void **state) {
    (void)state;
    uint64_t seed = 31;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int round = 0; round < 6; ++round) {
        world w = cut_world(150, &seed);
        enf_decimation first = decimate(&w, round % 2, down_to_one, 1);
        shuffle(&w, &seed);
        enf_decimation second = decimate(&w, round % 2, down_to_one, 1);
        assert_int_equal(first.collapse_count, second.collapse_count);
        assert_true(first.collapse_count > 100);
        for (size_t i = 0; i < first.collapse_count; ++i) {
            assert_int_equal(first.collapses[i].kept, second.collapses[i].kept);
            assert_int_equal(first.collapses[i].gone, second.collapses[i].gone);
            assert_true(first.collapses[i].weight == second.collapses[i].weight);
        }
        enf_decimation_free(&first);
        enf_decimation_free(&second);
        free(w.pieces);
    }
}

static void every_cell_is_connected_through_open_pieces(void **state) {
    (void)state;
    uint64_t seed = 8;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int cells = 1; cells < 60; cells += 7) {
        world w = cut_world(120, &seed);
        enf_decimation out =
            decimate(&w, ENF_HEURISTIC_ASPECT, (enf_stop){.rule = ENF_STOP_CELLS, .cells = cells}, 1);
        // Spread numbers over open pieces within cells; every fine cell must end up with the smallest of its
        // cell.
        int32_t reached[120], smallest[120];
        for (int32_t c = 0; c < w.cell_count; ++c) {
            reached[c] = c;
            smallest[out.cell_of[c]] = -1;
            assert_in_range(out.cell_of[c], 0, out.cell_count - 1);
        }
        int32_t numbered = 0;
        for (int32_t c = 0; c < w.cell_count; ++c)
            if (smallest[out.cell_of[c]] < 0) {
                smallest[out.cell_of[c]] = c;
                assert_int_equal(out.cell_of[c], numbered++);
            }
        assert_int_equal(numbered, out.cell_count);
        assert_int_equal((size_t)out.cell_count + out.collapse_count, w.cell_count);
        for (int round = 0; round < w.cell_count; ++round)
            for (int i = 0; i < w.count; ++i) {
                const int32_t *cell = w.pieces[i].cell;
                if (!w.pieces[i].open || out.cell_of[cell[0]] != out.cell_of[cell[1]]) continue;
                int32_t low = reached[cell[0]] < reached[cell[1]] ? reached[cell[0]] : reached[cell[1]];
                reached[cell[0]] = reached[cell[1]] = low;
            }
        for (int32_t c = 0; c < w.cell_count; ++c) assert_int_equal(reached[c], smallest[out.cell_of[c]]);
        enf_decimation_free(&out);
        free(w.pieces);
    }
}

static void stop_rules_are_kept(void **state) {
    (void)state;
    uint64_t seed = 12;
    world w = cut_world(100, &seed);
    enf_decimation all = decimate(&w, ENF_HEURISTIC_ASPECT, down_to_one, 1);
    for (size_t i = 0; i < all.collapse_count; i += 9) {
        double weight = all.collapses[i].weight;
        enf_decimation out = decimate(&w, ENF_HEURISTIC_ASPECT, (enf_stop){ENF_STOP_WEIGHT, weight, 0}, 1);
        assert_true(out.collapse_count <= i && out.next_weight >= weight);
        for (size_t k = 0; k < out.collapse_count; ++k) assert_true(out.collapses[k].weight < weight);
        assert_true(out.next_weight == all.collapses[out.collapse_count].weight);
        enf_decimation_free(&out);
        int64_t cells = w.cell_count - (int64_t)i;
        out = decimate(&w, ENF_HEURISTIC_ASPECT, (enf_stop){ENF_STOP_CELLS, 0, cells}, 1);
        assert_int_equal(out.cell_count, cells);
        assert_true(out.next_weight == all.collapses[i].weight);
        enf_decimation_free(&out);
    }
    enf_decimation_free(&all);
    free(w.pieces);
}

static void aspect_is_free_of_scale_and_aspect_scaled_counts_in_world_units(void **state) {
    (void)state;
    uint64_t seed = 77;
    world w = cut_world(40, &seed);
    for (int heuristic = 0; heuristic < ENF_HEURISTIC_COUNT; ++heuristic) {
        enf_decimation one = decimate(&w, heuristic, down_to_one, 1),
                       eight = decimate(&w, heuristic, down_to_one, 8);
        double scale = heuristic == ENF_HEURISTIC_ASPECT ? 1 : 0.125;
        for (size_t i = 0; i < one.collapse_count; ++i) {
            assert_int_equal(one.collapses[i].gone, eight.collapses[i].gone);
            assert_true(eight.collapses[i].weight == scale * one.collapses[i].weight);
        }
        enf_decimation_free(&one);
        enf_decimation_free(&eight);
    }
    free(w.pieces);
}

static void the_automatic_stop_keeps_rooms_apart(void **state) {
    (void)state;
    // Two rooms of 8 * 8 * 4 cubes and a passage of 3 cubes between them, in one row.
    const int size[3] = {19, 8, 4};
    static int32_t cells[19 * 8 * 4];
    int32_t count = 0;
    for (int z = 0; z < 4; ++z)
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 19; ++x) {
                bool passage = x >= 8 && x < 11;
                cells[(z * 8 + y) * 19 + x] = !passage || (y == 3 && z == 0) ? count++ : -1;
            }
    uint64_t seed = 3;
    world w = lattice_world(size, cells, 0x1p-5, 0, &seed);
    for (int heuristic = 0; heuristic < ENF_HEURISTIC_COUNT; ++heuristic) {
        enf_decimation out = decimate(&w, heuristic, (enf_stop){.rule = ENF_STOP_AUTO}, 1);
        assert_in_range(out.cell_count, 2, 20);
        assert_true(out.next_weight > 0 && out.next_weight < INFINITY);
        // The far halves of the two rooms are in one cell each, not in the same.
        int32_t left = out.cell_of[cells[(1 * 8 + 4) * 19 + 2]],
                right = out.cell_of[cells[(1 * 8 + 4) * 19 + 16]];
        assert_int_not_equal(left, right);
        int together = 0;
        for (int i = 0; i < 19 * 8 * 4; ++i)
            if (cells[i] >= 0) together += out.cell_of[cells[i]] == (i % 19 < 9 ? left : right);
        assert_in_range(together, 500, 515);
        enf_decimation_free(&out);
    }
    free(w.pieces);
}

static void names_and_stop_rules_are_read(void **state) {
    (void)state;
    enf_stop stop;
    enf_error error;
    assert_int_equal(enf_heuristic_find("aspect"), ENF_HEURISTIC_ASPECT);
    assert_int_equal(enf_heuristic_find("aspect-scaled"), ENF_HEURISTIC_ASPECT_SCALED);
    assert_int_equal(enf_heuristic_find("aspect-"), -1);
    assert_string_equal(enf_heuristic_name(ENF_HEURISTIC_ASPECT_SCALED), "aspect-scaled");
    assert_int_equal(enf_stop_parse("auto", &stop, &error), ENF_OK);
    assert_int_equal(stop.rule, ENF_STOP_AUTO);
    assert_int_equal(enf_stop_parse("weight=2.5", &stop, &error), ENF_OK);
    assert_true(stop.rule == ENF_STOP_WEIGHT && stop.weight == 2.5);
    assert_int_equal(enf_stop_parse("cells=12", &stop, &error), ENF_OK);
    assert_true(stop.rule == ENF_STOP_CELLS && stop.cells == 12);
    const char *bad[] = {
        "",          "weight", "weight=", "weight=x", "weight=-1", "weight=nan",
        "weight=3m", "cells=", "cells=0", "cells=-4", "cells=1.5", "cells=99999999999999999999",
        "autos"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i)
        assert_int_equal(enf_stop_parse(bad[i], &stop, &error), ENF_BAD_USAGE);
}

static bool say_no(void *user, double fraction) {
    assert_true(fraction >= 0 && fraction <= 1);
    ++*(int *)user;
    return false;
}

static void cancelling_leaves_nothing_behind(void **state) {
    (void)state;
    uint64_t seed = 1;
    const int size[3] = {40, 40, 1};
    int32_t *cells = malloc(1600 * sizeof *cells);
    assert_non_null(cells);
    for (int i = 0; i < 1600; ++i) cells[i] = i;
    world w = lattice_world(size, cells, 0x1p-6, 0, &seed);
    vertex *vertices = vertices_of(&w);
    enf_graph graph = graph_of(&w, (const vertex *)vertices);
    enf_decimation out;
    enf_error error;
    int calls = 0;
    assert_int_equal(
        enf_graph_decimate(&graph, ENF_HEURISTIC_ASPECT, &down_to_one, 1, say_no, &calls, &out, &error),
        ENF_NO_RESOURCES);
    assert_int_equal(calls, 1);
    assert_non_null(strstr(error.text, "cancelled"));
    assert_null(graph.corners); // taken
    free(vertices);
    free(w.pieces);
    free(cells);
}

static void strange_graphs_are_refused_or_done(void **state) {
    (void)state;
    enf_stop stop = {.rule = ENF_STOP_AUTO};
    enf_decimation out;
    enf_error error;
    enf_graph graph = {0};
    assert_int_equal(enf_graph_decimate(&graph, ENF_HEURISTIC_ASPECT, &stop, 1, NULL, NULL, &out, &error),
                     ENF_OK);
    assert_int_equal(out.cell_count, 0);
    enf_decimation_free(&out);
    // Two cells and one piece of no area, then of corners that are no numbers, then with a cell too many.
    for (int round = 0; round < 3; ++round) {
        world w = world_new();
        w.cell_count = 2;
        add_piece(&w, &(flat){.cell = {1, 0}, .open = true, .count = 3});
        vertex *vertices = vertices_of(&w);
        for (int i = 0; round > 0 && i < 9; ++i) vertices[i / 3][i % 3] = i % 2 ? NAN : INFINITY;
        graph = graph_of(&w, (const vertex *)vertices);
        if (round == 2) graph.piece_cell[0][0] = 2;
        assert_int_equal(enf_graph_decimate(&graph, ENF_HEURISTIC_ASPECT, &stop, 1, NULL, NULL, &out, &error),
                         round == 2 ? ENF_BAD_INPUT : ENF_OK);
        if (round < 2) enf_decimation_free(&out);
        free(vertices);
        free(w.pieces);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_cells_collapse_in_the_order_of_the_slow_reference),
        cmocka_unit_test(lattice_cells_collapse_in_the_order_of_the_slow_reference),
        cmocka_unit_test(the_order_of_the_pieces_does_not_matter),
        cmocka_unit_test(every_cell_is_connected_through_open_pieces),
        cmocka_unit_test(stop_rules_are_kept),
        cmocka_unit_test(aspect_is_free_of_scale_and_aspect_scaled_counts_in_world_units),
        cmocka_unit_test(the_automatic_stop_keeps_rooms_apart),
        cmocka_unit_test(names_and_stop_rules_are_read),
        cmocka_unit_test(cancelling_leaves_nothing_behind),
        cmocka_unit_test(strange_graphs_are_refused_or_done),
    };
    return cmocka_run_group_tests_name("decimate", tests, NULL, NULL);
}
