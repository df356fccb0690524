// SPDX-License-Identifier: GPL-3.0-or-later
// One walk over the pieces that are not open inside: they are the boundaries of the regions. The volume is
// the sum of the cones over the boundary (the divergence theorem), all with their tip at one corner of that
// boundary, so that a crack's volume is not lost in that of cones from afar.
#include "build/region_size.h"

#include "base/array.h"
#include "build/winding.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct survey {
    enf_regions *regions;
    const enf_complex *complex;
    const enf_mesh *mesh;
    const bool *gap;
    enf_body_size *bodies; ///< per region; the surface is what is closed of it
    int32_t *tip;          ///< per region: a vertex of the boundary, -1 = none yet
    enf_votes votes;
} survey;

/// The region on one side of a piece; region_count outside the hull.
static int32_t region_beside(const survey *s, int32_t piece, int side) {
    int32_t cell = enf_complex_piece_cells(s->complex, piece)[side];
    return cell < 0 ? s->regions->region_count : s->regions->cell_region[cell];
}

static void grow_box(enf_body_size *body, const double at[3]) {
    for (int k = 0; k < 3; k++) {
        body->low[k] = at[k] < body->low[k] ? at[k] : body->low[k];
        body->high[k] = at[k] > body->high[k] ? at[k] : body->high[k];
    }
}

/// Adds a boundary piece between two different regions to one of them. `out` is its area vector, out of it.
static void add_boundary(survey *s, int32_t region, int32_t piece, const double out[3]) {
    const double(*at)[3] = (const double(*)[3])s->complex->vertex_position;
    int32_t count;
    const enf_corner *corners = enf_complex_piece(s->complex, piece, &count);
    enf_body_size *body = &s->bodies[region];
    if (s->tip[region] < 0) s->tip[region] = corners[0].vertex;
    const double *tip = at[s->tip[region]], *corner = at[corners[0].vertex];
    for (int k = 0; k < 3; k++) body->volume += out[k] * (corner[k] - tip[k]) / 3;
    for (int32_t i = 0; i < count; i++) grow_box(body, at[corners[i].vertex]);
}

/// Fronts and backs that face into the regions, and the vote about the solids between them.
static bool add_occluder(survey *s, int32_t facet, int32_t piece, const int32_t region[2],
                         const double area[3], double size) {
    enf_regions *regions = s->regions;
    int32_t cover = s->complex->piece_cover[piece], outside = regions->region_count;
    bool open = cover == ENF_PIECE_OPEN;
    for (int side = 0; side < 2; side++) {
        if (region[side] == outside) continue;
        if (open) {
            regions->touches_outside[region[side]] = true;
            continue;
        }
        if (!s->gap[s->complex->facet_cell[facet][side]]) s->bodies[region[side]].surface += size;
        if (cover < 0) continue;
        bool front = s->complex->cover_side[cover] == side;
        *(front ? &regions->front_area[region[side]] : &regions->back_area[region[side]]) += size;
    }
    if (region[0] == region[1] || cover == ENF_PIECE_SEALED) return true; // no polygon between them, no vote
    int32_t entered = open ? 0 : enf_complex_solids_behind(s->complex, s->mesh, facet, piece, area);
    return enf_votes_add(&s->votes, region[0], region[1], entered, size);
}

static bool survey_pieces(survey *s) {
    const enf_complex *complex = s->complex;
    int32_t outside = s->regions->region_count;
    bool good = true;
    for (int32_t facet = 0; good && facet < complex->facet_count; facet++) {
        for (int32_t p = complex->facet_piece[facet]; good && p < complex->facet_piece[facet + 1]; p++) {
            const int32_t *cell = complex->facet_cell[facet];
            if (complex->piece_cover[p] == ENF_PIECE_OPEN && cell[0] >= 0 && cell[1] >= 0) continue;
            int32_t region[2] = {region_beside(s, p, 0), region_beside(s, p, 1)};
            double area[3];
            enf_complex_piece_area(complex, p, area);
            double size = sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
            good = add_occluder(s, facet, p, region, area, size);
            if (region[0] == region[1]) continue;
            double back[3] = {-area[0], -area[1], -area[2]};
            if (region[0] != outside) add_boundary(s, region[0], p, area);
            if (region[1] != outside) add_boundary(s, region[1], p, back);
        }
    }
    return good;
}

bool enf_regions_measure(enf_regions *regions, const enf_complex *complex, const enf_mesh *mesh,
                         const bool *gap, double crack) {
    survey s = {.regions = regions, .complex = complex, .mesh = mesh, .gap = gap};
    size_t count = (size_t)regions->region_count;
    s.bodies = enf_array_new(count, sizeof *s.bodies);
    s.tip = enf_array_new(count, sizeof *s.tip);
    bool good = s.bodies && s.tip;
    for (size_t r = 0; good && r < count; r++) {
        s.bodies[r] =
            (enf_body_size){.low = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, .high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
        s.tip[r] = -1;
    }
    good = good && survey_pieces(&s) &&
           enf_votes_settle(&s.votes, regions->region_count, regions->winding, regions->ambiguous);
    for (size_t r = 0; good && r < count; r++) {
        regions->volume[r] =
            fmax(s.bodies[r].volume, 0); // of hairlines, rounding may leave less than nothing
        regions->hairline[r] = !regions->touches_outside[r] && enf_body_is_hairline(&s.bodies[r], crack);
    }
    enf_votes_free(&s.votes);
    free(s.bodies);
    free(s.tip);
    return good;
}
