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
#include "build/region_size.h"
#include "build/spawn.h"

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

/// Is the piece narrower than `crack` somewhere? Its width is at least its area divided by its diameter,
/// which settles nearly all of them: twice that margin, and more than the rounding of either, is left to the
/// exact formula, so it decides alone.
static bool is_crack(const enf_complex *complex, int32_t piece, double crack) {
    const double(*at)[3] = (const double(*)[3])complex->vertex_position;
    int32_t count;
    const enf_corner *corners = enf_complex_piece(complex, piece, &count);
    const double *origin = at[corners[0].vertex];
    double area[3] = {0, 0, 0}, before[3] = {0, 0, 0}, radius = 0; // twice the area; the radius squared
    for (int32_t i = 1; i < count; i++) {
        const double *p = at[corners[i].vertex];
        double u[3] = {p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]};
        double square = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
        if (square > radius) radius = square;
        area[0] += before[1] * u[2] - before[2] * u[1];
        area[1] += before[2] * u[0] - before[0] * u[2];
        area[2] += before[0] * u[1] - before[1] * u[0];
        memcpy(before, u, sizeof before);
    }
    double square = area[0] * area[0] + area[1] * area[1] + area[2] * area[2];
    if (square > 128 * radius * (crack * crack + 0x1p-80 * radius))
        return false; // the diameter is <= 2 radii
    return enf_complex_piece_width(complex, piece) < crack;
}

enum { WALL = 1, TO_OUTSIDE = 2 }; ///< what a cell has: an occluded piece, an open piece of the hull

/// The open pieces that are narrower than a crack, or at a gap (gap.h), ascending.
typedef struct crack_list {
    int32_t *pieces;
    size_t count, capacity;
} crack_list;

/// Joins cells through open pieces that are no cracks and not at a gap, and lists the others. False without
/// memory.
static bool join_cells(const enf_complex *complex, double crack, const bool *gap, int32_t *parent,
                       uint8_t *has, crack_list *cracks) {
    for (int32_t p = 0; p < complex->pieces.count; p++) {
        const int32_t *cell = enf_complex_piece_cells(complex, p);
        bool inner = cell[0] >= 0 && cell[1] >= 0;
        bool at_gap = (cell[0] >= 0 && gap[cell[0]]) || (cell[1] >= 0 && gap[cell[1]]);
        if (complex->piece_cover[p] != ENF_PIECE_OPEN) {
            for (int side = 0; side < 2; side++)
                if (cell[side] >= 0) has[cell[side]] |= WALL;
        } else if (inner && enf_sets_joined(parent, cell[0], cell[1])) {
            continue; // joined already; whether this is a crack does not matter
        } else if (at_gap || (crack > 0 && is_crack(complex, p, crack))) {
            if (!enf_array_reserve(cracks->pieces, cracks->capacity, cracks->count + 1)) return false;
            cracks->pieces[cracks->count++] = p;
        } else if (inner) {
            enf_sets_unite(parent, cell[0], cell[1]);
        } else {
            has[cell[0] < 0 ? cell[1] : cell[0]] |= TO_OUTSIDE;
        }
    }
    return true;
}

/// Opens the cracks to components that only cracks bound (needles, and gaps), then seals those that are left
/// between different components. `joined` is over the cells and, as the last, the outside of the hull.
static void judge_cracks(enf_regions *regions, enf_complex *complex, const crack_list *cracks,
                         int32_t *joined, bool *walled) {
    int32_t outside = complex->cell_count;
    for (size_t i = 0; i < cracks->count; i++) {
        const int32_t *cell = enf_complex_piece_cells(complex, cracks->pieces[i]);
        if (cell[0] < 0 || cell[1] < 0) continue;
        int32_t a = enf_sets_find(joined, cell[0]), b = enf_sets_find(joined, cell[1]);
        if (a == b || (walled[a] && walled[b])) continue;
        bool wall = walled[a] || walled[b];
        enf_sets_unite(joined, a, b);
        walled[enf_sets_find(joined, a)] = wall;
    }
    for (size_t i = 0; i < cracks->count; i++) {
        int32_t p = cracks->pieces[i];
        const int32_t *cell = enf_complex_piece_cells(complex, p);
        int32_t a = cell[0] < 0 ? outside : cell[0], b = cell[1] < 0 ? outside : cell[1];
        if (enf_sets_find(joined, a) == enf_sets_find(joined, b)) continue;
        double area[3];
        enf_complex_piece_area(complex, p, area);
        regions->sealed++;
        regions->sealed_area += sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
        complex->piece_cover[p] = ENF_PIECE_SEALED;
    }
}

