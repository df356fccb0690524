// SPDX-License-Identifier: GPL-3.0-or-later
// The portals between the cells while they merge, and which of them is the lightest.
#include "build/portal_heap.h"

#include "base/array.h"

#include <math.h>
#include <stdlib.h>

/// Only the time depends on these two: from how many sides on a cell is plugged, and how many a plug has at
/// most.
enum { PLUGGED_SIDES = 256, PLUG_SIDES = 24 };

/// Portals of a block as a power of two; no more than MANY_BITS are one block. A block and its cells take
/// about 8 MB.
enum { BLOCK_BITS = 14, MANY_BITS = 16 };

void enf_portal_heap_free(enf_portal_heap *portals) {
    enf_surface_free(&portals->surface);
    enf_pair_table_free(&portals->table);
    enf_block_heap_free(&portals->heap);
    free(portals->portals);
    free(portals->shapes);
    free(portals->piece_next);
    free(portals->cells);
    *portals = (enf_portal_heap){0};
}

static int side_of(const enf_portal *portal, int32_t cell) {
    return portal->cell[1] == cell;
}

static void link_portal(enf_portal_heap *portals, int32_t number, int side) {
    enf_portal *portal = &portals->portals[number];
    int32_t cell = portal->cell[side], first = portals->cells[cell].first_portal;
    portal->previous[side] = -1;
    portal->next[side] = first;
    if (first >= 0) portals->portals[first].previous[side_of(&portals->portals[first], cell)] = number;
    portals->cells[cell].first_portal = number;
    ++portals->cells[cell].degree;
}

static void unlink_portal(enf_portal_heap *portals, int32_t number, int side) {
    enf_portal *portal = &portals->portals[number];
    int32_t cell = portal->cell[side], next = portal->next[side], previous = portal->previous[side];
    if (previous < 0)
        portals->cells[cell].first_portal = next;
    else
        portals->portals[previous].next[side_of(&portals->portals[previous], cell)] = next;
    if (next >= 0) portals->portals[next].previous[side_of(&portals->portals[next], cell)] = previous;
    --portals->cells[cell].degree;
}

/// The unit normal of the portal's plane, its first component that is not 0 positive.
static void normal_of(const enf_portal_heap *portals, int32_t number, double normal[3]) {
    const double *sum = portals->shapes[number].sum;
    double length = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    if (!(length > portals->shapes[number].area * ENF_CLOSED_PORTAL_RATIO)) {
        const int32_t largest = portals->portals[number].largest_piece;
        sum = portals->surface.pieces[largest].area;
        length = enf_surface_piece_area(&portals->surface, largest);
    }
    if (!(length > 0)) {
        normal[0] = normal[1] = 0;
        normal[2] = 1;
        return;
    }
    double sign = sum[0] != 0 ? sum[0] : sum[1] != 0 ? sum[1] : sum[2];
    if (sign < 0) length = -length;
    for (int k = 0; k < 3; ++k) normal[k] = sum[k] / length;
}

static double round_weight(double weight) {
    if (!(weight >= 0 && weight < INFINITY)) return INFINITY;
    int exponent;
    double fraction = frexp(weight, &exponent);
    return ldexp(rint(ldexp(fraction, ENF_WEIGHT_BITS)), exponent - ENF_WEIGHT_BITS);
}

static double weight_of(const enf_portal_heap *portals, int32_t number, double silhouette) {
    const double area = portals->shapes[number].area;
    double size = portals->heuristic == ENF_HEURISTIC_ASPECT_SCALED ? sqrt(silhouette) : silhouette;
    return area > 0 ? round_weight(size / area) : INFINITY;
}

static double key_weight(const enf_portal_heap *portals, int32_t number) {
    return enf_block_heap_key_of(&portals->heap, number).weight;
}

static void set_key(enf_portal_heap *portals, int32_t number, double weight) {
    const enf_portal *portal = &portals->portals[number];
    int32_t a = portals->cells[portal->cell[0]].smallest, b = portals->cells[portal->cell[1]].smallest;
    enf_block_heap_set(&portals->heap, number, (enf_heap_key){weight, a < b ? a : b, a < b ? b : a});
}

static bool is_fresh(const enf_portal_heap *portals, const enf_portal *portal) {
    return portal->weighed_at == portals->cells[portal->cell[0]].age + portals->cells[portal->cell[1]].age;
}

