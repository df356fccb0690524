// SPDX-License-Identifier: GPL-3.0-or-later
#include "check_breakers.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/// The world's arrays may be written to: they are in w->bytes.
#define WRITABLE(pointer) ((void *)(uintptr_t)(const void *)(pointer))

static bool damage_bytes(world *w, int index) {
    ((double *)WRITABLE(w->view.vertex_position))[0] += 1;
    return index == 0;
}

static bool unwhole_point(world *w, int index) {
    ((double *)WRITABLE(w->view.points))[0] = 0.5;
    return index == 0;
}

static bool flatten_plane(world *w, int index) {
    int32_t(*planes)[3] = WRITABLE(w->view.planes);
    planes[0][2] = planes[0][1];
    return index == 0;
}

static bool lose_crossing(world *w, int index) {
    int32_t(*planes)[3] = WRITABLE(w->view.vertex_planes);
    assert(w->view.vertex_count > w->view.point_count);
    planes[w->view.vertex_count - 1][2] = planes[w->view.vertex_count - 1][1];
    return index == 0;
}

static bool move_rounded_vertex(world *w, int index) {
    double(*at)[3] = WRITABLE(w->view.vertex_position);
    double *x = &at[w->view.vertex_count - 1][0];
    *x += 2 + 0x1p-49 * fabs(*x);
    return index == 0;
}

static bool shrink_box(world *w, int index) {
    enf_file_box *boxes = WRITABLE(w->view.boxes);
    enf_file_box *box = &boxes[w->view.box_count - 1];
    box->max[1] = box->min[1];
    return index == 0;
}

static bool lose_box(world *w, int index) {
    enf_file_box *boxes = WRITABLE(w->view.boxes);
    boxes[w->view.box_count - 1].tetrahedron = -1;
    return index == 0;
}

static bool move_wall(world *w, int index) {
    double(*vertices)[3] = WRITABLE(w->view.barrier_vertices);
    int32_t wall = 0;
    while (w->view.barriers[wall].kind != ENF_FILE_BARRIER_WALL) wall++;
    vertices[w->view.barriers[wall].vertex_first][1] += 1;
    return index == 0;
}

static bool shrink_wall_box(world *w, int index) {
    enf_file_barrier_node *nodes = WRITABLE(w->view.wall_nodes);
    float *low = &nodes[w->view.wall_node_count - 1].bound[2][0][0];
    *low = nodes[w->view.wall_node_count - 1].bound[2][1][0];
    return index == 0;
}

static bool lose_barrier(world *w, int index) {
    enf_file_barrier_node *nodes = WRITABLE(w->view.portal_nodes);
    nodes[w->view.portal_node_count - 1].child[0] = -1;
    return index == 0;
}

static bool turn_polygon_corners(world *w, int index) {
    int32_t *corner = WRITABLE(w->view.mesh_corners), swap = corner[0];
    corner[0] = corner[1];
    corner[1] = swap;
    return index == 0;
}

static bool miss_polygon(world *w, int index) {
    enf_file_provenance *made = WRITABLE(w->view.provenance);
    made->input_polygons++;
    return index == 0;
}

static bool turn_tetrahedron(world *w, int index) {
    int32_t *corner = ((int32_t(*)[4])WRITABLE(w->view.tetrahedra))[3], swap = corner[0];
    corner[0] = corner[1];
    corner[1] = swap;
    return index == 0;
}

static bool lose_neighbour(world *w, int index) {
    int32_t(*next)[4] = WRITABLE(w->view.tetrahedron_next);
    int k = 0;
    while (next[5][k] < 0) k++;
    next[5][k] = -1;
    return index == 0;
}

static bool repeat_tetrahedron(world *w, int index) {
    int32_t(*corner)[4] = WRITABLE(w->view.tetrahedra);
    memcpy(corner[1], corner[0], sizeof corner[0]);
    return index == 0;
}

/// A point pressed in or pulled out until the hull is not convex any more, but every tetrahedron stays as it
/// turns.
static bool dent_hull(world *w, int index) {
    static const double steps[4] = {1, -1, 0x1p40, -0x1p40};
    if (index >= 12 * w->view.point_count) return false;
    double(*points)[3] = WRITABLE(w->view.points);
    points[index / 12][index % 3] += steps[index / 3 % 4];
    return true;
}

