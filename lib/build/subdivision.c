// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/subdivision.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

void enf_subdivision_free(enf_subdivision *s) {
    void *arrays[] = {
        s->halves,      s->facets,     s->edge_half,        s->edge_slot,          s->cell_facet,
        s->cell_parent, s->cell_state, s->shares,           s->cut_edges,          s->vertex_sign,
        s->outline,     s->outline_at, s->touching,         s->geometry.crossings, s->node_plane,
        s->node_child,  s->pairing,    s->tetrahedron_root, s->geometry.kept};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) free(arrays[i]);
    memset(s, 0, sizeof *s);
}

void enf_subdivision_forget_facets(enf_subdivision *s) {
    free(s->halves);
    free(s->facets);
    free(s->edge_half);
    free(s->edge_slot);
    s->halves = NULL;
    s->facets = NULL;
    s->edge_half = s->edge_slot = NULL;
    s->half_capacity = s->facet_capacity = s->edge_capacity = s->slot_capacity = 0;
}

// ---------------------------------------------------------------------------------------------- numbers

static int32_t new_half(enf_subdivision *s) {
    int32_t half = s->free_half;
    if (half >= 0) {
        s->free_half = s->halves[half].next;
        return half;
    }
    if (!enf_array_reserve(s->halves, s->half_capacity, s->half_count + 1)) return -1;
    return (int32_t)s->half_count++;
}

static int32_t new_facet(enf_subdivision *s) {
    int32_t facet = s->free_facet;
    if (facet >= 0) {
        s->free_facet = s->facets[facet].source;
        return facet;
    }
    if (!enf_array_reserve(s->facets, s->facet_capacity, s->facet_count + 1)) return -1;
    return (int32_t)s->facet_count++;
}

static int32_t new_edge(enf_subdivision *s) {
    int32_t edge = s->free_edge;
    if (edge >= 0) {
        s->free_edge = s->edge_half[edge];
    } else {
        if (!enf_array_reserve(s->edge_half, s->edge_capacity, s->edge_count + 1)) return -1;
        edge = (int32_t)s->edge_count++;
    }
    s->edge_half[edge] = 0;
    return edge;
}

/// Puts a half at the head of the list at its edge.
static void list_half(enf_subdivision *s, int32_t h) {
    enf_half *half = &s->halves[h];
    int32_t *head = &s->edge_half[half->edge];
    half->radial = *head;
    half->before = 0;
    s->halves[*head].before = h;
    *head = h;
}

/// Takes a facet's halves out of the lists at their edges. Without branches: where in them they are is
/// chance.
static void remove_halves(enf_subdivision *s, int32_t first) {
    enf_half *halves = s->halves;
    int32_t h = first, last, free_edge = s->free_edge;
    do {
        int32_t edge = halves[h].edge, before = halves[h].before, after = halves[h].radial;
        int32_t is_first = -(before == 0), is_only = -((before | after) == 0); // all bits or none
        halves[after].before = before;
        halves[before].radial = after;
        int32_t head = (s->edge_half[edge] & ~is_first) | (after & is_first);
        s->edge_half[edge] = (head & ~is_only) | (free_edge & is_only);
        free_edge = (free_edge & ~is_only) | (edge & is_only);
        last = h;
        h = halves[h].next;
    } while (h != first);
    s->free_edge = free_edge;
    s->halves[last].next = s->free_half;
    s->free_half = first;
}

void enf_subdivision_remove(enf_subdivision *s, int32_t f) {
    remove_halves(s, s->facets[f].first);
    s->facets[f].first = -1;
    s->facets[f].source = s->free_facet;
    s->free_facet = f;
}

// ---------------------------------------------------------------------------------------------- setting out

void enf_subdivision_triangle(const enf_tet_mesh *tets, int32_t facet, int32_t corner[3],
                              int32_t edge_plane[3]) {
    const int32_t *sides = tets->facet_sides[facet];
    int32_t t = sides[0] >= 0 ? sides[0] : sides[1];
    for (int i = 0; i < 3; i++) {
        // The edge to the next corner lies on the face opposite the third one.
        int32_t third = tets->facet_corners[facet][(i + 2) % 3];
        int opposite = enf_tetrahedron_place(tets->corners[t], third);
        corner[i] = tets->facet_corners[facet][i];
        edge_plane[i] = tets->facets[t][opposite];
    }
}

