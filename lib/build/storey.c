// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/plan.h"

#include "base/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FLOORS_MAX = 1024 };
static const double steepest_floor = 0.7; // cosine of its slope
static const double enough = 0.9;         // of the floor area gets a cut

/// A polygon seen from a kept cell, in page coordinates.
typedef struct slab {
    int32_t polygon;
    double slope; ///< cosine: 1 floor, -1 ceiling
    double area;
    double low[2], high[2];
    double middle[2], height; ///< of its corners
    double normal[3];         ///< length 1; page axes, third up
} slab;

/// Heights at which a cut serves a floor.
typedef struct span {
    double low, high, best, weight;
    bool served;
} span;

static void corner_at(const enf_plan *plan, const enf_file_view *view, int64_t corner, double at[3]) {
    double world[3];
    enf_plan_grid_to_world(view, view->points[view->mesh_corners[corner]], world);
    at[2] = enf_plan_project(plan, world, at);
}

/// Newell's normal gives area and slope.
static void measure(const enf_plan *plan, const enf_file_view *view, slab *out) {
    int64_t first = view->mesh_polygon_corner[out->polygon],
            end = view->mesh_polygon_corner[out->polygon + 1];
    double previous[3], at[3], normal[3] = {0, 0, 0};
    out->low[0] = out->low[1] = INFINITY;
    out->high[0] = out->high[1] = -INFINITY;
    corner_at(plan, view, end - 1, previous);
    for (int64_t c = first; c < end; c++) {
        corner_at(plan, view, c, at);
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, d = (a + 2) % 3;
            normal[a] += (previous[b] - at[b]) * (previous[d] + at[d]);
        }
        for (int a = 0; a < 2; a++) {
            out->low[a] = fmin(out->low[a], at[a]);
            out->high[a] = fmax(out->high[a], at[a]);
            out->middle[a] += at[a] / (double)(end - first);
        }
        out->height += at[2] / (double)(end - first);
        memcpy(previous, at, sizeof at);
    }
    // The page's axes are right-handed as the world's are; a mirrored grid turns polygons over.
    double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    out->area = length / 2;
    for (int a = 0; a < 3; a++)
        out->normal[a] = length > 0 ? normal[a] / length * view->frame->handedness : 0;
    out->slope = out->normal[2];
}

/// Every polygon that a kept fine cell sees, measured.
static slab *collect(const enf_plan *plan, const enf_file_view *view, size_t *count) {
    uint8_t *seen = enf_array_zeroed((size_t)view->mesh_polygon_count, 1);
    slab *slabs = enf_array_zeroed((size_t)view->mesh_polygon_count, sizeof *slabs);
    *count = 0;
    for (int32_t i = 0; seen && slabs && i < view->fine_count; i++) {
        if (view->fine_cell[i] < 0) continue;
        for (int64_t k = view->seen_offset[i]; k < view->seen_offset[i + 1]; k++) seen[view->seen[k]] = 1;
    }
    for (int32_t i = 0; seen && slabs && i < view->mesh_polygon_count; i++) {
        if (!seen[i]) continue;
        slabs[*count].polygon = i;
        measure(plan, view, &slabs[(*count)++]);
    }
    if (!seen) {
        free(slabs);
        slabs = NULL;
    }
    free(seen);
    return slabs;
}

/// The height at which a vertical line meets a polygon's plane, if it passes through the polygon.
static bool meet(const enf_plan *plan, const enf_file_view *view, const slab *slab, const double at[2],
                 double *height) {
    if (at[0] < slab->low[0] || at[0] > slab->high[0] || at[1] < slab->low[1] || at[1] > slab->high[1])
        return false;
    int64_t first = view->mesh_polygon_corner[slab->polygon],
            end = view->mesh_polygon_corner[slab->polygon + 1];
    double a[3], b[3], c[3];
    corner_at(plan, view, first, a);
    for (int64_t k = first + 1; k + 1 < end; k++) {
        corner_at(plan, view, k, b);
        corner_at(plan, view, k + 1, c);
        double whole = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        double u = ((at[0] - a[0]) * (c[1] - a[1]) - (at[1] - a[1]) * (c[0] - a[0])) / whole;
        double v = ((b[0] - a[0]) * (at[1] - a[1]) - (b[1] - a[1]) * (at[0] - a[0])) / whole;
        if (!(u >= 0 && v >= 0 && u + v <= 1)) continue;
        *height = a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2]);
        return true;
    }
    return false;
}

