// SPDX-License-Identifier: MIT
#include "run/view_region.h"

#include <float.h>
#include <math.h>
#include <string.h>

/// Of what lies on a line, after a division.
static const double on_line = ENF_VIEW_SLACK * 1e-4;
/// Corners nearer than this are one: it is well within the slack, and well above the rounding.
static const double same_corner = ENF_VIEW_SLACK * 1e-4;

/// Rounding turns a line through such an edge by less than the slack over a screen; through a shorter one
/// maybe by more.
static const double short_edge = 1e-3;
/// Area of a polygon that may have corners as sharp as that, in squares of its length.
static const double thin_share = 1e-3;

double enf_polygon_area(const double (*corners)[2], int32_t count) {
    double sum = 0;
    for (int32_t i = 2; i < count; i++) {
        double u[2] = {corners[i - 1][0] - corners[0][0], corners[i - 1][1] - corners[0][1]};
        double v[2] = {corners[i][0] - corners[0][0], corners[i][1] - corners[0][1]};
        sum += u[0] * v[1] - u[1] * v[0];
    }
    return 0.5 * sum;
}

static void bound(const double (*corners)[2], int32_t count, double rectangle[4]) {
    rectangle[0] = rectangle[2] = corners[0][0];
    rectangle[1] = rectangle[3] = corners[0][1];
    for (int32_t i = 1; i < count; i++) {
        double x = corners[i][0], y = corners[i][1];
        rectangle[0] = x < rectangle[0] ? x : rectangle[0];
        rectangle[1] = y < rectangle[1] ? y : rectangle[1];
        rectangle[2] = x > rectangle[2] ? x : rectangle[2];
        rectangle[3] = y > rectangle[3] ? y : rectangle[3];
    }
}

static int32_t unite_same(double (*corners)[2], int32_t count) {
    int32_t kept = 0;
    for (int32_t i = 0; i < count; i++) {
        const double *last = corners[kept ? kept - 1 : count - 1];
        bool same =
            fabs(corners[i][0] - last[0]) < same_corner && fabs(corners[i][1] - last[1]) < same_corner;
        if (same && (kept || i + 1 < count)) continue;
        memmove(corners[kept++], corners[i], sizeof *corners);
    }
    return kept;
}

/// As far out as it takes to have all corners within.
static double support(const double (*corners)[2], int32_t count, double a, double b) {
    double least = INFINITY;
    for (int32_t i = 0; i < count; i++) {
        double side = a * corners[i][0] + b * corners[i][1];
        least = side < least ? side : least;
    }
    return -least;
}

/// What lines are drawn around: corners, and regions whose lines may be kept.
typedef struct drawing {
    const double (*corners)[2];
    int32_t count;
    const enf_view_region *known[2]; ///< or null
} drawing;

/// A line that is there already, on which an edge lies, so that it need not move outwards again; or null.
static const enf_view_line *find_line(const drawing *drawing, const double from[2], const double to[2]) {
    for (int k = 0; k < 2; k++)
        for (int32_t i = 0; drawing->known[k] && i < drawing->known[k]->line_count; i++) {
            const enf_view_line *l = &drawing->known[k]->lines[i];
            if (fabs(l->a * from[0] + l->b * from[1] + l->c) <= on_line &&
                fabs(l->a * to[0] + l->b * to[1] + l->c) <= on_line &&
                support(drawing->corners, drawing->count, l->a, l->b) <= l->c + on_line)
                return l;
        }
    return NULL;
}

/// (a, b) points inwards, at right angles to the edge.
static void draw_line(const drawing *drawing, const double from[2], const double to[2], double a, double b,
                      enf_view_line *line) {
    const enf_view_line *same = find_line(drawing, from, to);
    if (same) {
        *line = *same;
        return;
    }
    line->a = a;
    line->b = b;
    line->c = support(drawing->corners, drawing->count, a, b) + ENF_VIEW_SLACK;
}

/// The sides of the rectangle: they bound where the corners' lines don't.
static void draw_rectangle(enf_view_region *region, const drawing *drawing) {
    const double *r = region->rectangle;
    const double corners[4][2] = {{r[0], r[1]}, {r[2], r[1]}, {r[2], r[3]}, {r[0], r[3]}};
    static const double inward[4][2] = {{0, 1}, {-1, 0}, {0, -1}, {1, 0}};
    for (int i = 0; i < 4; i++)
        draw_line(drawing, corners[i], corners[(i + 1) % 4], inward[i][0], inward[i][1],
                  &region->lines[region->line_count++]);
}

