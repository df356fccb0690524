// SPDX-License-Identifier: GPL-3.0-or-later
// The truth about a level that is made of brushes: an OBJ file with a "# brush N" line before the polygons of
// each. Brushes are convex and closed, so a point is solid exactly if it is behind all planes of one of them.
// Shares no code with the compiler. Liquids (groups with "liquid" in the name) are left out.
#ifndef ENF_CLI_BRUSHES_H
#define ENF_CLI_BRUSHES_H

#include "enfilade/base.h"

typedef struct cli_brush {
    size_t first_plane;
    double low[3], high[3];
} cli_brush;

typedef struct cli_brushes {
    double (*planes)[4]; ///< outward unit normal and offset
    size_t plane_count, plane_capacity;
    cli_brush *list;
    size_t count, capacity;
    double (*points)[3]; ///< all vertices of the file
    size_t point_count, point_capacity;
    double low[3], high[3]; ///< their box
} cli_brushes;

/// Reads the file, gzipped or not. ENF_BAD_INPUT if it names no brushes.
enf_status cli_brushes_read(cli_brushes *brushes, const char *path, enf_error *error);

void cli_brushes_free(cli_brushes *brushes);

/// +1 inside a brush, -1 outside all; 0 nearer than `margin` to the surface of one.
int cli_brushes_side(const cli_brushes *brushes, const double at[3], double margin);

/// The next of a sequence of points, even over the box. Start with any seed.
void cli_brushes_random_point(const cli_brushes *brushes, uint64_t *seed, double at[3]);

#endif