static bool turn_facet_corners(world *w, int index) {
    enf_file_corner *corner = WRITABLE(w->view.facet_corners), swap = corner[0];
    corner[0] = corner[1];
    corner[1] = swap;
    return index == 0;
}

/// A facet gets the same cell on both sides, or goes over to the cell behind it.
static bool fold_facet(world *w, int index) {
    int32_t(*fine)[2] = WRITABLE(w->view.facet_fine);
    fine[0][0] = fine[0][1];
    return index == 0;
}

static bool lose_facet(world *w, int index) {
    int32_t *first = WRITABLE(w->view.fine_facet);
    first[1]--; // the last facet of cell 0 goes to cell 1
    return index == 0;
}

static bool unlist_facet(world *w, int index) {
    int32_t *list = WRITABLE(w->view.fine_facets);
    list[1] = list[0];
    return index == 0;
}

/// The cells on both sides of a facet change places.
static bool turn_facet(world *w, int index) {
    int32_t(*fine)[2] = WRITABLE(w->view.facet_fine), f = 0;
    while (fine[f][0] < 0 || fine[f][1] < 0) f++;
    int32_t swap = fine[f][0];
    fine[f][0] = fine[f][1];
    fine[f][1] = swap;
    return index == 0;
}

/// A facet becomes another one in its plane, of the same cell: it has a hole, and another part twice.
static bool repeat_facet(world *w, int index) {
    const enf_file_view *view = &w->view;
    enf_file_corner *corner = WRITABLE(view->facet_corners);
    int found = 0;
    for (int32_t f = 0; f + 1 < view->facet_count; f++) {
        for (int32_t g = 0; g < view->facet_count; g++) {
            int64_t a = view->facet_offset[f], end = view->facet_offset[f + 1], b = view->facet_offset[g];
            bool alike = f != g && view->facet_plane[f] == view->facet_plane[g] &&
                         view->facet_offset[g + 1] - b == end - a;
            if (!alike || found++ < index) continue;
            memcpy(corner + a, corner + b, (size_t)(end - a) * sizeof *corner);
            return true;
        }
    }
    return false;
}

/// A section loses its last elements.
static void shorten(world *w, const void *array, int64_t elements) {
    enf_file_section *sections = WRITABLE(w->view.sections);
    for (uint32_t s = 0; s < w->view.header->section_count; s++) {
        if (w->view.bytes + sections[s].offset != array) continue;
        sections[s].count -= (uint64_t)elements;
        sections[s].size -= (uint64_t)elements * sections[s].element_size;
    }
}

static int32_t without(int32_t cell, int32_t gone, int32_t instead) {
    return cell == gone ? instead : cell - (cell > gone);
}

/// A fine cell disappears, as if the world had a bubble: the facets around it face the outside.
static bool drop_cell(world *w, int index) {
    const enf_file_view *view = &w->view;
    int32_t(*fine)[2] = WRITABLE(view->facet_fine), *first = WRITABLE(view->fine_facet);
    int32_t *list = WRITABLE(view->fine_facets), *root = WRITABLE(view->tetrahedron_root);
    int32_t(*child)[2] = WRITABLE(view->node_child), *region = WRITABLE(view->fine_region);
    int32_t *cell = WRITABLE(view->fine_cell), *seen = WRITABLE(view->seen);
    int32_t *seen_first = WRITABLE(view->seen_offset);
    enf_file_spawn *spawns = WRITABLE(view->spawns);
    int32_t count = view->fine_count, facets = first[index + 1] - first[index];
    int32_t sights = seen_first[index + 1] - seen_first[index];
    if (index >= count - 1) return false;
    for (int32_t i = first[index]; i < view->fine_facet_count - facets; i++) list[i] = list[i + facets];
    for (int64_t i = seen_first[index]; i < view->seen_count - sights; i++) seen[i] = seen[i + sights];
    for (int32_t c = index + 1; c < count; c++) {
        first[c] = first[c + 1] - facets;
        seen_first[c] = seen_first[c + 1] - sights;
        region[c - 1] = region[c];
        cell[c - 1] = cell[c];
    }
    for (int32_t i = 0; i < 2 * view->facet_count; i++)
        fine[i / 2][i % 2] = without(fine[i / 2][i % 2], index, -1);
    for (int32_t t = 0; t < view->tetrahedron_count; t++) {
        if (root[t] < 0) root[t] = -1 - without(-1 - root[t], index, 0);
    }
    for (int32_t i = 0; i < 2 * view->node_count; i++) {
        int32_t *at = &child[i / 2][i % 2];
        if (*at < 0) *at = -1 - without(-1 - *at, index, 0);
    }
    for (int32_t s = 0; s < view->spawn_count; s++)
        spawns[s].fine_cell = without(spawns[s].fine_cell, index, -1);
    shorten(w, list, facets);
    shorten(w, seen, sights);
    shorten(w, first, 1);
    shorten(w, seen_first, 1);
    shorten(w, region, 1);
    shorten(w, cell, 1);
    return true;
}

