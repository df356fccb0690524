// SPDX-License-Identifier: GPL-3.0-or-later
// Portal files of Quake's tools: PRT1, PRT1-AM and PRT2. Any white space separates the fields.
//
//   PRT1     leafs portals                  every leaf is a cell
//   PRT2     leafs clusters portals         the clusters are the cells; after the portals, for each of them,
//                                           its leafs and -1
//   PRT1-AM  clusters portals leafs         after the portals, the cluster of each leaf
//
// A portal is `N A B (x y z) (x y z) ...`: N corners, and the normal by the right-hand rule points from cell
// A into cell B. There may or may not be blanks inside the parentheses.
#ifndef ENF_VISIBILITY_READ_PRT_H
#define ENF_VISIBILITY_READ_PRT_H

#include "build/read.h"
#include "visibility/portal_graph.h"

/// Reads the whole source into *graph, which is overwritten, and finishes it. What is refused, with its line
/// (ENF_BAD_INPUT): counts that the file is too small for; windings with fewer than 3 or more than 64
/// corners (doubles are dropped first), without area, or not planar or convex within enf_winding_tolerance;
/// coordinates beyond 1e100; cells that do not exist; a portal from a cell into itself; leafs in no cluster
/// or in two, clusters without leafs; anything after the end. The graph is empty then.
enf_status enf_read_prt(enf_portal_graph *graph, enf_source *source, enf_error *error);

#endif
