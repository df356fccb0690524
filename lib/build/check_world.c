// SPDX-License-Identifier: GPL-3.0-or-later
// Colour and decimate: regions, what is kept of them, and the cells that fine cells went into.
#include "build/check_rows.h"

#include "base/array.h"
#include "format/frame.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { KIND_AIR = 0, KIND_ROCK = 1, KIND_OUTSIDE = 2 };

static int32_t find_root(int32_t *parent, int32_t cell) {
    while (parent[cell] != cell) {
        parent[cell] = parent[parent[cell]];
        cell = parent[cell];
    }
    return cell;
}

/// Joins fine cells through open pieces, those of one cell only if `within_cells`. Null without memory.
static int32_t *join_cells(enf_checker *checker, bool within_cells) {
    const enf_file_view *view = checker->view;
    int32_t *parent = enf_array_new((size_t)view->fine_count, sizeof *parent);
    if (!parent) {
        enf_check_no_memory(checker);
        return NULL;
    }
    for (int32_t c = 0; c < view->fine_count; c++) parent[c] = c;
    for (int32_t p = 0; p < view->piece_count; p++) {
        const int32_t *fine = view->facet_fine[view->piece_facet[p]];
        if (!enf_check_is_open(view, p) || fine[0] < 0 || fine[1] < 0) continue;
        int32_t a = fine[0], b = fine[1];
        if (within_cells && view->fine_cell[a] != view->fine_cell[b]) continue;
        a = find_root(parent, a);
        b = find_root(parent, b);
        if (a != b) parent[a > b ? a : b] = a < b ? a : b;
    }
    return parent;
}

// ---------------------------------------------------------------------------------------------- colour

static void check_regions(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "colour: regions",
                    "regions are the fine cells that open pieces connect, each in exactly one");
    int32_t *parent = join_cells(checker, false);
    if (!parent) return;
    int32_t regions = 0;
    for (int32_t c = 0; c < view->fine_count && enf_check_holds(checker); c++, checker->row->tested++) {
        int32_t root = find_root(parent, c), region = view->fine_region[c];
        if (root == c ? region != regions++ : region != view->fine_region[root])
            enf_check_break(checker,
                            "fine cell %d is in region %d, but connected to fine cell %d of region %d",
                            (int)c, (int)region, (int)root, (int)view->fine_region[root]);
    }
    if (enf_check_holds(checker) && regions != view->region_count)
        enf_check_break(checker, "%d regions are listed, but there are %d", (int)view->region_count,
                        (int)regions);
    free(parent);
}

/// The width of the narrowest strip that holds the piece, from rounded corners, grid steps.
static double piece_width(const enf_checker *checker, const enf_check_loop *loop) {
    double width = HUGE_VAL;
    for (int32_t i = 0; i < loop->count; i++) {
        const double *p = checker->exact.near[loop->corners[i].vertex],
                     *q = checker->exact.near[loop->corners[(i + 1) % loop->count].vertex];
        double u[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]},
               length = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
        double farthest = 0;
        for (int32_t k = 0; k < loop->count && length > 0; k++) {
            const double *r = checker->exact.near[loop->corners[k].vertex];
            double v[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]},
                   along = (u[0] * v[0] + u[1] * v[1] + u[2] * v[2]) / length;
            double square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2] - along * along;
            farthest = fmax(farthest, sqrt(fmax(square, 0)));
        }
        width = fmin(width, farthest);
    }
    return width * checker->exact.unit;
}

