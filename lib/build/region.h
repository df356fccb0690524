// SPDX-License-Identifier: GPL-3.0-or-later
// Colour: regions of fine cells joined through open pieces, what each is made of, and which are kept.
#ifndef ENF_BUILD_REGION_H
#define ENF_BUILD_REGION_H

#include "build/complex.h"
#include "build/tetrahedra.h"

typedef enum enf_kind { ENF_KIND_AIR = 0, ENF_KIND_ROCK = 1, ENF_KIND_OUTSIDE = 2 } enf_kind;

typedef enum enf_keep { ENF_KEEP_AUTO, ENF_KEEP_ALL, ENF_KEEP_OUTSIDE, ENF_KEEP_SPAWN } enf_keep;

typedef struct enf_regions {
    int32_t region_count;
    int32_t *cell_region; ///< per fine cell; regions are numbered by their smallest fine cell
    uint8_t *kind;        ///< enf_kind per region
    bool *kept;
    bool *touches_outside;          ///< some hull facet of it is open
    int32_t *winding;               ///< how many closed solids hold the region (see region.c); 0 outside
    bool *ambiguous;                ///< the polygons around it contradict each other about the winding
    double *volume;                 ///< grid steps cubed
    bool *hairline;                 ///< thinner than the weld distance: a crack, no place
    double *front_area, *back_area; ///< occluder fronts and backs that face into it, grid steps squared

    int32_t spawn_count;
    int32_t *spawn_cell; ///< fine cell per mesh spawn, or -1 outside the hull

    int32_t sealed;     ///< pieces that were sealed: cracks narrower than the tolerance between two regions
    double sealed_area; ///< grid steps squared

    bool leak; ///< a spawn's region reaches the outside
    int32_t leak_spawn;
    double leak_width;        ///< of the narrowest opening on the way, grid steps
    double leak_neck[3];      ///< and its middle
    int32_t leak_point_count; ///< polyline from the spawn to the outside, grid steps
    double (*leak_points)[3];
} enf_regions;

void enf_regions_free(enf_regions *regions);

/// Colours the complex, seals cracks narrower than `crack` (grid steps; 0: none) between regions that are
/// otherwise separate, finds what every region is made of, places the mesh's spawns, and applies the keep
/// rules. `tets` is the triangulation that the complex was split from (for walking to the spawns).
/// ENF_BAD_INPUT when --keep spawn has no spawn to go by, or nothing at all is kept.
enf_status enf_regions_colour(enf_regions *regions, enf_complex *complex, const enf_mesh *mesh,
                              const enf_tet_mesh *tets, enf_keep keep, double crack, enf_error *error);

#endif