/// A polygon that lost edges has grown, its rectangle has not. The line of a short edge may go anywhere, and
/// with the slack the lines of a sharp corner meet far away.
static void draw_lines(enf_view_region *region, const drawing *drawing, bool has_grown) {
    double shortest = INFINITY;
    for (int32_t i = 0; i < region->count; i++) {
        const double *from = region->corners[i], *to = region->corners[i + 1 < region->count ? i + 1 : 0];
        double u[2] = {to[0] - from[0], to[1] - from[1]}, length = sqrt(u[0] * u[0] + u[1] * u[1]);
        shortest = length < shortest ? length : shortest;
        bool has_length = length > 0;
        draw_line(drawing, from, to, has_length ? -u[1] / length : 1, has_length ? u[0] / length : 0,
                  &region->lines[i]);
    }
    region->line_count = region->count;
    const double *r = region->rectangle, wide = r[2] - r[0], high = r[3] - r[1];
    bool is_thin = !(region->area > thin_share * (wide * wide + high * high));
    if (has_grown || is_thin || shortest < short_edge) draw_rectangle(region, drawing);
}

void enf_region_make_rectangle(enf_view_region *region, const double r[4]) {
    const double corners[4][2] = {{r[0], r[1]}, {r[2], r[1]}, {r[2], r[3]}, {r[0], r[3]}};
    const enf_view_line lines[4] = {
        {1, 0, ENF_VIEW_SLACK - r[0], 0},
        {-1, 0, ENF_VIEW_SLACK + r[2], 0},
        {0, 1, ENF_VIEW_SLACK - r[1], 0},
        {0, -1, ENF_VIEW_SLACK + r[3], 0},
    };
    memmove(region->rectangle, r, sizeof region->rectangle);
    region->area = (r[2] - r[0]) * (r[3] - r[1]);
    region->count = region->line_count = 4;
    memcpy(region->corners, corners, sizeof corners);
    memcpy(region->lines, lines, sizeof lines);
}

/// A polygon seen from its edge is a line on the screen, or a point: a thin box around it.
static void make_thin(enf_view_region *region, const double (*corners)[2], int32_t count) {
    const double *from = corners[0], *to = corners[count - 1];
    double u[2] = {to[0] - from[0], to[1] - from[1]}, h = 0.5 * ENF_VIEW_SLACK;
    double length = sqrt(u[0] * u[0] + u[1] * u[1]);
    u[0] = length > 0 ? u[0] / length * h : h;
    u[1] = length > 0 ? u[1] / length * h : 0;
    const double box[4][2] = {{from[0] - u[0] + u[1], from[1] - u[1] - u[0]},
                              {to[0] + u[0] + u[1], to[1] + u[1] - u[0]},
                              {to[0] + u[0] - u[1], to[1] + u[1] + u[0]},
                              {from[0] - u[0] - u[1], from[1] - u[1] + u[0]}};
    memcpy(region->corners, box, sizeof box);
    region->count = 4;
    bound(box, 4, region->rectangle);
    region->area = fabs(enf_polygon_area(box, 4));
    const drawing drawing = {.corners = box, .count = 4};
    draw_lines(region, &drawing, false);
}

void enf_region_outline(enf_view_region *region, double (*corners)[2], int32_t count) {
    count = unite_same(corners, count);
    region->line_count = 0;
    if (count < 3) {
        make_thin(region, (const double(*)[2])corners, count);
        return;
    }
    bound((const double(*)[2])corners, count, region->rectangle);
    if (count > ENF_VIEW_EDGES_MAX) count = enf_polygon_simplify(corners, count, ENF_VIEW_EDGES_MAX);
    if (count > ENF_VIEW_EDGES_MAX) { // not convex
        enf_region_make_rectangle(region, region->rectangle);
        return;
    }
    region->count = count;
    memcpy(region->corners, corners, (size_t)count * sizeof *corners);
    region->area = enf_polygon_area((const double(*)[2])corners, count);
}

void enf_region_draw(enf_view_region *region, const enf_view_region *outer, const enf_view_region *other) {
    if (region->line_count > 0) return;
    const drawing drawing = {
        .corners = (const double(*)[2])region->corners, .count = region->count, .known = {outer, other}};
    draw_lines(region, &drawing, false);
}