/// Is the fine cell (-1: none) a layer thinner than `thin` grid steps: volume against half the surface, or a
/// needle? From rounded corners.
static bool is_layer(const enf_checker *checker, int32_t cell, double thin) {
    const enf_file_view *view = checker->view;
    double volume = 0, surface = 0, size = 0;
    const double *apex = NULL;
    for (int32_t i = cell < 0 ? 0 : view->fine_facet[cell]; cell >= 0 && i < view->fine_facet[cell + 1];
         i++) {
        int32_t f = view->fine_facets[i];
        const enf_file_corner *corners = view->facet_corners + view->facet_offset[f];
        int64_t count = view->facet_offset[f + 1] - view->facet_offset[f];
        const double *first = view->vertex_position[corners[0].vertex];
        double area[3] = {0, 0, 0};
        if (!apex) apex = first;
        for (int64_t k = 1; k < count; k++) {
            const double *p = view->vertex_position[corners[k].vertex],
                         *q = view->vertex_position[corners[(k + 1) % count].vertex];
            double square = 0;
            for (int a = 0; a < 3; a++) {
                int b = (a + 1) % 3, c = (a + 2) % 3;
                area[a] +=
                    ((p[b] - first[b]) * (q[c] - first[c]) - (p[c] - first[c]) * (q[b] - first[b])) / 2;
                square += (p[a] - apex[a]) * (p[a] - apex[a]);
            }
            size = fmax(size, sqrt(square));
        }
        double height = 0;
        for (int a = 0; a < 3; a++) height += area[a] * (first[a] - apex[a]) / 3;
        volume += view->facet_fine[f][1] == cell ? -height : height;
        surface += sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
    }
    return cell >= 0 && (2 * volume <= thin * surface || surface <= thin * 2 * size);
}

/// Widths come from rounded corners (and lose half their digits in the subtraction): two grid steps, and
/// 2^-24 of the piece's size, are allowed.
static bool check_seal(enf_checker *checker, int32_t piece, int32_t facet, double crack) {
    const enf_file_view *view = checker->view;
    const int32_t *fine = view->facet_fine[facet];
    int32_t behind = fine[0] < 0 ? -1 : view->fine_region[fine[0]],
            front = fine[1] < 0 ? -1 : view->fine_region[fine[1]];
    if (behind == front)
        return enf_check_break(checker, "piece %d is sealed, though both its sides are region %d", (int)piece,
                               (int)front);
    enf_check_loop loop = enf_check_piece(checker, piece, facet);
    const double *p = checker->exact.near[loop.corners[0].vertex];
    double size = 0;
    for (int32_t k = 1; k < loop.count; k++) {
        for (int a = 0; a < 3; a++)
            size = fmax(size, fabs(checker->exact.near[loop.corners[k].vertex][a] - p[a]));
    }
    double allowed = crack + 2 + 0x1p-24 * size * checker->exact.unit;
    if (piece_width(checker, &loop) <= allowed) return true;
    for (int side = 0; side < 2; side++)
        if (is_layer(checker, fine[side], allowed)) return true;
    return enf_check_break(checker, "piece %d is sealed, though it is wider than the tolerance", (int)piece);
}

static void check_seals(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(
        checker, "colour: seals",
        "only cracks between two regions, narrower than the tolerance, and layers thinner are sealed");
    double crack = fmax(view->frame->weld, view->frame->plane_tolerance) / view->frame->step;
    int64_t sealed = 0;
    for (int32_t f = 0; f < view->facet_count; f++) {
        for (int32_t p = view->facet_piece[f]; p < view->facet_piece[f + 1]; p++) {
            if (view->piece_cover[p] != -2) continue;
            sealed++;
            if (!check_seal(checker, p, f, crack)) return;
        }
    }
    checker->row->tested = (uint64_t)sealed;
    if (sealed != view->provenance->sealed)
        enf_check_break(checker, "%lld pieces are sealed, but %lld are reported", (long long)sealed,
                        (long long)view->provenance->sealed);
}