/// A lower bound of the weight that costs no look at the surfaces.
static double bound_weight(const enf_portal_heap *portals, int32_t number) {
    const int32_t *cell = portals->portals[number].cell;
    double normal[3], silhouette = 0;
    normal_of(portals, number, normal);
    for (int s = 0; s < 2; ++s) {
        silhouette = fmax(silhouette, portals->shapes[number].silhouette[s]);
        silhouette = fmax(silhouette, enf_surface_silhouette_bound(&portals->surface, cell[s], normal));
    }
    return weight_of(portals, number, silhouette);
}

/// Takes small neighbours that fill dents of a large cell as parts of it for the next silhouette.
static bool plug_dents(enf_portal_heap *portals, int32_t cell, const double normal[3]) {
    enf_surface *surface = &portals->surface;
    if (surface->bodies[cell].side_count < PLUGGED_SIDES || surface->bodies[cell].fine_count == 1)
        return true;
    for (int32_t number = portals->cells[cell].first_portal; number >= 0;) {
        const enf_portal *portal = &portals->portals[number];
        int side = side_of(portal, cell);
        number = portal->next[side];
        if (surface->bodies[portal->cell[!side]].side_count > PLUG_SIDES) continue;
        size_t before = surface->hidden_count;
        for (int32_t piece = portal->first_piece; piece >= 0; piece = portals->piece_next[piece])
            if (!enf_surface_hide(surface, piece)) return false;
        if (!enf_surface_plug(surface, portal->cell[!side], normal, before)) return false;
    }
    return true;
}

/// Computes the weight: the silhouettes that may have grown, the cell with the larger surface first, the
/// other only as far as it can be the larger one. Returns false when there is no memory.
static bool weigh(enf_portal_heap *portals, int32_t number, double *weight) {
    enf_portal *portal = &portals->portals[number];
    enf_portal_shape *shape = &portals->shapes[number];
    double normal[3], largest = 0;
    normal_of(portals, number, normal);
    bool known[2];
    for (int s = 0; s < 2; ++s) {
        known[s] = portal->silhouette_at[s] == portals->cells[portal->cell[s]].age;
        if (known[s]) largest = fmax(largest, shape->silhouette[s]);
    }
    const enf_body *bodies = portals->surface.bodies;
    int first = bodies[portal->cell[1]].side_count > bodies[portal->cell[0]].side_count;
    for (int i = 0; i < 2; ++i) {
        int s = i ? !first : first;
        if (known[s]) continue;
        if (enf_surface_box_silhouette(&portals->surface, portal->cell[s], normal) <= largest) continue;
        if (!plug_dents(portals, portal->cell[s], normal)) return false;
        double area = enf_surface_silhouette(&portals->surface, portal->cell[s], normal, largest);
        if (area < 0) return false;
        if (area <= largest) continue;
        largest = area;
        shape->silhouette[s] = area;
        portal->silhouette_at[s] = portals->cells[portal->cell[s]].age;
    }
    portal->weighed_at = portals->cells[portal->cell[0]].age + portals->cells[portal->cell[1]].age;
    ++portals->evaluations;
    *weight = weight_of(portals, number, largest);
    return true;
}

static bool allocate(enf_portal_heap *portals, size_t cells, size_t pieces, size_t count, int block_bits) {
    portals->portals = enf_array_new(count, sizeof *portals->portals);
    portals->shapes = enf_array_new(count, sizeof *portals->shapes);
    portals->piece_next = enf_array_new(pieces, sizeof *portals->piece_next);
    portals->cells = enf_array_new(cells, sizeof *portals->cells);
    if (!portals->portals || !portals->shapes || !portals->piece_next || !portals->cells ||
        !enf_block_heap_create(&portals->heap, (int32_t)count, block_bits))
        return false;
    for (size_t cell = 0; cell < cells; ++cell)
        portals->cells[cell] =
            (enf_portal_cell){.first_portal = -1, .degree = 0, .smallest = (int32_t)cell, .age = 1};
    return true;
}

/// Adds the pieces of `other` to a portal; `sign` is -1 when the two run in opposite directions.
static void join_pieces(enf_portal_heap *portals, int32_t number, const enf_portal *other,
                        const enf_portal_shape *other_shape, double sign) {
    enf_portal *portal = &portals->portals[number];
    enf_portal_shape *shape = &portals->shapes[number];
    if (portal->first_piece < 0)
        portal->first_piece = other->first_piece;
    else
        portals->piece_next[portal->last_piece] = other->first_piece;
    portal->last_piece = other->last_piece;
    int32_t a = portal->largest_piece, b = other->largest_piece;
    double area_a = a < 0 ? 0 : enf_surface_piece_area(&portals->surface, a);
    double area_b = enf_surface_piece_area(&portals->surface, b);
    if (a < 0 || area_b > area_a || (area_b == area_a && b < a)) portal->largest_piece = b;
    shape->area += other_shape->area;
    for (int k = 0; k < 3; ++k) shape->sum[k] += sign * other_shape->sum[k];
}

