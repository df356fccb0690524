// SPDX-License-Identifier: GPL-3.0-or-later
// The rules. A region is
//   outside  if an open facet of the convex hull belongs to it, and it is inside no solid;
//   rock     if its winding number is positive (it is inside a closed solid, however solids overlap); or if
//   it is 0
//            and the region sees more back than front area, or no front at all (the gap between two rooms
//            drawn as shells, the inside of a table leg that reaches into the table top);
//   air      otherwise. A spawn point makes its region air (or outside, with a leak) whatever the polygons
//   say.
// Rounded coordinates leave hairline cracks between polygons that once met. An opening narrower than the weld
// distance (or the plane tolerance) does not join two regions, nor does a layer that is thinner (gap.h):
// where nothing wider joins them either, it is sealed (and reported); inside a region such slivers stay open,
// so no sight line is lost.
// --keep auto keeps the regions with spawn points; without any, every air region; if there is none, the
// outside.
#include "build/region.h"

#include "base/array.h"
#include "base/sets.h"
#include "build/gap.h"
#include "build/leak.h"
#include "build/spawn.h"
#include "build/winding.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void enf_regions_free(enf_regions *regions) {
    free(regions->cell_region);
    free(regions->kind);
    free(regions->kept);
    free(regions->touches_outside);
    free(regions->winding);
    free(regions->ambiguous);
    free(regions->volume);
    free(regions->hairline);
    free(regions->front_area);
    free(regions->back_area);
    free(regions->spawn_cell);
    free(regions->leak_points);
    memset(regions, 0, sizeof *regions);
}

// ---------------------------------------------------------------------------------------------- components

/// The cells on both sides of a piece; -1 outside the hull.
static void piece_cells(const enf_complex *complex, const int32_t *face_cell, int32_t piece,
                        int32_t cell[2]) {
    for (int side = 0; side < 2; side++) {
        int32_t face = complex->piece_face[piece][side];
        cell[side] = face < 0 ? -1 : face_cell[face];
    }
}

static void join_through_all(const enf_complex *complex, const int32_t *face_cell, int32_t *parent) {
    int32_t outside = complex->cell_count, cell[2];
    for (int32_t p = 0; p < complex->pieces.count; p++) {
        if (complex->piece_cover[p] != ENF_PIECE_OPEN) continue;
        piece_cells(complex, face_cell, p, cell);
        enf_sets_unite(parent, cell[0] < 0 ? outside : cell[0], cell[1] < 0 ? outside : cell[1]);
    }
}

/// Joins cells through open pieces at least `crack` wide (gap.h), then those in the open that only cracks
/// bound (needles) and those in gaps, then seals the cracks that are left between different components.
/// parent: the cells, then the outside of the hull; walled: the same.
static bool join_cells(enf_regions *regions, enf_complex *complex, const int32_t *face_cell, double crack,
                       int32_t *parent, bool *walled, bool *gap) {
    int32_t outside = complex->cell_count, cell[2];
    if (!(crack > 0)) {
        join_through_all(complex, face_cell, parent);
        return true;
    }
    if (!enf_gaps_join(complex, face_cell, crack, gap, parent)) return false;
    for (int32_t p = 0; p < complex->pieces.count; p++) {
        piece_cells(complex, face_cell, p, cell);
        for (int side = 0; side < 2; side++) {
            bool wall = complex->piece_cover[p] != ENF_PIECE_OPEN;
            if (wall && cell[side] >= 0 && !gap[cell[side]]) walled[enf_sets_find(parent, cell[side])] = true;
        }
    }
    walled[enf_sets_find(parent, outside)] = true;
    for (int32_t p = 0; p < complex->pieces.count; p++) {
        piece_cells(complex, face_cell, p, cell);
        if (complex->piece_cover[p] != ENF_PIECE_OPEN || cell[0] < 0 || cell[1] < 0) continue;
        int32_t a = enf_sets_find(parent, cell[0]), b = enf_sets_find(parent, cell[1]);
        if (a == b || (walled[a] && walled[b])) continue;
        bool wall = walled[a] || walled[b];
        enf_sets_unite(parent, a, b);
        walled[enf_sets_find(parent, a)] = wall;
    }
    for (int32_t p = 0; p < complex->pieces.count; p++) {
        if (complex->piece_cover[p] != ENF_PIECE_OPEN) continue;
        piece_cells(complex, face_cell, p, cell);
        int32_t a = cell[0] < 0 ? outside : cell[0], b = cell[1] < 0 ? outside : cell[1];
        if (enf_sets_find(parent, a) == enf_sets_find(parent, b)) continue;
        double area[3];
        enf_complex_piece_area(complex, p, area);
        regions->sealed++;
        regions->sealed_area += sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
        complex->piece_cover[p] = ENF_PIECE_SEALED;
    }
    return true;
}

