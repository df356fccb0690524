// SPDX-License-Identifier: GPL-3.0-or-later
// The exact area of a silhouette: the part of the plane that a projected closed surface covers, overlaps
// counted once. A plane sweep over the contour edges (Bentley and Ottmann, 1979, with slabs instead of a
// tree): the area where the winding number is positive. "Exact" means up to the rounding of sums and
// products: nothing is sampled or boxed, and a wrongly ordered pair of nearly equal edges costs no more than
// the sliver between them.
#ifndef ENF_BUILD_SILHOUETTE_H
#define ENF_BUILD_SILHOUETTE_H

#include "enfilade/base.h"

/// An edge of the plane figure. Crossing it upwards (towards larger y) changes the winding number by `rise`.
/// The left end comes first (x0 <= x1).
typedef struct enf_contour_edge {
    double x0, y0, x1, y1;
    int32_t rise;
} enf_contour_edge;

/// Where the winding number along the lower border of a band changes, going right.
typedef struct enf_border_turn {
    double x;
    int64_t change;
} enf_border_turn;

/// Working memory, kept between calls; start from {0}.
typedef struct enf_silhouette {
    enf_contour_edge *edges; ///< the figure: fill with enf_silhouette_add
    size_t edge_count, edge_capacity;
    uint32_t *bucket_first; ///< where each bucket begins in ordered
    uint32_t *ordered;      ///< the edges nearly in the order of their left ends
    size_t bucket_capacity, ordered_capacity;
    double *borders; ///< of the bands, ascending
    size_t band_count, border_capacity;
    size_t *band_first;   ///< per band and one more: where its list in band_edges begins
    uint32_t *band_edges; ///< the edges of each band
    size_t band_capacity, listed_capacity;
    enf_contour_edge *parts; ///< the edges within the band
    size_t part_count, part_capacity;
    enf_border_turn *turns; ///< along the lower border of the band
    size_t turn_count, turn_capacity;
    double *events; ///< the ends of all slabs, ascending
    size_t event_capacity;
    struct enf_slab_edge *active; ///< the edges that cross the slab, bottom to top
    size_t active_capacity;
    double *crossings; ///< where edges of one block cross, as fractions of the slab
    size_t crossing_capacity;
    struct enf_slab_height *order; ///< a block's edges, sorted between two crossings
    size_t order_capacity;
    double *lowest; ///< for each active edge the lowest right end from there on upwards
    size_t lowest_capacity;
} enf_silhouette;

void enf_silhouette_free(enf_silhouette *work);

/// Starts a new figure.
void enf_silhouette_clear(enf_silhouette *work);

/// Adds the edge from a to b of a counter-clockwise outline `times` times (negative: from b to a). Returns
/// false when there is no memory.
bool enf_silhouette_add(enf_silhouette *work, const double a[2], const double b[2], int32_t times);

/// The area where the winding number of the figure is positive. The edges have to be those of closed
/// outlines; their order does not matter, not even for the last bit. Uses up the figure. Returns false when
/// there is no memory.
bool enf_silhouette_area(enf_silhouette *work, double *area);

#endif