static double ceiling_above(const enf_plan *plan, const enf_file_view *view, const slab *slabs, size_t count,
                            const slab *floor) {
    double lowest = INFINITY, height;
    for (size_t i = 0; i < count; i++)
        if (slabs[i].slope < 0 && meet(plan, view, &slabs[i], floor->middle, &height) &&
            height > floor->height)
            lowest = fmin(lowest, height);
    return lowest;
}

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double weight_at(const span *spans, size_t count, double height) {
    double weight = 0;
    for (size_t i = 0; i < count; i++)
        if (!spans[i].served && spans[i].low <= height && height <= spans[i].high) weight += spans[i].weight;
    return weight;
}

/// The height that serves most; within the stretch where that stays so, the one most floors like best.
static double best_height(const span *spans, size_t count, double *ends) {
    size_t end_count = 0;
    double most = -1, low = 0, high = 0;
    for (size_t i = 0; i < count; i++)
        if (!spans[i].served) ends[end_count++] = spans[i].low, ends[end_count++] = spans[i].high;
    qsort(ends, end_count, sizeof *ends, compare_doubles);
    for (size_t i = 0; i + 1 < end_count; i++) {
        double weight = weight_at(spans, count, (ends[i] + ends[i + 1]) / 2);
        if (ends[i] == ends[i + 1] || weight <= most * (1 + 1e-9)) continue;
        most = weight;
        low = ends[i];
        high = ends[i + 1];
    }
    double sum = 0, wish = 0;
    for (size_t i = 0; i < count; i++) {
        if (spans[i].served || spans[i].low > low || spans[i].high < high) continue;
        sum += spans[i].weight;
        wish += spans[i].weight * spans[i].best;
    }
    wish = sum > 0 ? wish / sum : (low + high) / 2;
    double margin = (high - low) * 0.01; // not exactly at an end
    return fmin(fmax(wish, low + margin), high - margin);
}

static int choose_heights(span *spans, size_t count, double *ends, double heights[ENF_STOREYS_MAX]) {
    double total = 0, served = 0;
    int made = 0;
    for (size_t i = 0; i < count; i++) total += spans[i].weight;
    while (made < ENF_STOREYS_MAX && total > 0 && served < enough * total) {
        double height = best_height(spans, count, ends), gain = 0;
        for (size_t i = 0; i < count; i++) {
            if (spans[i].served || spans[i].low > height || spans[i].high < height) continue;
            spans[i].served = true;
            gain += spans[i].weight;
        }
        if (!(gain > 0)) break;
        served += gain;
        heights[made++] = height;
    }
    qsort(heights, (size_t)made, sizeof *heights, compare_doubles);
    return made;
}

static size_t make_spans(const enf_plan *plan, const enf_file_view *view, const slab *slabs, size_t count,
                         span *spans) {
    size_t floors = 0, made = 0, number = 0;
    for (size_t i = 0; i < count; i++) floors += slabs[i].slope > steepest_floor;
    size_t stride = floors / FLOORS_MAX + 1;
    for (size_t i = 0; i < count && made < FLOORS_MAX; i++) {
        if (slabs[i].slope <= steepest_floor || number++ % stride) continue;
        double room = ceiling_above(plan, view, slabs, count, &slabs[i]) - slabs[i].height;
        if (!isfinite(room)) continue;
        spans[made++] = (span){.low = slabs[i].height + 0.08 * room,
                               .high = slabs[i].height + 0.92 * room,
                               .best = slabs[i].height + 0.5 * room,
                               .weight = slabs[i].area};
    }
    return made;
}