/// Regions are the components over the pieces that are open now, numbered by their smallest cell.
static bool colour_cells(enf_regions *regions, enf_complex *complex, const int32_t *face_cell, double crack) {
    int32_t cells = complex->cell_count;
    int32_t *parent = enf_array_new((size_t)cells + 1, sizeof *parent);
    bool *walled = enf_array_zeroed((size_t)cells + 1, sizeof *walled);
    bool *gap = enf_array_zeroed((size_t)cells, sizeof *gap);
    regions->cell_region = enf_array_new((size_t)cells, sizeof *regions->cell_region);
    bool good = parent && walled && gap && regions->cell_region;
    if (good) {
        enf_sets_start(parent, cells + 1);
        good = join_cells(regions, complex, face_cell, crack, parent, walled, gap);
        enf_sets_start(parent, cells + 1);
        for (int32_t p = 0; p < complex->pieces.count; p++) {
            int32_t cell[2];
            piece_cells(complex, face_cell, p, cell);
            if (complex->piece_cover[p] == ENF_PIECE_OPEN && cell[0] >= 0 && cell[1] >= 0) {
                enf_sets_unite(parent, cell[0], cell[1]);
            }
        }
        for (int32_t c = 0; c < cells; c++) {
            int32_t root = enf_sets_find(parent, c);
            regions->cell_region[c] = root == c ? regions->region_count++ : regions->cell_region[root];
        }
    }
    free(parent);
    free(walled);
    free(gap);
    return good;
}

static bool allocate(enf_regions *regions) {
    size_t count = (size_t)regions->region_count;
    regions->kind = enf_array_zeroed(count, sizeof *regions->kind);
    regions->kept = enf_array_zeroed(count, sizeof *regions->kept);
    regions->touches_outside = enf_array_zeroed(count, sizeof *regions->touches_outside);
    regions->winding = enf_array_zeroed(count, sizeof *regions->winding);
    regions->ambiguous = enf_array_zeroed(count, sizeof *regions->ambiguous);
    regions->volume = enf_array_zeroed(count, sizeof *regions->volume);
    regions->hairline = enf_array_zeroed(count, sizeof *regions->hairline);
    regions->front_area = enf_array_zeroed(count, sizeof *regions->front_area);
    regions->back_area = enf_array_zeroed(count, sizeof *regions->back_area);
    return regions->kind && regions->kept && regions->touches_outside && regions->winding &&
           regions->ambiguous && regions->volume && regions->hairline && regions->front_area &&
           regions->back_area;
}

/// Areas of fronts and backs, and whether the hull is open somewhere. `bodies` get all closed area as
/// surface.
static void measure_pieces(enf_regions *regions, const enf_complex *complex, const int32_t *face_cell,
                           enf_body_size *bodies) {
    for (int32_t p = 0; p < complex->pieces.count; p++) {
        const int32_t *face = complex->piece_face[p];
        int32_t cover = complex->piece_cover[p];
        double area[3] = {0}, size = 0;
        if (cover != ENF_PIECE_OPEN) {
            enf_complex_piece_area(complex, p, area);
            size = sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
        }
        for (int side = 0; side < 2; side++) {
            if (face[side] < 0) continue;
            int32_t region = regions->cell_region[face_cell[face[side]]];
            bodies[region].surface += size;
            if (cover == ENF_PIECE_OPEN) {
                if (face[1 - side] < 0) regions->touches_outside[region] = true;
            } else if (cover >= 0) {
                bool front = complex->cover_side[cover] == side;
                *(front ? &regions->front_area[region] : &regions->back_area[region]) += size;
            }
        }
    }
}

