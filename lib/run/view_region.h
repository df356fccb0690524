// SPDX-License-Identifier: MIT
// Regions of the screen: convex polygons, as their corners and as the lines along their edges.
//
// What holds, and makes the traversal conservative: the corners are right up to rounding, far less than
// ENF_VIEW_SLACK; the lines are moved outwards by the slack, and short edges, whose direction is rounded
// away, by as much as it takes to have all corners on their inner side. Clipping with lines hence loses
// nothing.
#ifndef ENF_RUN_VIEW_REGION_H
#define ENF_RUN_VIEW_REGION_H

#include "enfilade/view.h"

enum {
    ENF_VIEW_LINES = ENF_VIEW_EDGES_MAX + 4,
    ENF_VIEW_PORTAL_CORNERS = 64, ///< of portals that are clipped; those with more are looked through whole
    ENF_VIEW_CORNERS = 128        ///< room: while clipping
};

/// a x + b y + c w >= 0 within; (a, b) has length 1.
typedef struct enf_view_line {
    double a, b, c;
    double length; ///< of the plane's normal in the world, where enf_region_measure has been called
} enf_view_line;

/// The lines are those of the corners' edges; of a polygon that lost edges, or has short ones, those of the
/// rectangle, too.
typedef struct enf_view_region {
    double rectangle[4]; ///< least x, least y, largest x, largest y of the corners
    double area;
    int32_t count, line_count;
    double (*corners)[2];
    enf_view_line *lines;
} enf_view_region;

/// Counter-clockwise corners become a region without lines. Corners that are the same up to rounding are one.
/// Changes the corners given, if they are more than ENF_VIEW_EDGES_MAX.
void enf_region_outline(enf_view_region *region, double (*corners)[2], int32_t count);

/// Draws the lines, if there are none. Edges that lie on lines of `outer` or `other` (which clipped the
/// corners, or have them; or null) keep those lines: the slack does not add up from portal to portal.
void enf_region_draw(enf_view_region *region, const enf_view_region *outer, const enf_view_region *other);

/// A region of at most `edges_max` edges around one that has its lines drawn, and is at most as wide and
/// high. Returns the number of edges removed.
int32_t enf_region_simplify(enf_view_region *region, const enf_view_region *from, int32_t edges_max);

/// The region of a rectangle.
void enf_region_make_rectangle(enf_view_region *region, const double rectangle[4]);

void enf_region_copy(enf_view_region *to, const enf_view_region *from);

/// Is every corner of `inner` within the lines of `outer`?
bool enf_region_contains(const enf_view_region *outer, const enf_view_region *inner);

/// The convex hull of points, counter-clockwise, in place. Returns the number of corners.
int32_t enf_hull(double (*points)[2], int32_t count);

double enf_polygon_area(const double (*corners)[2], int32_t count);

/// Removes edges until there are at most `edges_max` (4 or more), each time the one whose neighbours, when
/// prolonged, add the least area (the thesis, 2.3.4); it becomes the rectangle around if that is smaller.
/// Returns how many are left.
int32_t enf_polygon_simplify(double (*corners)[2], int32_t count, int32_t edges_max);

/// Removes edges shorter than `shortest`, whose directions may be rounded away: the neighbours are prolonged
/// where they meet near by, otherwise a corner goes. At least a triangle is left; returns the number of
/// corners.
int32_t enf_polygon_tidy(double (*corners)[2], int32_t count, double shortest);

#endif
