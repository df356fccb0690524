// SPDX-License-Identifier: MIT
// Polygons of portals, seen through a region.
#ifndef ENF_RUN_VIEW_CLIP_H
#define ENF_RUN_VIEW_CLIP_H

#include "run/view_lens.h"
#include "run/view_region.h"

/// What polygons are clipped with.
typedef struct enf_view_clipping {
    const enf_view_lens *lens;
    const enf_view_region *region;
    const double *planes[2]; ///< world, passable on the positive side; null: none
    double near_distance;    ///< from the eye: polygons that near are looked through whole. World units
    double facing_tolerance; ///< an eye this little behind a plane counts as on it
    uint32_t without;        ///< enf_view_test
    bool rectangles;
} enf_view_clipping;

typedef enum enf_view_outcome {
    ENF_CLIP_SEEN,  ///< corners were written, counter-clockwise
    ENF_CLIP_WHOLE, ///< the region passes as it is
    ENF_CLIP_OUT_RECTANGLE,
    ENF_CLIP_OUT_POLYGON
} enf_view_outcome;

/// Corners of what is seen, on the screen, and the least w of them.
typedef struct enf_view_piece {
    double corners[ENF_VIEW_CORNERS][2];
    int32_t count;
    double nearest;
} enf_view_piece;

/// A convex polygon of `count` vertices that lies in `plane`. In ENF_CLIP_WHOLE `nearest` is 0.
enf_view_outcome enf_view_clip(const enf_view_clipping *clipping, const double plane[4],
                               const double (*vertices)[3], int32_t count, enf_view_piece *piece);

/// Is the eye so near to a polygon that rounding could hide what is seen past its edges?
bool enf_view_is_near(const double eye[3], double near_distance, const double plane[4],
                      const double (*vertices)[3], int32_t count);

/// Gives the region's lines the lengths that the sphere test needs.
void enf_region_measure(enf_view_region *region, const enf_view_lens *lens);

/// Is a sphere outside of one of the region's lines?
static inline bool enf_region_misses_sphere(const enf_view_region *region, const enf_view_lens *lens,
                                            const double centre[3], double radius) {
    double c[3];
    enf_lens_project(lens, centre, c);
    for (int32_t i = 0; i < region->line_count; i++) {
        const enf_view_line *l = &region->lines[i];
        if (l->a * c[0] + l->b * c[1] + l->c * c[2] < -radius * l->length) return true;
    }
    return false;
}

#endif