/// Decides which cracks are sealed, and joins cells through the others. `parent` is as join_cells leaves it.
static bool seal_cracks(enf_regions *regions, enf_complex *complex, double crack, const bool *gap,
                        const crack_list *cracks, int32_t *parent, const uint8_t *has) {
    if (cracks->count == 0) return true;
    int32_t outside = complex->cell_count;
    int32_t *joined = enf_array_new((size_t)outside + 1, sizeof *joined);
    bool *walled = enf_array_zeroed((size_t)outside + 1, sizeof *walled);
    bool good = joined && walled;
    if (good) {
        memcpy(joined, parent, (size_t)outside * sizeof *joined);
        joined[outside] = outside;
        for (int32_t c = 0; c < outside; c++)
            if (has[c] & TO_OUTSIDE) enf_sets_unite(joined, c, outside);
        good = enf_gaps_join(complex, crack, gap, cracks->pieces, cracks->count, joined);
        for (int32_t c = 0; c < outside; c++)
            if (has[c] & WALL && !gap[c]) walled[enf_sets_find(joined, c)] = true;
        walled[enf_sets_find(joined, outside)] = true;
        judge_cracks(regions, complex, cracks, joined, walled);
    }
    for (size_t i = 0; good && i < cracks->count; i++) {
        const int32_t *cell = enf_complex_piece_cells(complex, cracks->pieces[i]);
        if (complex->piece_cover[cracks->pieces[i]] == ENF_PIECE_OPEN && cell[0] >= 0 && cell[1] >= 0)
            enf_sets_unite(parent, cell[0], cell[1]);
    }
    free(joined);
    free(walled);
    return good;
}

/// Regions are the components over the pieces that are open now, numbered by their smallest cell.
static bool colour_cells(enf_regions *regions, enf_complex *complex, double crack, bool *gap) {
    int32_t cells = complex->cell_count;
    int32_t *parent = enf_array_new((size_t)cells, sizeof *parent);
    uint8_t *has = enf_array_zeroed((size_t)cells, sizeof *has);
    crack_list cracks = {0};
    bool good = parent && has && (!(crack > 0) || enf_gaps_find(complex, crack, gap));
    if (good) {
        enf_sets_start(parent, cells);
        good = join_cells(complex, crack, gap, parent, has, &cracks) &&
               seal_cracks(regions, complex, crack, gap, &cracks, parent, has);
    }
    free(has);
    free(cracks.pieces);
    regions->cell_region = parent; // every link leads to a smaller cell, which has its region by then
    for (int32_t c = 0; good && c < cells; c++)
        regions->cell_region[c] = parent[c] == c ? regions->region_count++ : regions->cell_region[parent[c]];
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
    bool *gap = enf_array_zeroed((size_t)complex->cell_count, sizeof *gap);
    bool good = gap && colour_cells(regions, complex, crack, gap) && allocate(regions);
    if (good) {
        good = enf_regions_measure(regions, complex, mesh, gap, crack);
    }
    if (good) {
        judge(regions);
        good = place_spawns(regions, complex, mesh, tets) && enf_regions_trace_leak(regions, complex, mesh);
    }
    free(gap);
    enf_status status = good ? keep_regions(regions, keep, error) : enf_fail_memory(error, "the regions");
    if (status != ENF_OK) enf_regions_free(regions);
    return status;
}