/// What a facet has on one side.
static int32_t side_cell(const enf_tet_part *part, int32_t tetrahedron) {
    if (tetrahedron < 0) return -1;
    int32_t cell = part->cell_of[tetrahedron];
    return cell < 0 ? -2 - tetrahedron : cell;
}

/// A facet of the tetrahedra, with three halves; edges come later.
static void add_tetrahedron_facet(enf_subdivision *s, const enf_tet_mesh *tets, const enf_tet_part *part,
                                  int32_t source) {
    int32_t added = (int32_t)s->facet_count++, first = (int32_t)s->half_count, corner[3], edge_plane[3];
    s->facets[added] = (enf_share){.source = source, .next = {-1, -1}, .first = first, .cover = -1};
    for (int side = 0; side < 2; side++) {
        int32_t cell = s->facets[added].cell[side] = side_cell(part, tets->facet_sides[source][side]);
        if (cell < 0) continue;
        s->facets[added].next[side] = s->cell_facet[cell];
        s->cell_facet[cell] = added;
    }
    enf_subdivision_triangle(tets, source, corner, edge_plane);
    for (int i = 0; i < 3; i++) {
        s->halves[s->half_count++] = (enf_half){
            .vertex = corner[i], .next = first + (i + 1) % 3, .edge_plane = edge_plane[i], .facet = added};
    }
}

/// The edges of the halves that `first` begins, which have their lower vertex in common; they are told apart
/// by the higher one.
static void pair_list(enf_subdivision *s, int32_t first, int32_t low) {
    s->pairing_mark++;
    for (int32_t h = first, next; h >= 0; h = next) {
        enf_half *half = &s->halves[h];
        next = half->radial;
        int32_t to = s->halves[half->next].vertex;
        struct enf_pairing *high = &s->pairing[half->vertex == low ? to : half->vertex];
        if (high->mark != s->pairing_mark) {
            high->mark = s->pairing_mark;
            high->edge = (int32_t)s->edge_count++;
            s->edge_half[high->edge] = 0;
        }
        half->edge = high->edge;
        list_half(s, h);
    }
}

/// Gives halves between the same two vertices the same edge. Halves are first listed by their lower vertex
/// (through `radial`), then list by list.
static void pair_halves(enf_subdivision *s) {
    for (size_t h = s->half_count; h-- > 1;) {
        int32_t from = s->halves[h].vertex, to = s->halves[s->halves[h].next].vertex;
        struct enf_pairing *low = &s->pairing[from < to ? from : to];
        s->halves[h].radial = low->half;
        low->half = (int32_t)h;
    }
    for (size_t h = 1; h < s->half_count; h++) {
        int32_t from = s->halves[h].vertex, to = s->halves[s->halves[h].next].vertex;
        int32_t low = from < to ? from : to, first = s->pairing[low].half;
        s->pairing[low].half = -1;
        if (first >= 0) pair_list(s, first, low);
    }
}

/// Room for a pairing of each point, no half listed.
static bool reserve_pairing(enf_subdivision *s, size_t points) {
    size_t known = s->pairing_capacity;
    if (!enf_array_reserve(s->pairing, s->pairing_capacity, points)) return false;
    for (; known < s->pairing_capacity; known++) s->pairing[known] = (struct enf_pairing){.half = -1};
    return true;
}

/// Vertices are new, but what is marked with the number of a plane or pairing is told from older marks.
static bool reserve_vertices(enf_subdivision *s, size_t count) {
    size_t known = s->sign_capacity;
    if (!enf_array_reserve(s->vertex_sign, s->sign_capacity, count) ||
        !enf_array_reserve(s->outline_at, s->outline_at_capacity, count)) {
        return false;
    }
    if (s->sign_capacity > known)
        memset(s->vertex_sign + known, 0, (s->sign_capacity - known) * sizeof *s->vertex_sign);
    return true;
}