static bool swap_children(world *w, int index) {
    int32_t *child = ((int32_t(*)[2])WRITABLE(w->view.node_child))[0], swap = child[0];
    child[0] = child[1];
    child[1] = swap;
    return index == 0;
}

/// Leaves of one tetrahedron, or of two, change places.
static bool swap_leaves(world *w, int index) {
    int32_t *root = WRITABLE(w->view.tetrahedron_root), (*child)[2] = WRITABLE(w->view.node_child);
    int32_t a = 0, b = 0;
    while (root[a] >= 0) a++;
    while (child[b][0] >= 0) b++;
    int32_t *other = index == 0 ? &child[b][0] : &root[a + 1], swap = *other;
    *other = root[a];
    root[a] = swap;
    return index < 2;
}

/// A cell has no leaf any more.
static bool lose_leaf(world *w, int index) {
    int32_t *root = WRITABLE(w->view.tetrahedron_root), a = 0;
    while (root[a] >= 0 || root[a + 1] >= 0) a++;
    root[a] = root[a + 1];
    return index == 0;
}

static bool turn_cover(world *w, int index) {
    uint8_t *side = WRITABLE(w->view.cover_side);
    side[0] ^= 1;
    return index == 0;
}

/// A cover is put onto another facet of the same tetrahedron, or of the next.
static bool move_cover(world *w, int index) {
    int32_t *facet_cover = WRITABLE(w->view.facet_cover);
    int32_t f = index;
    if (f + 1 >= w->view.facet_count) return false;
    if (facet_cover[f + 1] == facet_cover[f]) return move_cover(w, index + 1);
    facet_cover[f + 1]--;
    return true;
}

/// A triangle takes another one's place in the same plane.
static bool move_polygon(world *w, int index) {
    const enf_file_view *view = &w->view;
    int32_t *corner = WRITABLE(view->mesh_corners), (*plane)[3] = WRITABLE(view->mesh_polygon_plane);
    int32_t a = index / view->mesh_polygon_count, b = index % view->mesh_polygon_count;
    if (a >= view->mesh_polygon_count) return false;
    const int64_t *first = view->mesh_polygon_corner;
    if (first[a + 1] - first[a] != first[b + 1] - first[b]) return true;
    memcpy(corner + first[a], corner + first[b], (size_t)(first[b + 1] - first[b]) * sizeof *corner);
    memcpy(plane[a], plane[b], sizeof plane[a]);
    return true;
}

static bool move_piece(world *w, int index) {
    int32_t *facet = WRITABLE(w->view.piece_facet);
    facet[w->view.piece_count - 1]--;
    return index == 0;
}

static bool turn_piece_corners(world *w, int index) {
    enf_file_corner *corner = WRITABLE(w->view.piece_corners), swap = corner[0];
    corner[0] = corner[1];
    corner[1] = swap;
    return index == 0;
}

/// Two pieces of a facet become the same: one area twice, another not at all.
static bool repeat_piece(world *w, int index) {
    const enf_file_view *view = &w->view;
    enf_file_corner *corner = WRITABLE(view->piece_corners);
    int found = 0;
    for (int32_t f = 0; f < view->facet_count; f++) {
        for (int32_t p = view->facet_piece[f]; p + 1 < view->facet_piece[f + 1]; p++) {
            int64_t a = view->piece_offset[p], b = view->piece_offset[p + 1], end = view->piece_offset[p + 2];
            if (b - a != end - b || found++ < index) continue;
            memcpy(corner + a, corner + b, (size_t)(end - b) * sizeof *corner);
            return true;
        }
    }
    return false;
}

static bool open_piece(world *w, int index) {
    int32_t *cover = WRITABLE(w->view.piece_cover), p = 0;
    while (cover[p] < 0) p++;
    cover[p] = -1;
    return index == 0;
}

