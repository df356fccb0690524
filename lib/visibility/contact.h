// SPDX-License-Identifier: GPL-3.0-or-later
// Where two windows touch a plane between them, and how far apart they are there.
#ifndef ENF_VISIBILITY_CONTACT_H
#define ENF_VISIBILITY_CONTACT_H

#include "visibility/window.h"

/// How near one outline's highest corners above a plane through the origin are to the other's lowest: the
/// distance of the edges, or single corners, that lie within `band` of the highest height, and the lowest. 0
/// if more than an edge does.
double enf_contact_distance(const enf_outline *below, const enf_outline *above, const double normal[3],
                            double band);

#endif
