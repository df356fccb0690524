// SPDX-License-Identifier: GPL-3.0-or-later
// Convex solids, by their corners, that are cut and halved.
#ifndef ENF_VISIBILITY_SOLID_H
#define ENF_VISIBILITY_SOLID_H

#include "visibility/separator.h"

enum { ENF_SOLID_CORNERS = 64 };

typedef struct enf_solid {
    int32_t count;
    double corners[ENF_SOLID_CORNERS][3]; ///< in any order; their hull is the solid
} enf_solid;

/// The hull of some points; the box around them, if they are too many.
void enf_solid_make(enf_solid *solid, const double (*points)[3], int32_t count);

/// Keeps what is in front of the cut; false if that is nothing. A cut that would make too many corners is
/// left out.
bool enf_solid_cut(enf_solid *solid, const enf_cut *cut);

/// Keeps what all the cuts leave of it; false if that is nothing.
bool enf_solid_cut_all(enf_solid *solid, const enf_separators *cuts);

/// The longest side of the box around it, and where its middle is along that axis.
double enf_solid_extent(const enf_solid *solid, int *axis, double *middle);

/// The mean of the corners.
void enf_solid_middle(const enf_solid *solid, double middle[3]);

#endif