static bool occlude_piece(world *w, int index) {
    int32_t *cover = WRITABLE(w->view.piece_cover), p = 0;
    while (cover[p] >= 0) p++;
    cover[p] = 0;
    return index == 0;
}

static bool recolour_cell(world *w, int index) {
    int32_t *region = WRITABLE(w->view.fine_region);
    region[w->view.fine_count - 1] = region[w->view.fine_count - 1] ? 0 : 1;
    return index == 0;
}

static bool seal_piece(world *w, int index) {
    int32_t *cover = WRITABLE(w->view.piece_cover);
    if (index >= w->view.piece_count) return false;
    if (cover[index] == -1) cover[index] = -2;
    return true;
}

static bool count_more_seals(world *w, int index) {
    enf_file_provenance *made = WRITABLE(w->view.provenance);
    made->sealed++;
    return index == 0;
}

static bool open_region(world *w, int index) {
    enf_file_region *regions = WRITABLE(w->view.regions);
    regions[0].touches_outside ^= 1;
    return index == 0;
}

static bool keep_other_region(world *w, int index) {
    enf_file_region *regions = WRITABLE(w->view.regions);
    if (index >= w->view.region_count) return false;
    regions[index].kept ^= 1;
    return true;
}

static bool change_volume(world *w, int index) {
    enf_file_region *regions = WRITABLE(w->view.regions);
    regions[0].volume *= 1.001;
    return index == 0;
}

static bool change_area(world *w, int index) {
    enf_file_region *regions = WRITABLE(w->view.regions);
    double swap = regions[0].front_area;
    regions[0].front_area = regions[0].back_area;
    regions[0].back_area = swap;
    return index == 0;
}

static bool count_fewer_discarded(world *w, int index) {
    enf_file_provenance *made = WRITABLE(w->view.provenance);
    made->fine_cells_discarded--;
    return index == 0;
}

static bool move_spawn(world *w, int index) {
    enf_file_spawn *spawns = WRITABLE(w->view.spawns);
    spawns[0].position[0] += w->view.frame->box_max[0] - w->view.frame->box_min[0];
    return index == 0;
}

static bool report_leak(world *w, int index) {
    enf_file_provenance *made = WRITABLE(w->view.provenance);
    made->leak ^= 1;
    return index == 0;
}

static bool discard_fine_cell(world *w, int index) {
    int32_t *cell = WRITABLE(w->view.fine_cell), c = w->view.fine_count - 1;
    while (cell[c] < 0) c--;
    cell[c] = -1;
    return index == 0;
}

/// A fine cell goes over to another cell. Where it is not joined to that, the cell falls apart; where it is,
/// a portal moves.
static bool move_fine_cell(world *w, int index) {
    const enf_file_view *view = &w->view;
    int32_t *cell = WRITABLE(view->fine_cell), c = index / view->cell_count, to = index % view->cell_count;
    enf_file_cell *cells = WRITABLE(view->cells);
    if (c >= view->fine_count) return false;
    if (cell[c] < 0) return true;
    cell[c] = to;
    for (int a = 0; a < 3; a++) { // so that its box still holds it
        cells[to].box_min[a] = view->frame->box_min[a];
        cells[to].box_max[a] = view->frame->box_max[a];
    }
    return true;
}

static bool shrink_cell_box(world *w, int index) {
    enf_file_cell *cells = WRITABLE(w->view.cells);
    cells[0].box_max[2] = (cells[0].box_min[2] + cells[0].box_max[2]) / 2;
    return index == 0;
}

static bool change_cell_volume(world *w, int index) {
    enf_file_cell *cells = WRITABLE(w->view.cells);
    cells[0].volume *= 0.99;
    return index == 0;
}

static bool see_other_polygon(world *w, int index) {
    int32_t *seen = WRITABLE(w->view.seen);
    if (index >= w->view.mesh_polygon_count) return false;
    seen[0] = index;
    return true;
}

static bool see_one_less(world *w, int index) {
    int32_t *offset = WRITABLE(w->view.seen_offset);
    int32_t c = 1;
    while (offset[c] == offset[c - 1]) c++;
    offset[c]--;
    return index == 0;
}

static bool draw_other_triangle(world *w, int index) {
    int32_t *list = WRITABLE(w->view.cell_triangles);
    if (index >= w->view.triangle_count) return false;
    list[0] = index;
    return true;
}