/// The geometry without the crossings of others.
static void take_geometry(enf_subdivision *s, const enf_geometry *geometry) {
    enf_crossing *crossings = s->geometry.crossings;
    enf_kept_filters *kept = s->geometry.kept;
    size_t capacity = s->geometry.crossing_capacity;
    s->geometry = *geometry;
    s->geometry.kept = kept;
    s->geometry.crossings = crossings;
    s->geometry.crossing_capacity = capacity;
    s->geometry.crossing_count = 0;
    memset(s->geometry.decided, 0, sizeof s->geometry.decided);
    memset(kept->side, 0, sizeof kept->side); // so that the counts do not depend on who cuts which part
}

bool enf_subdivision_start(enf_subdivision *s, const enf_geometry *geometry, const enf_tet_mesh *tets,
                           const enf_tet_part *part, size_t cuts) {
    size_t facets = (size_t)part->facet_count, count = (size_t)part->tetrahedron_count;
    size_t points = (size_t)geometry->point_count;
    // Shares of what may cut: at most 0.77 and 0.69 were seen, and these arrays can grow. Halves, facets
    // and edges of the tetrahedra are filled in below without a look: three of a facet, each its own edge at
    // worst.
    size_t nodes = cuts * 4 / 5, crossings = cuts * 7 / 10;
    if (!s->geometry.kept) s->geometry.kept = enf_array_zeroed(1, sizeof *s->geometry.kept);
    if (!s->geometry.kept) return false;
    take_geometry(s, geometry);
    s->facet_count = s->edge_count = s->node_count = 0;
    s->half_count = 1;
    s->free_half = s->free_facet = s->free_edge = -1;
    s->cell_count = count;
    s->tetrahedron_count = part->tetrahedron_count;
    s->tetrahedron_planes = tets->facet_count;
    if (!enf_array_reserve(s->tetrahedron_root, s->root_capacity, count + 1) ||
        !enf_array_reserve(s->halves, s->half_capacity, 3 * facets + 1) ||
        !enf_array_reserve(s->facets, s->facet_capacity, facets + 1) ||
        !enf_array_reserve(s->edge_half, s->edge_capacity, 3 * facets + 1) ||
        !enf_array_reserve(s->cell_facet, s->cell_capacity, count + cuts + 1) ||
        !enf_array_reserve(s->cell_parent, s->parent_capacity, count + cuts + 1) ||
        !enf_array_reserve(s->cell_state, s->state_capacity, count + cuts + 1) ||
        !enf_array_reserve(s->node_plane, s->node_capacity, nodes) ||
        !enf_array_reserve(s->node_child, s->child_capacity, nodes) ||
        !enf_array_reserve(s->geometry.crossings, s->geometry.crossing_capacity, crossings + 1) ||
        !reserve_vertices(s, points + crossings + 1) || !reserve_pairing(s, points)) {
        return false;
    }
    for (int32_t c = 0; c < part->tetrahedron_count; c++) {
        s->tetrahedron_root[c] = s->cell_parent[c] = -1 - c;
        s->cell_state[c] = ENF_CELL_WAITS;
        s->cell_facet[c] = -1;
    }
    for (int32_t i = 0; i < part->facet_count; i++) add_tetrahedron_facet(s, tets, part, part->facets[i]);
    pair_halves(s);
    return true;
}

// ---------------------------------------------------------------------------------------------- looking

void enf_subdivision_take_plane(enf_subdivision *s, int32_t plane) {
    s->plane = plane;
    s->plane_mark++;
    enf_plane_filter room;
    s->filter = *enf_geometry_filter(&s->geometry, plane, &room);
}

static bool note_cut_edge(enf_subdivision *s, int32_t half, int32_t from, int32_t to) {
    int32_t edge = s->halves[half].edge, slot = s->edge_slot[edge];
    if ((size_t)slot < s->cut_edge_count && s->cut_edges[slot].edge == edge) return true;
    if (!enf_array_reserve(s->cut_edges, s->cut_edge_capacity, s->cut_edge_count + 1)) return false;
    s->edge_slot[edge] = (int32_t)s->cut_edge_count;
    s->cut_edges[s->cut_edge_count++] = (enf_cut_edge){from, to, half, edge, -1};
    return true;
}