/// Which regions ought to be kept, as far as the options tell. False if they don't.
static bool expect_kept(const enf_file_view *view, bool *kept) {
    const char *options = view->strings + view->provenance->options, *found = strstr(options, "\"keep\"");
    if (!found) return false;
    found += strcspn(found, ":");
    found += strspn(found, ": \"");
    bool all = strncmp(found, "all", 3) == 0, outside = strncmp(found, "outside", 7) == 0,
         spawn = strncmp(found, "spawn", 5) == 0, any = false;
    if (!all && !outside && !spawn && strncmp(found, "auto", 4) != 0) return false;
    for (int32_t r = 0; r < view->region_count; r++) kept[r] = all;
    for (int32_t s = 0; s < view->spawn_count; s++) {
        if (view->spawns[s].fine_cell < 0) continue;
        kept[view->fine_region[view->spawns[s].fine_cell]] = true;
        any = true;
    }
    for (int kind = KIND_AIR; kind <= KIND_OUTSIDE && !all && !spawn; kind += KIND_OUTSIDE) {
        if (any && !(outside && kind == KIND_OUTSIDE)) continue;
        for (int32_t r = 0; r < view->region_count; r++) {
            if (view->regions[r].kind != kind) continue;
            kept[r] = true;
            any = true;
        }
    }
    return true;
}

static bool check_region(enf_checker *checker, int32_t r, bool open, const bool *kept) {
    const enf_file_region *region = &checker->view->regions[r];
    if ((region->touches_outside != 0) != open)
        return enf_check_break(checker, "region %d %s open to the outside, but is marked otherwise", (int)r,
                               open ? "is" : "is not");
    if (open ? region->kind == KIND_AIR : region->kind == KIND_OUTSIDE)
        return enf_check_break(checker, "region %d is marked as %s, but %s open to the outside", (int)r,
                               open ? "air" : "outside", open ? "is" : "is not");
    if (kept && (region->kept != 0) != kept[r])
        return enf_check_break(checker, "region %d should be %s by the rule it was compiled with", (int)r,
                               kept[r] ? "kept" : "discarded");
    return true;
}

static void check_kinds(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "colour: kinds",
                    "what is open to the outside, and what is kept, follows from the rules");
    bool *open = enf_array_zeroed((size_t)view->region_count, sizeof *open);
    bool *kept = enf_array_zeroed((size_t)view->region_count, sizeof *kept);
    bool good = (open && kept) || enf_check_no_memory(checker);
    for (int32_t p = 0; good && p < view->piece_count; p++) {
        const int32_t *fine = view->facet_fine[view->piece_facet[p]];
        if (!enf_check_is_open(view, p) || (fine[0] >= 0 && fine[1] >= 0)) continue;
        open[view->fine_region[fine[0] >= 0 ? fine[0] : fine[1]]] = true;
    }
    bool known = good && expect_kept(view, kept);
    for (int32_t r = 0; good && r < view->region_count; r++, checker->row->tested++)
        good = check_region(checker, r, open[r], known ? kept : NULL);
    free(open);
    free(kept);
}

/// Six times the volumes of the tetrahedra, rounded, grid steps cubed.
static double hull_volume(const enf_file_view *view) {
    double sum = 0;
    for (int32_t t = 0; t < view->tetrahedron_count; t++) {
        double e[3][3];
        for (int i = 0; i < 3; i++) {
            for (int k = 0; k < 3; k++)
                e[i][k] =
                    view->points[view->tetrahedra[t][i + 1]][k] - view->points[view->tetrahedra[t][0]][k];
        }
        sum += e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
               e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
               e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
    }
    return sum;
}

/// Area of a loop from rounded corners, grid steps squared; adds its outline's length to *length.
static double loop_area(const enf_checker *checker, const enf_check_loop *loop, double *length) {
    double sum[3] = {0, 0, 0}, unit = checker->exact.unit;
    const double *p = checker->exact.near[loop->corners[0].vertex];
    for (int32_t i = 0; i < loop->count; i++) {
        const double *q = checker->exact.near[loop->corners[i].vertex],
                     *r = checker->exact.near[loop->corners[i + 1 < loop->count ? i + 1 : 0].vertex];
        double square = 0;
        for (int k = 0; k < 3; k++) {
            int l = (k + 1) % 3, m = (k + 2) % 3;
            sum[k] += ((q[l] - p[l]) * (r[m] - p[m]) - (q[m] - p[m]) * (r[l] - p[l])) / 2;
            square += (q[k] - r[k]) * (q[k] - r[k]);
        }
        *length += sqrt(square) * unit;
    }
    return sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) * unit * unit;
}