int32_t enf_region_simplify(enf_view_region *region, const enf_view_region *from, int32_t edges_max) {
    double corners[ENF_VIEW_EDGES_MAX][2];
    memcpy(corners, from->corners, (size_t)from->count * sizeof *corners);
    int32_t count = enf_polygon_simplify(corners, from->count, edges_max);
    memcpy(region->rectangle, from->rectangle, sizeof region->rectangle);
    if (count > edges_max) { // not convex
        enf_region_make_rectangle(region, region->rectangle);
        return from->count - 4;
    }
    region->count = count;
    memcpy(region->corners, corners, (size_t)count * sizeof *corners);
    region->area = enf_polygon_area((const double(*)[2])corners, count);
    const drawing drawing = {
        .corners = (const double(*)[2])from->corners, .count = from->count, .known = {from, NULL}};
    draw_lines(region, &drawing, count < from->count);
    return from->count - count;
}

void enf_region_copy(enf_view_region *to, const enf_view_region *from) {
    memcpy(to->rectangle, from->rectangle, sizeof to->rectangle);
    to->area = from->area;
    to->count = from->count;
    to->line_count = from->line_count;
    memcpy(to->corners, from->corners, (size_t)from->count * sizeof *from->corners);
    memcpy(to->lines, from->lines, (size_t)from->line_count * sizeof *from->lines);
}

bool enf_region_contains(const enf_view_region *outer, const enf_view_region *inner) {
    const double *o = outer->rectangle, *i = inner->rectangle, h = ENF_VIEW_SLACK;
    if (!(i[0] >= o[0] - h && i[1] >= o[1] - h && i[2] <= o[2] + h && i[3] <= o[3] + h)) return false;
    for (int32_t line = 0; line < outer->line_count; line++) {
        const enf_view_line *l = &outer->lines[line];
        for (int32_t k = 0; k < inner->count; k++)
            if (!(l->a * inner->corners[k][0] + l->b * inner->corners[k][1] + l->c >= -on_line)) return false;
    }
    return true;
}

/// Right of from to, or on it?
static bool turns_right(const double from[2], const double to[2], const double point[2]) {
    return (to[0] - from[0]) * (point[1] - from[1]) - (to[1] - from[1]) * (point[0] - from[0]) <= 0;
}

/// To the nearest multiple of 2^-36, if it is on the screen or not far from it.
static double snap(double x) {
#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD == 0
    const double magic = 0x1.8p16; // its neighbours are that far away
    return (x + magic) - magic;
#else
    return nearbyint(x * 0x1p36) * 0x1p-36;
#endif
}

/// A. M. Andrew, "Another efficient algorithm for convex hulls in two dimensions", 1979. Corners that are the
/// same up to rounding would give turns that say nothing: so all are snapped to a grid, far finer than the
/// slack, whose steps are much larger than rounding.
int32_t enf_hull(double (*points)[2], int32_t count) {
    double chain[2 * ENF_VIEW_CORNERS + 2][2];
    if (count > ENF_VIEW_CORNERS) count = ENF_VIEW_CORNERS;
    for (int32_t i = 0; i < count; i++)
        for (int a = 0; a < 2; a++) points[i][a] = snap(points[i][a]);
    for (int32_t i = 1; i < count; i++) { // few, and often sorted
        double x = points[i][0], y = points[i][1];
        int32_t j = i;
        for (; j > 0 && (points[j - 1][0] > x || (points[j - 1][0] == x && points[j - 1][1] > y)); j--)
            memcpy(points[j], points[j - 1], sizeof *points);
        points[j][0] = x;
        points[j][1] = y;
    }
    int32_t made = 0;
    for (int32_t i = 0; i < count; i++) {
        while (made >= 2 && turns_right(chain[made - 2], chain[made - 1], points[i])) made--;
        memcpy(chain[made++], points[i], sizeof *points);
    }
    int32_t low = made + 1;
    for (int32_t i = count - 2; i >= 0; i--) {
        while (made >= low && turns_right(chain[made - 2], chain[made - 1], points[i])) made--;
        memcpy(chain[made++], points[i], sizeof *points);
    }
    if (made > 1) made--; // the first again
    if (made > count) made = count;
    memcpy(points, chain, (size_t)made * sizeof *points);
    return made;
}
