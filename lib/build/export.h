// SPDX-License-Identifier: GPL-3.0-or-later
// A world in forms that other programs read. All take a checked view and write to a stream, whose write
// errors the caller finds with ferror. ENF_BAD_INPUT if the file lacks a part that the form needs.
#ifndef ENF_BUILD_EXPORT_H
#define ENF_BUILD_EXPORT_H

#include <stdio.h>

#include "enfilade/format.h"

/// Wavefront OBJ: object `cells` with a group per cell (`cell-N`: the triangles that the cell sees), object
/// `portals` with a group per opening (`portal-N`, polygons facing the lower cell).
enf_status enf_export_obj(const enf_file_view *view, FILE *out, enf_error *error);

/// GraphViz: a node per cell, an edge per opening.
enf_status enf_export_dot(const enf_file_view *view, FILE *out, enf_error *error);

/// JSON: cells, portals with their polygons, adjacency, spawn points.
enf_status enf_export_json(const enf_file_view *view, FILE *out, enf_error *error);

typedef struct enf_svg_options {
    const char *title; ///< may be null
    int up;            ///< 0 x, 1 y, 2 z: the world axis that points up
} enf_svg_options;

/// SVG: floor plans, one per storey; see export_svg.c and plan.h.
enf_status enf_export_svg(const enf_file_view *view, const enf_svg_options *options, FILE *out,
                          enf_error *error);

#endif