/// What was discarded is reported with its volume. Rounded corners move each face by a grid step or two;
/// beyond that, the rounded volumes are right to nine digits.
static void check_volumes(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "colour: volumes",
                    "the regions' reported volumes add up to the hull's; discarded cells are counted");
    double step = view->frame->step, hull = hull_volume(view) / 6 * step * step * step, sum = 0;
    for (int32_t r = 0; r < view->region_count; r++, checker->row->tested++) sum += view->regions[r].volume;
    double area = 0, length = 0;
    for (int32_t f = 0; f < view->facet_count; f++) {
        enf_check_loop facet = enf_check_facet(checker, f);
        area += loop_area(checker, &facet, &length);
    }
    if (!(fabs(sum - hull) <= 1e-9 * hull + 4 * area * step * step * step)) // each facet bounds two cells
        enf_check_break(checker, "the regions' volumes add up to %.17g, the hull has %.17g", sum, hull);
    int64_t discarded = 0;
    for (int32_t c = 0; c < view->fine_count; c++) discarded += !view->regions[view->fine_region[c]].kept;
    if (discarded != view->provenance->fine_cells_discarded ||
        view->fine_count - discarded != view->provenance->fine_cells_active)
        enf_check_break(checker, "%lld fine cells are discarded, but %lld are reported", (long long)discarded,
                        (long long)view->provenance->fine_cells_discarded);
}

/// Fronts and backs around each region, by which it was judged. Rounded corners move each edge by a grid step
/// or two; beyond that, the areas are right to nine digits.
static void check_areas(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "colour: areas",
                    "the regions' reported areas of fronts and backs are those of their pieces");
    double(*sum)[2] = enf_array_zeroed((size_t)view->region_count, sizeof *sum), length = 0;
    double square = view->frame->step * view->frame->step;
    if (!sum) {
        enf_check_no_memory(checker);
        return;
    }
    for (int32_t p = 0; p < view->piece_count; p++) {
        int32_t cover = view->piece_cover[p];
        if (cover < 0) continue;
        enf_check_loop loop = enf_check_piece(checker, p, view->piece_facet[p]);
        double area = loop_area(checker, &loop, &length) * square;
        for (int side = 0; side < 2; side++) {
            int32_t fine = view->facet_fine[view->piece_facet[p]][side];
            if (fine >= 0) sum[view->fine_region[fine]][view->cover_side[cover] != side] += area;
        }
    }
    for (int32_t r = 0; r < view->region_count && enf_check_holds(checker); r++, checker->row->tested++) {
        double given[2] = {view->regions[r].front_area, view->regions[r].back_area};
        for (int back = 0; back < 2; back++) {
            if (fabs(sum[r][back] - given[back]) <= 1e-9 * given[back] + 2 * length * square) continue;
            enf_check_break(checker, "region %d has %s of area %.17g, reported %.17g", (int)r,
                            back ? "backs" : "fronts", sum[r][back], given[back]);
        }
    }
    free(sum);
}

static bool in_cell(enf_checker *checker, const double grid[3], int32_t cell) {
    const enf_file_view *view = checker->view;
    for (int32_t i = view->fine_facet[cell]; i < view->fine_facet[cell + 1]; i++) {
        int32_t f = view->fine_facets[i];
        int side = enf_check_side_of_place(&checker->exact, grid, view->facet_plane[f]);
        if (side == (enf_check_facet_side(checker, f, cell) ? -1 : 1)) return false;
    }
    return true;
}