int enf_storeys_find(const enf_plan *plan, const enf_file_view *view, double heights[ENF_STOREYS_MAX]) {
    size_t count;
    slab *slabs = collect(plan, view, &count);
    span *spans = enf_array_new(FLOORS_MAX, sizeof *spans);
    double *ends = enf_array_new(2 * (size_t)FLOORS_MAX, sizeof *ends);
    int made = 0;
    if (slabs && spans && ends) {
        size_t span_count = make_spans(plan, view, slabs, count, spans);
        made = choose_heights(spans, span_count, ends, heights);
        if (made == 0) { // no floor with a ceiling: cut through the middle
            double low = INFINITY, high = -INFINITY;
            for (int32_t i = 0; i < view->cell_count; i++) {
                low = fmin(low, view->cells[i].box_min[plan->up]);
                high = fmax(high, view->cells[i].box_max[plan->up]);
            }
            heights[made++] = low <= high ? (low + high) / 2 : 0;
        }
    }
    free(slabs);
    free(spans);
    free(ends);
    return made;
}

/// An edge of a floor polygon.
typedef struct rim {
    int32_t low, high; ///< points
    const slab *floor;
    int storey;
} rim;

static int compare_rims(const void *a, const void *b) {
    const rim *x = a, *y = b;
    if (x->low != y->low) return x->low < y->low ? -1 : 1;
    if (x->high != y->high) return x->high < y->high ? -1 : 1;
    return (x->floor > y->floor) - (x->floor < y->floor);
}

static int storey_above(const enf_plan *plan, double height) {
    for (int i = 0; i < plan->storey_count; i++)
        if (plan->storeys[i].height >= height) return i;
    return -1;
}

static size_t collect_rims(const enf_plan *plan, const enf_file_view *view, const slab *slabs, size_t count,
                           rim *rims) {
    size_t made = 0;
    for (size_t i = 0; i < count; i++) {
        int storey = slabs[i].slope > steepest_floor ? storey_above(plan, slabs[i].height) : -1;
        int64_t first = view->mesh_polygon_corner[slabs[i].polygon],
                end = view->mesh_polygon_corner[slabs[i].polygon + 1];
        for (int64_t c = first; storey >= 0 && c < end; c++) {
            int32_t a = view->mesh_corners[c], b = view->mesh_corners[c + 1 < end ? c + 1 : first];
            rims[made++] =
                (rim){.low = a < b ? a : b, .high = a < b ? b : a, .floor = &slabs[i], .storey = storey};
        }
    }
    qsort(rims, made, sizeof *rims, compare_rims);
    return made;
}

/// Two polygons that lie flat against each other have no rim between them.
static bool is_seam(const rim *a, const rim *b) {
    const double *n = a->floor->normal, *m = b->floor->normal;
    return a->low == b->low && a->high == b->high && n[0] * m[0] + n[1] * m[1] + n[2] * m[2] > 0.9999;
}

static bool add_rims(enf_plan *plan, const enf_file_view *view, const rim *rims, size_t count) {
    for (size_t i = 0; i < count; i++) {
        if ((i > 0 && is_seam(&rims[i - 1], &rims[i])) || (i + 1 < count && is_seam(&rims[i], &rims[i + 1])))
            continue;
        double page[2][2], world[3];
        for (int k = 0; k < 2; k++) {
            enf_plan_grid_to_world(view, view->points[k ? rims[i].high : rims[i].low], world);
            enf_plan_project(plan, world, page[k]);
        }
        if (!enf_plan_add_line(&plan->storeys[rims[i].storey], page[0], page[1], ENF_PLAN_FLOOR))
            return false;
    }
    return true;
}

bool enf_storeys_outline(enf_plan *plan, const enf_file_view *view) {
    size_t count;
    slab *slabs = collect(plan, view, &count);
    rim *rims = enf_array_new((size_t)view->mesh_corner_count, sizeof *rims);
    bool good = slabs && rims;
    if (good) good = add_rims(plan, view, rims, collect_rims(plan, view, slabs, count, rims));
    free(slabs);
    free(rims);
    return good;
}
