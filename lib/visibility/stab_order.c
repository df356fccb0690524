// SPDX-License-Identifier: GPL-3.0-or-later
// Lines in order. Where a line that was found comes to two neighbouring portals of the sequence in the wrong
// order, the lines in the right order go through one of the triangles of each, and pass the hinge of their
// planes on the right side: for all pairs of triangles, one by one, that is asked for as well.
#include "base/array.h"
#include "visibility/stab_parts.h"

enum {
    SIDES = 5,      ///< of a pair of triangles: two of each, and the hinge
    ATTEMPTS = 4096 ///< programs for a sequence, then it stays open
};

typedef struct ordering {
    enf_stabber *stabber;
    const enf_shapes *shapes;
    const int32_t *sequence;
    int32_t count;
    int32_t attempts;
    bool open; ///< something was not decided
} ordering;

/// A triangle of a portal's fan, turned as the portal is.
typedef struct triangle {
    const double *corner[3];
    bool is_first, is_last; ///< of the fan
} triangle;

static int32_t triangle_count(const ordering *o, int32_t place) {
    const int32_t *first = &o->shapes->graph->opening_corner[o->sequence[place] >> 1];
    return first[1] - first[0] - 2;
}

static triangle get_triangle(const ordering *o, int32_t place, int32_t index) {
    const enf_portal_graph *graph = o->shapes->graph;
    const bool turned = o->sequence[place] & 1;
    const double(*corners)[3] =
        (const double(*)[3])graph->corners + graph->opening_corner[o->sequence[place] >> 1];
    return (triangle){{corners[0], corners[index + 1 + turned], corners[index + 2 - turned]},
                      index == (turned ? triangle_count(o, place) - 1 : 0),
                      index == (turned ? 0 : triangle_count(o, place) - 1)};
}

static void add_side(enf_stabber *stabber, const enf_stab_side *side) {
    stabber->sides[stabber->side_count++] = *side;
}

/// The sides of the triangle that are not the portal's edges.
static void add_triangle(enf_stabber *stabber, const triangle *triangle, int32_t place) {
    const double *const *corner = triangle->corner;
    if (!triangle->is_first) add_side(stabber, &(enf_stab_side){{corner[0], corner[1]}, 2, place});
    if (!triangle->is_last) add_side(stabber, &(enf_stab_side){{corner[2], corner[0]}, 2, place});
}

/// The first one before the second.
static void add_hinge(enf_stabber *stabber, const triangle *one, const triangle *two, int32_t place) {
    const double *const *a = one->corner, *const *b = two->corner;
    add_side(stabber, &(enf_stab_side){{a[0], a[1], a[2], b[0], b[1], b[2]}, 6, place});
}

static bool is_ordered(const enf_stabber *stabber, int32_t place) {
    bool found = false;
    for (int32_t k = 0; k < stabber->side_count; k++) found |= stabber->sides[k].place == place;
    return found;
}

// ---------------------------------------------------------------------------------------------- branches

static enf_status branch(ordering *o, int32_t place, enf_stab *stab, enf_error *error);

/// In order already; or not, and what else to ask for; or nothing known.
static enf_status judge(ordering *o, enf_stab *stab, enf_error *error) {
    if (stab->answer == ENF_STAB_HIDDEN) return ENF_OK;
    const bool has_line = stab->has_line || stab->long_line;
    const int32_t place =
        has_line ? enf_line_disorder(o->shapes, &stab->line, stab->has_line ? NULL : stab->long_line,
                                     o->sequence, o->count)
                 : 0;
    if (has_line && place == 0) return ENF_OK;
    *stab = (enf_stab){.answer = ENF_STAB_HIDDEN};
    if (has_line && !is_ordered(o->stabber, place)) return branch(o, place, stab, error);
    o->open = true;
    return ENF_OK;
}

static enf_status attempt(ordering *o, enf_stab *stab, enf_error *error) {
    if (o->attempts == ATTEMPTS) {
        o->open = true;
        return ENF_OK;
    }
    o->attempts++;
    enf_status status = enf_stab_exact(o->stabber, o->sequence, o->count, NULL, stab, error);
    return status ? status : judge(o, stab, error);
}

/// The portal at this place after the one before it, through each of their triangles, until a line is found.
static enf_status branch(ordering *o, int32_t place, enf_stab *stab, enf_error *error) {
    enf_stabber *stabber = o->stabber;
    const int32_t sides = stabber->side_count;
    const int32_t ones = triangle_count(o, place - 1), twos = triangle_count(o, place);
    enf_status status = ENF_OK;
    if (!enf_array_reserve(stabber->sides, stabber->side_capacity, (size_t)sides + SIDES))
        return enf_fail_memory(error, "a portal sequence's order");
    for (int32_t k = 0; !status && stab->answer == ENF_STAB_HIDDEN && k < ones * twos; k++) {
        const triangle one = get_triangle(o, place - 1, k / twos), two = get_triangle(o, place, k % twos);
        add_triangle(stabber, &one, place);
        add_triangle(stabber, &two, place);
        add_hinge(stabber, &one, &two, place);
        status = attempt(o, stab, error);
        stabber->side_count = sides;
    }
    return status;
}

enf_status enf_stab_in_order(enf_stabber *stabber, const enf_shapes *shapes, const int32_t *sequence,
                             int32_t count, const enf_line *hint, enf_stab *stab, enf_error *error) {
    ordering o = {.stabber = stabber, .shapes = shapes, .sequence = sequence, .count = count};
    enf_status status = enf_stab_exact(stabber, sequence, count, hint, stab, error);
    if (status || stab->answer == ENF_STAB_HIDDEN) return status;
    status = judge(&o, stab, error);
    stabber->counts.orders += o.attempts > 0;
    stabber->counts.orders_open += o.attempts > 0 && o.open && stab->answer == ENF_STAB_HIDDEN;
    stabber->counts.orders_hidden += o.attempts > 0 && !o.open && stab->answer == ENF_STAB_HIDDEN;
    if (o.open && stab->answer == ENF_STAB_HIDDEN) stab->answer = ENF_STAB_OPEN;
    return status;
}