static bool outside_hull(enf_checker *checker, const double grid[3]) {
    const enf_file_view *view = checker->view;
    for (int32_t f = 0; f < view->facet_count; f++) {
        if (view->facet_fine[f][0] >= 0 && view->facet_fine[f][1] >= 0) continue;
        int out = view->facet_fine[f][0] < 0 ? -1 : 1;
        if (enf_check_side_of_place(&checker->exact, grid, view->facet_plane[f]) == out) return true;
    }
    return false;
}

/// Spawn points count at the grid place next to them.
static bool check_spawn(enf_checker *checker, int32_t s) {
    const enf_file_view *view = checker->view;
    const enf_file_spawn *spawn = &view->spawns[s];
    double grid[3];
    enf_view_to_grid(view, spawn->position, grid);
    for (int a = 0; a < 3; a++) grid[a] = rint(grid[a]);
    if (spawn->fine_cell < 0) {
        if (spawn->cell < 0 && outside_hull(checker, grid)) return true;
        return enf_check_break(checker, "spawn %d lies in the hull, but has no fine cell", (int)s);
    }
    if (!in_cell(checker, grid, spawn->fine_cell))
        return enf_check_break(checker, "spawn %d does not lie in fine cell %d", (int)s,
                               (int)spawn->fine_cell);
    if (spawn->cell != view->fine_cell[spawn->fine_cell])
        return enf_check_break(checker, "spawn %d is in cell %d, not %d", (int)s,
                               (int)view->fine_cell[spawn->fine_cell], (int)spawn->cell);
    if (view->regions[view->fine_region[spawn->fine_cell]].kind == KIND_ROCK)
        return enf_check_break(checker, "spawn %d makes its region %d air, but it is marked as rock", (int)s,
                               (int)view->fine_region[spawn->fine_cell]);
    return true;
}

static void check_spawns(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "colour: spawns",
                    "every spawn point lies in the cell it names, and leaks are reported");
    bool leak = false;
    for (int32_t s = 0; s < view->spawn_count && check_spawn(checker, s); s++, checker->row->tested++) {
        int32_t cell = view->spawns[s].fine_cell;
        leak = leak || (cell >= 0 && view->regions[view->fine_region[cell]].touches_outside);
    }
    if (enf_check_holds(checker) && leak != (view->provenance->leak != 0))
        enf_check_break(checker, leak ? "a spawn's region is open to the outside, but no leak is reported"
                                      : "a leak is reported, but no spawn's region is open to the outside");
}

void enf_check_colour(enf_checker *checker) {
    check_regions(checker);
    check_seals(checker);
    check_kinds(checker);
    check_volumes(checker);
    check_areas(checker);
    check_spawns(checker);
}

// ---------------------------------------------------------------------------------------------- decimate

static void check_cells(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "decimate: cells",
                    "every kept fine cell is in exactly one cell of its region, no discarded one is");
    int32_t cells = 0;
    for (int32_t c = 0; c < view->fine_count; c++, checker->row->tested++) {
        int32_t cell = view->fine_cell[c], region = view->fine_region[c];
        if ((cell >= 0) != (view->regions[region].kept != 0)) {
            enf_check_break(checker, "fine cell %d of %s region %d is in cell %d", (int)c,
                            view->regions[region].kept ? "kept" : "discarded", (int)region, (int)cell);
            return;
        }
        if (cell < 0) continue;
        if (cell > cells || view->cells[cell].region != region) {
            enf_check_break(checker, "cell %d, of fine cell %d, is out of order or not of region %d",
                            (int)cell, (int)c, (int)region);
            return;
        }
        cells += cell == cells;
    }
    if (cells != view->cell_count)
        enf_check_break(checker, "%d cells are listed, but fine cells are in %d", (int)view->cell_count,
                        (int)cells);
}