int enf_subdivision_crosses(enf_subdivision *s, int32_t cell) {
    bool behind = false, front = false;
    s->share_count = s->cut_edge_count = s->touching_count = 0;
    if (s->edge_capacity > s->slot_capacity) { // what it held is not needed any more
        free(s->edge_slot);
        s->edge_slot = enf_array_zeroed(s->edge_capacity, sizeof *s->edge_slot);
        s->slot_capacity = s->edge_slot ? s->edge_capacity : 0;
        if (!s->edge_slot) return -1;
    }
    for (int32_t f = s->cell_facet[cell], next; f >= 0; f = next) {
        const enf_share *facet = &s->facets[f];
        next = facet->next[facet->cell[1] == cell];
        if (!enf_array_reserve(s->shares, s->share_capacity, s->share_count + 1)) return -1;
        enf_beside *beside = &s->shares[s->share_count++];
        *beside = (enf_beside){.facet = f};
        int32_t h = facet->first, from = s->halves[h].vertex;
        int sign = enf_subdivision_sign(s, from);
        do {
            beside->behind |= sign < 0;
            beside->front |= sign > 0;
            int32_t after = s->halves[h].next, to = s->halves[after].vertex;
            int sign_to = enf_subdivision_sign(s, to);
            if (sign * sign_to < 0 && !note_cut_edge(s, h, from, to)) return -1;
            if (!enf_array_reserve(s->touching, s->touching_capacity, s->touching_count + 1)) return -1;
            beside->along |= (sign == 0) & (sign_to == 0);
            s->touching[s->touching_count] = from; // counted where it belongs there: nobody can guess
            s->touching_count += sign == 0;
            h = after;
            from = to;
            sign = sign_to;
        } while (h != facet->first);
        behind |= beside->behind;
        front |= beside->front;
    }
    return behind && front;
}

int32_t enf_subdivision_cut_vertex(enf_subdivision *s, size_t i) {
    enf_cut_edge *cut = &s->cut_edges[i];
    if (cut->vertex >= 0) return cut->vertex;
    enf_geometry *geometry = &s->geometry;
    const enf_half *half = &s->halves[cut->half];
    size_t vertices = (size_t)geometry->point_count + (size_t)geometry->crossing_count + 1;
    if (!enf_array_reserve(s->vertex_sign, s->sign_capacity, vertices) ||
        !enf_array_reserve(s->outline_at, s->outline_at_capacity, vertices)) {
        return -1;
    }
    cut->vertex =
        enf_geometry_cross(geometry, enf_subdivision_plane(s, half->facet), half->edge_plane, s->plane);
    if (cut->vertex >= 0) s->vertex_sign[cut->vertex] = s->plane_mark * 4 + 1;
    return cut->vertex;
}

void enf_subdivision_leave(enf_subdivision *s) {
    int32_t first = INT32_MAX;
    for (size_t i = 0; i < s->cut_edge_count; i++) {
        if (s->cut_edges[i].vertex >= 0 && s->cut_edges[i].vertex < first) first = s->cut_edges[i].vertex;
    }
    if (first != INT32_MAX) s->geometry.crossing_count = first - s->geometry.point_count;
}

// ---------------------------------------------------------------------------------------------- cutting

/// A new vertex on an edge: every facet there gets it.
static bool split_edge(enf_subdivision *s, int32_t edge, int32_t from, int32_t vertex) {
    int32_t at = s->edge_half[edge], other = new_edge(s);
    if (other < 0) return false;
    s->edge_half[edge] = 0;
    while (at > 0) {
        int32_t added = new_half(s);
        if (added < 0) return false;
        enf_half *half = &s->halves[at], *second = &s->halves[added];
        int32_t following = half->radial;
        *second = *half;
        second->vertex = vertex;
        half->next = added;
        // `edge` stays with the end it came from.
        half->edge = half->vertex == from ? edge : other;
        second->edge = half->vertex == from ? other : edge;
        list_half(s, at);
        list_half(s, added);
        at = following;
    }
    return true;
}