/// Pieces of the same two fine cells are neighbours in the canonical order: one portal for each such run.
/// False without memory.
static bool fill_portals(enf_portal_heap *portals) {
    const enf_surface *surface = &portals->surface;
    int32_t number = -1;
    for (int32_t piece = 0; piece < surface->piece_count; ++piece) {
        portals->piece_next[piece] = -1;
        if (!surface->piece_open[piece]) continue;
        const int32_t *cell = surface->piece_cell[piece];
        if (number < 0 || portals->portals[number].cell[0] != cell[0] ||
            portals->portals[number].cell[1] != cell[1]) {
            portals->portals[++number] = (enf_portal){
                .cell = {cell[0], cell[1]}, .first_piece = -1, .last_piece = -1, .largest_piece = -1};
            portals->shapes[number] = (enf_portal_shape){.area = 0};
            if (!enf_pair_table_put(&portals->table, cell[0], cell[1], number)) return false;
            link_portal(portals, number, 0);
            link_portal(portals, number, 1);
        }
        const double *outward = surface->pieces[piece].area;
        const enf_portal added = {.first_piece = piece, .last_piece = piece, .largest_piece = piece};
        const enf_portal_shape shape = {.area = enf_surface_piece_area(surface, piece),
                                        .sum = {outward[0], outward[1], outward[2]}};
        join_pieces(portals, number, &added, &shape, 1);
    }
    portals->portal_count = number + 1;
    enf_surface_forget_cells(&portals->surface);
    return true;
}

/// Counts them, and tells the table of them.
static int32_t count_portals(enf_portal_heap *portals) {
    const enf_surface *surface = &portals->surface;
    int32_t count = 0;
    const int32_t *last = NULL;
    for (int32_t piece = 0; piece < surface->piece_count; ++piece) {
        if (!surface->piece_open[piece]) continue;
        const int32_t *cell = surface->piece_cell[piece];
        if (last && last[0] == cell[0] && last[1] == cell[1]) continue;
        enf_pair_table_expect(&portals->table, cell[0], cell[1]);
        ++count;
        last = cell;
    }
    return count;
}

enf_status enf_portal_heap_create(enf_portal_heap *portals, enf_graph *graph, enf_heuristic heuristic,
                                  bool in_blocks, enf_error *error) {
    *portals = (enf_portal_heap){.heuristic = heuristic};
    size_t cells = (size_t)graph->cell_count;
    enf_status status = enf_surface_create(&portals->surface, graph, error);
    enf_graph_free(graph);
    if (status != ENF_OK) return status;
    size_t pieces = (size_t)portals->surface.piece_count;
    bool fine = enf_pair_table_create(&portals->table, (int32_t)cells);
    const int32_t count = fine ? count_portals(portals) : 0;
    const int block_bits = in_blocks && count > 1 << MANY_BITS ? BLOCK_BITS : ENF_ONE_BLOCK_BITS;
    fine = fine && allocate(portals, cells, pieces, (size_t)count, block_bits) && fill_portals(portals);
    for (int32_t number = 0; fine && number < portals->portal_count; ++number) {
        double weight;
        fine = weigh(portals, number, &weight);
        if (fine) set_key(portals, number, weight);
    }
    if (fine) return ENF_OK;
    enf_portal_heap_free(portals);
    return enf_fail_memory(error, "the portals between the cells");
}

enf_status enf_portal_heap_top(enf_portal_heap *portals, int32_t block, int32_t *portal, double *weight,
                               enf_error *error) {
    while ((*portal = enf_block_heap_top(&portals->heap, block)) >= 0) {
        double key = key_weight(portals, *portal);
        *weight = key;
        if (is_fresh(portals, &portals->portals[*portal])) return ENF_OK;
        double bound = bound_weight(portals, *portal);
        if (bound > key) {
            set_key(portals, *portal, bound);
            continue;
        }
        if (!weigh(portals, *portal, weight)) return enf_fail_memory(error, "a silhouette");
        set_key(portals, *portal, fmax(key, *weight));
    }
    *weight = INFINITY;
    return ENF_OK;
}