static void check_connected(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "decimate: connected",
                    "every cell is connected through open pieces between its own fine cells");
    int32_t *parent = join_cells(checker, true),
            *first = enf_array_new((size_t)view->cell_count, sizeof *first);
    if (parent && !first) enf_check_no_memory(checker);
    if (parent && first) {
        for (int32_t i = 0; i < view->cell_count; i++) first[i] = -1;
        for (int32_t c = 0; c < view->fine_count; c++) {
            int32_t cell = view->fine_cell[c];
            if (cell < 0) continue;
            int32_t root = find_root(parent, c);
            if (first[cell] < 0) first[cell] = root;
            if (first[cell] == root) continue;
            enf_check_break(checker, "cell %d falls apart: fine cells %d and %d are not connected in it",
                            (int)cell, (int)first[cell], (int)c);
            break;
        }
        checker->row->tested = (uint64_t)view->cell_count;
    }
    free(parent);
    free(first);
}

static bool box_holds_facet(enf_checker *checker, int32_t fine, int32_t facet, double allowed) {
    const enf_file_view *view = checker->view;
    const enf_file_cell *cell = &view->cells[view->fine_cell[fine]];
    for (int64_t c = view->facet_offset[facet]; c < view->facet_offset[facet + 1]; c++) {
        double world[3];
        enf_view_to_world(view, view->vertex_position[view->facet_corners[c].vertex], world);
        for (int a = 0; a < 3; a++) {
            if (world[a] < cell->box_min[a] - allowed || world[a] > cell->box_max[a] + allowed)
                return enf_check_break(checker, "fine cell %d reaches out of the box of cell %d", (int)fine,
                                       (int)view->fine_cell[fine]);
        }
    }
    return true;
}

/// Boxes are rounded: 2^-48 of the world's size is allowed.
static void check_boxes(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "decimate: boxes", "every cell's box holds its fine cells");
    double allowed = 0x1p53 * view->frame->step * 0x1p-48;
    for (int32_t c = 0; c < view->fine_count; c++) {
        for (int32_t i = view->fine_facet[c]; i < view->fine_facet[c + 1] && view->fine_cell[c] >= 0; i++) {
            if (!box_holds_facet(checker, c, view->fine_facets[i], allowed)) return;
            checker->row->tested++;
        }
    }
}

/// Cells are measured from the same rounded corners as their regions, but in another order, and no volume is
/// reported as less than nothing: nine digits of the region's, twelve of the hull's, and a grid step or two
/// for each face.
static void check_cell_volumes(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "decimate: volumes",
                    "the reported volumes of a region's cells add up to the region's");
    double *sum = enf_array_zeroed((size_t)view->region_count, sizeof *sum);
    double *area = enf_array_zeroed((size_t)view->region_count, sizeof *area);
    if (!sum || !area) enf_check_no_memory(checker);
    double step = view->frame->step, hull = hull_volume(view) / 6 * step * step * step, length = 0;
    for (int32_t f = 0; f < view->facet_count && enf_check_holds(checker); f++) {
        enf_check_loop facet = enf_check_facet(checker, f);
        double size = loop_area(checker, &facet, &length);
        for (int side = 0; side < 2; side++) {
            int32_t cell = view->facet_fine[f][side];
            if (cell >= 0) area[view->fine_region[cell]] += size;
        }
    }
    for (int32_t i = 0; i < view->cell_count && enf_check_holds(checker); i++)
        sum[view->cells[i].region] += view->cells[i].volume;
    for (int32_t r = 0; r < view->region_count && enf_check_holds(checker); r++) {
        const enf_file_region *region = &view->regions[r];
        if (!region->kept) continue;
        checker->row->tested++;
        double allowed = 1e-9 * fabs(region->volume) + 1e-12 * hull + 2 * area[r] * step * step * step;
        if (!(fabs(sum[r] - region->volume) <= allowed))
            enf_check_break(checker, "the cells of region %d have a volume of %.17g, the region %.17g",
                            (int)r, sum[r], region->volume);
    }
    free(sum);
    free(area);
}

void enf_check_decimate(enf_checker *checker) {
    check_cells(checker);
    if (!enf_check_holds(checker)) return;
    check_connected(checker);
    check_boxes(checker);
    check_cell_volumes(checker);
}