static bool measure(enf_regions *regions, const enf_complex *complex, const int32_t *face_cell,
                    double crack) {
    enf_body_size *bodies = enf_array_new((size_t)regions->region_count, sizeof *bodies);
    if (!bodies) return false;
    for (int32_t r = 0; r < regions->region_count; r++) {
        bodies[r] =
            (enf_body_size){.low = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, .high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    }
    for (int32_t c = 0; c < complex->cell_count; c++) {
        enf_complex_measure_cell(complex, c, &bodies[regions->cell_region[c]]);
    }
    for (int32_t r = 0; r < regions->region_count; r++) {
        regions->volume[r] = fmax(bodies[r].volume, 0); // of hairlines, rounding may leave less than nothing
        bodies[r].surface = 0;                          // only the closed part of the faces counts
    }
    measure_pieces(regions, complex, face_cell, bodies);
    for (int32_t r = 0; r < regions->region_count; r++) {
        regions->hairline[r] = !regions->touches_outside[r] && enf_body_is_hairline(&bodies[r], crack);
    }
    free(bodies);
    return true;
}

static void judge(enf_regions *regions) {
    for (int32_t r = 0; r < regions->region_count; r++) {
        double front = regions->front_area[r], back = regions->back_area[r];
        bool sees = front > 0 && front >= back;
        if (regions->hairline[r]) {
            regions->kind[r] = ENF_KIND_ROCK;
            regions->ambiguous[r] = false;
        } else if (regions->touches_outside[r]) {
            regions->kind[r] = regions->winding[r] > 0 ? ENF_KIND_ROCK : ENF_KIND_OUTSIDE;
        } else if (regions->winding[r] > 0 || (regions->winding[r] == 0 && !sees)) {
            regions->kind[r] = ENF_KIND_ROCK;
        } else {
            regions->kind[r] = ENF_KIND_AIR;
        }
    }
}

// ---------------------------------------------------------------------------------------------- spawns

/// Of the cells around a spawn on a boundary, the one in the best region: air before outside before rock,
/// then the larger region, then the smaller number.
static int32_t best_cell(const enf_regions *regions, const enf_cell_list *list) {
    static const int rank[] = {[ENF_KIND_AIR] = 0, [ENF_KIND_OUTSIDE] = 1, [ENF_KIND_ROCK] = 2};
    int32_t best = -1;
    for (size_t i = 0; i < list->count; i++) {
        int32_t cell = list->cells[i], region = regions->cell_region[cell];
        if (best < 0) {
            best = cell;
            continue;
        }
        int32_t other = regions->cell_region[best];
        int order = rank[regions->kind[region]] - rank[regions->kind[other]];
        if (order == 0 && regions->volume[region] != regions->volume[other]) {
            order = regions->volume[region] > regions->volume[other] ? -1 : 1;
        }
        if (order < 0 || (order == 0 && cell < best)) best = cell;
    }
    return best;
}

static bool place_spawns(enf_regions *regions, const enf_complex *complex, const enf_mesh *mesh,
                         const enf_tet_mesh *tets) {
    regions->spawn_count = (int32_t)mesh->spawn_count;
    regions->spawn_cell = enf_array_new(mesh->spawn_count, sizeof *regions->spawn_cell);
    if (!regions->spawn_cell) return false;
    enf_cell_list list = {0};
    bool good = true;
    for (size_t s = 0; good && s < mesh->spawn_count; s++) {
        good = enf_complex_cells_at(complex, tets, mesh->spawns + 3 * s, &list);
        regions->spawn_cell[s] = best_cell(regions, &list);
    }
    enf_cell_list_free(&list);
    for (int32_t s = 0; good && s < regions->spawn_count; s++) {
        int32_t cell = regions->spawn_cell[s];
        if (cell < 0) continue;
        int32_t region = regions->cell_region[cell];
        regions->kind[region] = regions->touches_outside[region] ? ENF_KIND_OUTSIDE : ENF_KIND_AIR;
    }
    return good;
}

static bool keep_spawned(enf_regions *regions) {
    bool any = false;
    for (int32_t s = 0; s < regions->spawn_count; s++) {
        if (regions->spawn_cell[s] < 0) continue;
        regions->kept[regions->cell_region[regions->spawn_cell[s]]] = true;
        any = true;
    }
    return any;
}

static bool keep_kind(enf_regions *regions, enf_kind kind) {
    bool any = false;
    for (int32_t r = 0; r < regions->region_count; r++) {
        if (regions->kind[r] != kind) continue;
        regions->kept[r] = true;
        any = true;
    }
    return any;
}

static enf_status keep_regions(enf_regions *regions, enf_keep keep, enf_error *error) {
    bool any;
    switch (keep) {
    case ENF_KEEP_ALL:
        memset(regions->kept, 1, (size_t)regions->region_count * sizeof *regions->kept);
        return ENF_OK;
    case ENF_KEEP_SPAWN:
        if (keep_spawned(regions)) return ENF_OK;
        return enf_fail(
            error, ENF_BAD_INPUT,
            "no spawn point lies in the world; add '# spawn x y z' lines or --spawn, or use --keep auto");
    case ENF_KEEP_OUTSIDE:
        any = keep_spawned(regions) || keep_kind(regions, ENF_KIND_AIR);
        any |= keep_kind(regions, ENF_KIND_OUTSIDE);
        break;
    default:
        any =
            keep_spawned(regions) || keep_kind(regions, ENF_KIND_AIR) || keep_kind(regions, ENF_KIND_OUTSIDE);
        break;
    }
    if (any) return ENF_OK;
    return enf_fail(error, ENF_BAD_INPUT,
                    "nothing is left to keep: every region is solid; are the polygons turned inside out? "
                    "Name a spawn point or use --keep all");
}

enf_status enf_regions_colour(enf_regions *regions, enf_complex *complex, const enf_mesh *mesh,
                              const enf_tet_mesh *tets, enf_keep keep, double crack, enf_error *error) {
    memset(regions, 0, sizeof *regions);
    int32_t *face_cell = enf_complex_face_cells(complex);
    bool good = face_cell && colour_cells(regions, complex, face_cell, crack) && allocate(regions);
    if (good) {
        good = measure(regions, complex, face_cell, crack) &&
               enf_complex_wind(complex, mesh, face_cell, regions->cell_region, regions->region_count,
                                regions->winding, regions->ambiguous);
    }
    if (good) {
        judge(regions);
        good = place_spawns(regions, complex, mesh, tets) &&
               enf_regions_trace_leak(regions, complex, mesh, face_cell);
    }
    free(face_cell);
    enf_status status = good ? keep_regions(regions, keep, error) : enf_fail_memory(error, "the regions");
    if (status != ENF_OK) enf_regions_free(regions);
    return status;
}