static bool add_outline(enf_subdivision *s, int32_t from, int32_t to, int32_t edge, int32_t edge_plane) {
    if (!enf_array_reserve(s->outline, s->outline_capacity, s->outline_count + 1)) return false;
    s->outline_at[from] = (int32_t)s->outline_count;
    s->outline[s->outline_count++] = (struct enf_outline){from, to, edge, edge_plane};
    return true;
}

/// A facet's outline goes from the back of the plane to its front after `into`, and back again after `out`
/// (both are halves that start on the plane). Cuts it there; returns the part in front, -1 without memory.
static int32_t split_facet(enf_subdivision *s, int32_t f, int32_t into, int32_t out) {
    int32_t g = new_facet(s), edge = new_edge(s), behind = new_half(s), front = new_half(s);
    if (g < 0 || edge < 0 || behind < 0 || front < 0) return -1;
    enf_half *halves = s->halves;
    int32_t last = into; // of the front part
    while (halves[last].next != out) {
        halves[last].facet = g;
        last = halves[last].next;
    }
    halves[last].facet = g;
    halves[last].next = front;
    int32_t before = out; // of the part behind
    while (halves[before].next != into) before = halves[before].next;
    halves[before].next = behind;
    halves[behind] = (enf_half){halves[into].vertex, out, edge, front, 0, s->plane, f};
    halves[front] = (enf_half){halves[out].vertex, into, edge, 0, behind, s->plane, g};
    s->edge_half[edge] = behind;
    s->facets[g] = s->facets[f];
    s->facets[f].first = behind;
    s->facets[g].first = front;
    return g;
}

/// What one facet of the cell adds to the outline of the cut, given that it lies behind (or its part does).
static bool outline_from(enf_subdivision *s, int32_t half, int side, int32_t plane) {
    const enf_half *h = &s->halves[half];
    int32_t from = h->vertex, to = s->halves[h->next].vertex;
    return side == 0 ? add_outline(s, to, from, h->edge, plane) : add_outline(s, from, to, h->edge, plane);
}

/// Puts a facet at the head of a cell's list.
static void hang(enf_subdivision *s, int32_t f, int side, int32_t cell) {
    s->facets[f].cell[side] = cell;
    s->facets[f].next[side] = s->cell_facet[cell];
    s->cell_facet[cell] = f;
}

static int known_sign(const enf_subdivision *s, int32_t half) {
    return (s->vertex_sign[s->halves[half].vertex] & 3) - 1;
}

/// Cuts a facet that has corners on both sides, after its edges have been.
static bool divide_facet(enf_subdivision *s, int32_t f, int32_t cell, int32_t ahead) {
    int32_t into = -1, out = -1, first = s->facets[f].first, h = first;
    do {
        int32_t next = s->halves[h].next;
        if (known_sign(s, h) == 0) {
            int sign = known_sign(s, next);
            if (sign > 0) into = h;
            if (sign < 0) out = h;
        }
        h = next;
    } while (h != first);
    int side = s->facets[f].cell[1] == cell;
    int32_t g = split_facet(s, f, into, out), across = s->facets[f].cell[1 - side];
    if (g < 0) return false;
    if (across >= 0) s->facets[f].next[1 - side] = g; // beside it in the list of the cell beyond
    hang(s, f, side, cell);
    hang(s, g, side, ahead);
    return outline_from(s, s->facets[f].first, side, enf_subdivision_plane(s, f));
}

/// Sorts one facet of the cell to the cell behind or the one in front, or cuts it and does both.
static bool sort_facet(enf_subdivision *s, const enf_beside *beside, int32_t cell, int32_t ahead) {
    int32_t f = beside->facet, first = s->facets[f].first, h = first;
    if (beside->behind && beside->front) return divide_facet(s, f, cell, ahead);
    int side = s->facets[f].cell[1] == cell;
    hang(s, f, side, beside->front ? ahead : cell);
    if (beside->front || !beside->along) return true;
    do { // an edge on the plane may be several
        int32_t next = s->halves[h].next;
        if (known_sign(s, h) == 0 && known_sign(s, next) == 0 &&
            !outline_from(s, h, side, enf_subdivision_plane(s, f))) {
            return false;
        }
        h = next;
    } while (h != first);
    return true;
}