/// The portal of the gone cell becomes one of the kept cell. Its weight can only have grown. False without
/// memory.
static bool hand_over(enf_portal_heap *portals, int32_t number, int side, int32_t kept) {
    enf_portal *portal = &portals->portals[number];
    portal->cell[side] = kept;
    portal->weighed_at = portal->silhouette_at[side] = 0;
    if (!enf_pair_table_put(&portals->table, kept, portal->cell[!side], number)) return false;
    link_portal(portals, number, side);
    set_key(portals, number, key_weight(portals, number));
    return true;
}

static bool same_normal(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/// Two portals to the same cell become one. What is known of the silhouettes stays true if the normal stays.
static void join_portals(enf_portal_heap *portals, int32_t number, int side, int32_t other_number,
                         int other_side) {
    enf_portal *portal = &portals->portals[number];
    const enf_portal *other = &portals->portals[other_number];
    double *own = portals->shapes[number].silhouette;
    const double *others = portals->shapes[other_number].silhouette;
    double before[3], before_other[3], normal[3];
    normal_of(portals, number, before);
    normal_of(portals, other_number, before_other);
    join_pieces(portals, number, other, &portals->shapes[other_number], side == other_side ? 1 : -1);
    normal_of(portals, number, normal);
    if (!same_normal(before, normal))
        for (int s = 0; s < 2; ++s) own[s] = portal->silhouette_at[s] = 0;
    if (same_normal(before_other, normal)) {
        own[side] = fmax(own[side], others[other_side]);
        if (portal->silhouette_at[!side] != portals->cells[portal->cell[!side]].age) {
            own[!side] = fmax(own[!side], others[!other_side]);
            portal->silhouette_at[!side] = other->silhouette_at[!other_side];
        }
    }
    portal->weighed_at = 0;
    set_key(portals, number, bound_weight(portals, number));
}

/// Gives all portals of the gone cell to the kept one. False without memory.
static bool move_portals(enf_portal_heap *portals, int32_t kept, int32_t gone) {
    for (int32_t number = portals->cells[gone].first_portal, next; number >= 0; number = next) {
        enf_portal *portal = &portals->portals[number];
        int side = side_of(portal, gone);
        next = portal->next[side];
        int32_t beyond = portal->cell[!side];
        enf_pair_table_remove(&portals->table, gone, beyond);
        int32_t twin = enf_pair_table_find(&portals->table, kept, beyond);
        if (twin < 0) {
            if (!hand_over(portals, number, side, kept)) return false;
            continue;
        }
        unlink_portal(portals, number, !side);
        enf_block_heap_remove(&portals->heap, number);
        join_portals(portals, twin, side_of(&portals->portals[twin], kept), number, side);
    }
    portals->cells[gone].first_portal = -1;
    portals->cells[gone].degree = 0;
    return true;
}

/// The kept cell has a smaller number to show: that decides ties.
static void renumber(enf_portal_heap *portals, int32_t cell, int32_t smallest) {
    portals->cells[cell].smallest = smallest;
    for (int32_t number = portals->cells[cell].first_portal; number >= 0;) {
        const enf_portal *portal = &portals->portals[number];
        set_key(portals, number, key_weight(portals, number));
        number = portal->next[side_of(portal, cell)];
    }
}

bool enf_portal_heap_collapse(enf_portal_heap *portals, int32_t number, int32_t *kept, int32_t *gone) {
    enf_portal *portal = &portals->portals[number];
    int32_t a = portal->cell[0], b = portal->cell[1];
    int32_t smallest_a = portals->cells[a].smallest, smallest_b = portals->cells[b].smallest;
    *kept = smallest_a < smallest_b ? smallest_a : smallest_b;
    *gone = smallest_a < smallest_b ? smallest_b : smallest_a;
    enf_block_heap_remove(&portals->heap, number);
    enf_pair_table_remove(&portals->table, a, b);
    unlink_portal(portals, number, 0);
    unlink_portal(portals, number, 1);
    for (int32_t piece = portal->first_piece; piece >= 0; piece = portals->piece_next[piece])
        enf_surface_drop(&portals->surface, piece);
    // The cell with more portals keeps its place, so a portal is handed over only log n times.
    int32_t large = portals->cells[a].degree >= portals->cells[b].degree ? a : b, small = large == a ? b : a;
    if (!enf_surface_is_lid(&portals->surface, small)) ++portals->cells[large].age;
    if (!enf_surface_merge(&portals->surface, large, small)) return false;
    if (portals->cells[large].smallest != *kept) renumber(portals, large, *kept);
    return move_portals(portals, large, small);
}