static bool draw_one_less(world *w, int index) {
    enf_file_cell *cells = WRITABLE(w->view.cells);
    cells[0].triangle_count--;
    return index == 0;
}

static bool change_twin(world *w, int index) {
    enf_file_portal *portals = WRITABLE(w->view.portals);
    portals[1].radius *= 2;
    return index == 0;
}

static bool swap_listed_portals(world *w, int index) {
    int32_t *list = WRITABLE(w->view.cell_portals);
    int32_t c = 0;
    while (w->view.cells[c].portal_count < 2) c++;
    list += w->view.cells[c].portal_first;
    int32_t swap = list[0];
    list[0] = list[1];
    list[1] = swap;
    return index == 0;
}

static bool turn_portal_loop(world *w, int index) {
    uint8_t *side = WRITABLE(w->view.portal_loop_side);
    side[0] ^= 1;
    return index == 0;
}

static bool move_portal_corner(world *w, int index) {
    const enf_file_view *view = &w->view;
    double(*at)[3] = WRITABLE(view->portal_vertices);
    double from[3];
    memcpy(from, at[0], sizeof from);
    for (int32_t v = 0; v < view->portal_vertex_count; v++) { // wherever it is used, so that twins agree
        if (memcmp(at[v], from, sizeof from) == 0)
            at[v][0] += 1e-3 * (view->frame->box_max[0] - view->frame->box_min[0]);
    }
    return index == 0;
}

static bool shrink_sphere(world *w, int index) {
    enf_file_portal *portals = WRITABLE(w->view.portals);
    portals[0].radius *= 0.9;
    portals[1].radius *= 0.9;
    return index == 0;
}

const check_kind check_kinds[] = {
    {"file: checksums", damage_bytes},
    {"file: numbers", unwhole_point},
    {"file: numbers", flatten_plane},
    {"file: numbers", lose_crossing},
    {"file: positions", move_rounded_vertex},
    {"file: location", shrink_box},
    {"file: location", lose_box},
    {"file: sight", move_wall},
    {"file: sight", shrink_wall_box},
    {"file: sight", lose_barrier},
    {"clean: polygons", turn_polygon_corners},
    {"clean: accounting", miss_polygon},
    {"tetrahedralize: orientation", turn_tetrahedron},
    {"tetrahedralize: faces", lose_neighbour},
    {"tetrahedralize: faces", repeat_tetrahedron},
    {"tetrahedralize: hull", dent_hull},
    {"split: facets", turn_facet_corners},
    {"split: facets", fold_facet},
    {"split: facets", lose_facet},
    {"split: facets", unlist_facet},
    {"split: cells", turn_facet},
    {"split: cells", repeat_facet},
    {"split: hull", drop_cell},
    {"split: trees", swap_children},
    {"split: trees", swap_leaves},
    {"split: trees", lose_leaf},
    {"split: covers", turn_cover},
    {"split: covers", move_cover},
    {"split: polygons", move_polygon},
    {"connect: pieces", move_piece},
    {"connect: pieces", turn_piece_corners},
    {"connect: areas", repeat_piece},
    {"connect: occlusion", open_piece},
    {"connect: occlusion", occlude_piece},
    {"connect: seen", see_other_polygon},
    {"connect: seen", see_one_less},
    {"colour: regions", recolour_cell},
    {"colour: seals", seal_piece},
    {"colour: seals", count_more_seals},
    {"colour: kinds", open_region},
    {"colour: kinds", keep_other_region},
    {"colour: volumes", change_volume},
    {"colour: volumes", count_fewer_discarded},
    {"colour: areas", change_area},
    {"colour: spawns", move_spawn},
    {"colour: spawns", report_leak},
    {"decimate: cells", discard_fine_cell},
    {"decimate: connected", move_fine_cell},
    {"decimate: boxes", shrink_cell_box},
    {"decimate: volumes", change_cell_volume},
    {"decimate: triangles", draw_other_triangle},
    {"decimate: triangles", draw_one_less},
    {"portals: pairs", change_twin},
    {"portals: lists", swap_listed_portals},
    {"portals: polygons", turn_portal_loop},
    {"portals: polygons", move_portal_corner},
    {"portals: spheres", shrink_sphere},
    {"portals: openings", move_fine_cell},
};

const int check_kind_count = sizeof check_kinds / sizeof *check_kinds;