/// Do the facets that gave two planes their names lie in one plane?
static bool coincide(enf_subdivision *s, int32_t plane, int32_t other) {
    for (int i = 0; i < 3; i++) {
        if (enf_geometry_side(&s->geometry, s->geometry.planes[other][i], plane) != 0) return false;
    }
    return true;
}

/// Facets of joined tetrahedra may lie in one plane: parts of the outline along them are one straight line.
static void straighten(enf_subdivision *s, int32_t first) {
    int32_t h = first;
    do {
        int32_t next = s->halves[h].next, plane = s->halves[h].edge_plane, other = s->halves[next].edge_plane;
        if (plane != other && plane < s->tetrahedron_planes && other < s->tetrahedron_planes &&
            coincide(s, plane, other)) {
            // The line gets one name; it may have begun before `first`, so all of the other name go.
            for (int32_t k = next; s->halves[k].edge_plane == other; k = s->halves[k].next)
                s->halves[k].edge_plane = plane;
        }
        h = next;
    } while (h != first);
}

/// The facet between the two new cells.
static bool add_cut_facet(enf_subdivision *s, int32_t node, int32_t cell, int32_t ahead) {
    int32_t f = new_facet(s), first = -1, last = -1, at = 0;
    if (f < 0) return false;
    for (size_t i = 0; i < s->outline_count; i++) {
        const struct enf_outline *part = &s->outline[at];
        int32_t half = new_half(s);
        if (half < 0) return false;
        s->halves[half] = (enf_half){.vertex = part->from,
                                     .next = first,
                                     .edge = part->edge,
                                     .edge_plane = part->edge_plane,
                                     .facet = f};
        list_half(s, half);
        if (last >= 0) s->halves[last].next = half;
        if (first < 0) first = s->halves[half].next = half;
        last = half;
        at = s->outline_at[part->to];
    }
    s->facets[f] = (enf_share){.source = -1 - node, .first = first, .cover = -1};
    if (s->joined) straighten(s, first);
    hang(s, f, 0, cell);
    hang(s, f, 1, ahead);
    return true;
}

static int32_t add_node(enf_subdivision *s, int32_t cell, int32_t ahead) {
    if (!enf_array_reserve(s->node_plane, s->node_capacity, s->node_count + 1) ||
        !enf_array_reserve(s->node_child, s->child_capacity, s->node_count + 1)) {
        return -1;
    }
    int32_t node = (int32_t)s->node_count++, parent = s->cell_parent[cell];
    s->node_plane[node] = s->plane;
    s->node_child[node][0] = -1 - cell;
    s->node_child[node][1] = -1 - ahead;
    if (parent < 0) {
        s->tetrahedron_root[-1 - parent] = node;
    } else {
        s->node_child[parent >> 1][parent & 1] = node;
    }
    s->cell_parent[cell] = 2 * node;
    s->cell_parent[ahead] = 2 * node + 1;
    return node;
}

int32_t enf_subdivision_cut(enf_subdivision *s, int32_t cell) {
    if (!enf_array_reserve(s->cell_facet, s->cell_capacity, s->cell_count + 1) ||
        !enf_array_reserve(s->cell_parent, s->parent_capacity, s->cell_count + 1) ||
        !enf_array_reserve(s->cell_state, s->state_capacity, s->cell_count + 1)) {
        return -1;
    }
    int32_t ahead = (int32_t)s->cell_count++, node = add_node(s, cell, ahead);
    if (node < 0) return -1;
    s->cell_state[ahead] = ENF_CELL_WAITS;
    for (size_t i = 0; i < s->cut_edge_count; i++) {
        int32_t vertex = enf_subdivision_cut_vertex(s, i);
        if (vertex < 0 || !split_edge(s, s->cut_edges[i].edge, s->cut_edges[i].from, vertex)) return -1;
    }
    s->cell_facet[cell] = s->cell_facet[ahead] = -1;
    s->outline_count = 0;
    for (size_t i = 0; i < s->share_count; i++) {
        if (!sort_facet(s, &s->shares[i], cell, ahead)) return -1;
    }
    return add_cut_facet(s, node, cell, ahead) ? node : -1;
}
