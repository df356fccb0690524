// SPDX-License-Identifier: GPL-3.0-or-later
// What is drawn: the input's own points, normals and texture coordinates, cut into triangles, and for each
// cell the triangles whose front it sees. A convex polygon keeps all its corners and becomes a fan; where
// clean had to cut a polygon, its pieces are mapped back to the input's corners.
#include "build/write_parts.h"

#include "base/array.h"
#include "format/locate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct drawer {
    enf_build_image *image;
    const enf_build *build;
    enf_error *error;

    double (*points)[3]; ///< the input's, then those that only clean knows
    size_t point_count, point_capacity;
    enf_file_triangle *triangles;
    size_t triangle_count, triangle_capacity;
    int32_t *pieces_of;        ///< per soup polygon: how many clean polygons came of it
    int32_t *polygon_triangle; ///< per clean polygon, + 1: offsets into triangles

    int32_t *list; ///< cell_triangles
    size_t list_count, list_capacity;
    enf_status status;
} drawer;

static bool out_of_memory(drawer *d) {
    d->status = enf_fail_memory(d->error, "the triangles");
    return false;
}

/// What a file can hold: no polygon uses the others.
static double finite_or_zero(double value) {
    return fabs(value) <= 0x1p1000 ? value : 0;
}

// --- Triangles
// ---------------------------------------------------------------------------------------------------

/// A corner to draw: where it is, and the soup corner that it looks like.
typedef struct render_corner {
    int32_t point; ///< render point; -1: no memory
    int64_t looks;
} render_corner;

static const double *soup_corner_point(const enf_soup *soup, int64_t corner) {
    return soup->points + 3 * (size_t)soup->corner_point[corner];
}

static render_corner own_corner(const drawer *d, int64_t corner) {
    return (render_corner){d->build->soup.corner_point[corner], corner};
}

static bool add_triangle(drawer *d, const render_corner corners[3], int32_t polygon, int32_t mesh_polygon) {
    const enf_soup *soup = &d->build->soup;
    if (d->triangle_count >= INT32_MAX - 1 ||
        !enf_array_reserve(d->triangles, d->triangle_capacity, d->triangle_count + 1))
        return out_of_memory(d);
    enf_file_triangle *out = &d->triangles[d->triangle_count];
    for (int k = 0; k < 3; k++) {
        out->point[k] = corners[k].point;
        out->normal[k] = soup->corner_normal ? soup->corner_normal[corners[k].looks] : -1;
        out->texcoord[k] = soup->corner_texcoord ? soup->corner_texcoord[corners[k].looks] : -1;
    }
    if (out->point[0] == out->point[1] || out->point[1] == out->point[2] || out->point[2] == out->point[0])
        return true; // the input repeats a corner
    out->polygon = polygon;
    out->group = soup->polygon_group[polygon];
    out->material = soup->polygon_material[polygon];
    out->mesh_polygon = mesh_polygon;
    out->cell = -1;
    d->triangle_count++;
    return true;
}

/// The area vector of the triangle between three soup corners.
static void corner_area(const enf_soup *soup, const int64_t corners[3], double area[3]) {
    const double *p = soup_corner_point(soup, corners[0]), *q = soup_corner_point(soup, corners[1]),
                 *r = soup_corner_point(soup, corners[2]);
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        area[a] = (q[b] - p[b]) * (r[c] - p[c]) - (q[c] - p[c]) * (r[b] - p[b]);
    }
}

/// True if the fan from the first corner covers the polygon without folding back.
static bool is_fan(const enf_soup *soup, int32_t polygon) {
    int64_t first = soup->polygon_corner[polygon], end = soup->polygon_corner[polygon + 1];
    double sum[3] = {0, 0, 0}, area[3];
    for (int64_t k = first + 1; k + 1 < end; k++) {
        corner_area(soup, (const int64_t[3]){first, k, k + 1}, area);
        for (int a = 0; a < 3; a++) sum[a] += area[a];
    }
    for (int64_t k = first + 1; k + 1 < end; k++) {
        corner_area(soup, (const int64_t[3]){first, k, k + 1}, area);
        if (!(area[0] * sum[0] + area[1] * sum[1] + area[2] * sum[2] >= 0)) return false;
    }
    return true;
}

static bool add_fan(drawer *d, int32_t polygon, int32_t mesh_polygon) {
    const enf_soup *soup = &d->build->soup;
    int64_t first = soup->polygon_corner[polygon], end = soup->polygon_corner[polygon + 1];
    for (int64_t k = first + 1; k + 1 < end; k++) {
        const render_corner corners[3] = {own_corner(d, first), own_corner(d, k), own_corner(d, k + 1)};
        if (!add_triangle(d, corners, polygon, mesh_polygon)) return false;
    }
    return true;
}

static double squared_distance(const double p[3], const double q[3]) {
    double sum = 0;
    for (int a = 0; a < 3; a++) sum += (p[a] - q[a]) * (p[a] - q[a]);
    return sum;
}

/// The corner that a clean point stands for: the polygon's nearest, if clean can have moved it that far.
/// Otherwise a new render point that looks like it.
static render_corner match_corner(drawer *d, int32_t polygon, int32_t point) {
    const enf_soup *soup = &d->build->soup;
    const enf_mesh *mesh = &d->build->mesh;
    double world[3], best = INFINITY;
    int64_t found = soup->polygon_corner[polygon];
    enf_frame_to_world(&mesh->frame, &mesh->points[3 * (size_t)point], world);
    for (int64_t k = found; k < soup->polygon_corner[polygon + 1]; k++) {
        double distance = squared_distance(soup_corner_point(soup, k), world);
        if (distance >= best) continue;
        best = distance;
        found = k;
    }
    if (sqrt(best) <= mesh->displacement_max) return own_corner(d, found);
    if (d->point_count >= INT32_MAX - 1 ||
        !enf_array_reserve(d->points, d->point_capacity, d->point_count + 1)) {
        out_of_memory(d);
        return (render_corner){-1, found};
    }
    memcpy(d->points[d->point_count], world, sizeof world);
    return (render_corner){(int32_t)d->point_count++, found};
}

/// The fan of a clean polygon, which is convex, between the input's corners.
static bool add_mapped(drawer *d, int32_t polygon, int32_t mesh_polygon) {
    const enf_mesh *mesh = &d->build->mesh;
    int64_t first = mesh->polygon_corner[mesh_polygon],
            count = mesh->polygon_corner[mesh_polygon + 1] - first;
    render_corner apex = {0, 0}, last = {0, 0};
    for (int64_t k = 0; k < count; k++) {
        render_corner corner = match_corner(d, polygon, mesh->corners[first + k]);
        if (corner.point < 0) return false;
        const render_corner turning[3] = {apex, last, corner}, mirrored[3] = {apex, corner, last};
        if (k >= 2 &&
            !add_triangle(d, mesh->frame.handedness < 0 ? mirrored : turning, polygon, mesh_polygon))
            return false;
        if (k == 0) apex = corner;
        last = corner;
    }
    return true;
}

static bool add_polygons(drawer *d) {
    const enf_mesh *mesh = &d->build->mesh;
    const enf_soup *soup = &d->build->soup;
    d->pieces_of = enf_array_zeroed(soup->polygon_count, sizeof *d->pieces_of);
    d->polygon_triangle = enf_array_zeroed(mesh->polygon_count + 1, sizeof *d->polygon_triangle);
    if (!d->pieces_of || !d->polygon_triangle) return out_of_memory(d);
    for (size_t i = 0; i < mesh->polygon_count; i++) d->pieces_of[mesh->polygon_source[i]]++;
    for (int32_t i = 0; i < (int32_t)mesh->polygon_count; i++) {
        int32_t polygon = mesh->polygon_source[i];
        bool whole = d->pieces_of[polygon] == 1 && is_fan(soup, polygon);
        if (!(whole ? add_fan(d, polygon, i) : add_mapped(d, polygon, i))) return false;
        d->polygon_triangle[i + 1] = (int32_t)d->triangle_count;
    }
    for (size_t i = 0; i < mesh->detail_count; i++) {
        if (!add_fan(d, mesh->details[i], -1)) return false;
    }
    return true;
}

// --- What cells see
// ----------------------------------------------------------------------------------------------

/// Groups 0..count-1 by owner (-1: none): *offset has owners + 1 entries. Both results are malloced.
static bool group_by(const int32_t *owner, int32_t count, int32_t owners, int32_t **offset,
                     int32_t **members) {
    *offset = enf_array_zeroed((size_t)owners + 2, sizeof **offset);
    *members = enf_array_new((size_t)count, sizeof **members);
    if (!*offset || !*members) return false;
    int32_t *place = *offset + 1; // shifted by one while filling
    for (int32_t i = 0; i < count; i++) {
        if (owner[i] >= 0) place[owner[i] + 1]++;
    }
    for (int32_t i = 0; i < owners; i++) place[i + 1] += place[i];
    for (int32_t i = 0; i < count; i++) {
        if (owner[i] >= 0) (*members)[place[owner[i]]++] = i;
    }
    return true;
}

static int compare_int32(const void *a, const void *b) {
    int32_t p = *(const int32_t *)a, q = *(const int32_t *)b;
    return (p > q) - (p < q);
}

static bool append(drawer *d, int32_t triangle) {
    if (!enf_array_reserve(d->list, d->list_capacity, d->list_count + 1)) return out_of_memory(d);
    d->list[d->list_count++] = triangle;
    return true;
}

/// The different clean polygons that a cell sees.
typedef struct seen_list {
    int32_t *stamp; ///< per polygon: the last cell that sees it, + 1
    int32_t *found;
    size_t count;
    int32_t mark;
} seen_list;

static void note_seen(const enf_complex *complex, int32_t fine, seen_list *list) {
    for (int64_t k = complex->seen_offset[fine]; k < complex->seen_offset[fine + 1]; k++) {
        int32_t polygon = complex->seen[k];
        if (list->stamp[polygon] == list->mark) continue;
        list->stamp[polygon] = list->mark;
        list->found[list->count++] = polygon;
    }
}

/// What a fine cell's neighbours behind sealed cracks see: those are thinner than the tolerance, and what is
/// in them stands on the seal.
static void note_behind_seals(const enf_complex *complex, int32_t fine, seen_list *list) {
    for (int32_t i = complex->cell_facet[fine]; i < complex->cell_facet[fine + 1]; i++) {
        const int32_t facet = complex->cell_facets[i];
        for (int32_t p = complex->facet_piece[facet]; p < complex->facet_piece[facet + 1]; p++) {
            if (complex->piece_cover[p] != ENF_PIECE_SEALED) continue;
            const int32_t *sides = complex->facet_cell[facet], other = sides[sides[0] == fine];
            if (other >= 0) note_seen(complex, other, list);
        }
    }
}

/// The triangles of the polygons that a cell's fine cells see, ascending.
static bool list_seen(drawer *d, const int32_t *fine, int32_t fine_count, seen_list *list) {
    list->count = 0;
    list->mark++;
    for (int32_t i = 0; i < fine_count; i++) {
        note_seen(&d->build->complex, fine[i], list);
        if (d->build->regions.sealed > 0) note_behind_seals(&d->build->complex, fine[i], list);
    }
    qsort(list->found, list->count, sizeof *list->found, compare_int32);
    for (size_t i = 0; i < list->count; i++) {
        const int32_t polygon = list->found[i];
        for (int32_t t = d->polygon_triangle[polygon]; t < d->polygon_triangle[polygon + 1]; t++) {
            if (!append(d, t)) return false;
        }
    }
    return true;
}

// --- Detail
// ------------------------------------------------------------------------------------------------------

typedef struct detail {
    int32_t cell, triangle;
} detail;

typedef struct detail_finder {
    drawer *d;
    int32_t *stack; ///< nodes to visit
    int32_t *stamp; ///< per cell: the last triangle noted for it, + 1
    detail *details;
    size_t detail_count, detail_capacity;
} detail_finder;

/// True if all `count` points lie outside of one face of the tetrahedron, by more than rounding can explain.
static bool is_apart(const enf_file_view *view, const int32_t tetrahedron[4], const double (*at)[3],
                     int count) {
    for (int face = 0; face < 4; face++) {
        const double *p = view->points[tetrahedron[(face + 1) % 4]],
                     *q = view->points[tetrahedron[(face + 2) % 4]],
                     *r = view->points[tetrahedron[(face + 3) % 4]],
                     *inside = view->points[tetrahedron[face]];
        double normal[3], length = 0, depth = 0;
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, c = (a + 2) % 3;
            normal[a] = (q[b] - p[b]) * (r[c] - p[c]) - (q[c] - p[c]) * (r[b] - p[b]);
            length += normal[a] * normal[a];
            depth += normal[a] * (inside[a] - p[a]);
        }
        double limit = view->frame->locate_rounding * sqrt(length), sign = depth > 0 ? 1 : -1;
        int outside = 0;
        for (int i = 0; i < count; i++) {
            double side = 0;
            for (int a = 0; a < 3; a++) side += normal[a] * (at[i][a] - p[a]);
            outside += sign * side < -limit;
        }
        if (outside == count) return true;
    }
    return false;
}

/// The cells of all leaves of a tetrahedron's tree.
static bool note_cells(detail_finder *f, int32_t tetrahedron, int32_t triangle) {
    const enf_build *build = f->d->build;
    size_t depth = 0;
    f->stack[depth++] = build->complex.tetrahedron_root[tetrahedron];
    while (depth > 0) {
        int32_t at = f->stack[--depth];
        if (at >= 0) {
            for (int side = 0; side < 2; side++) f->stack[depth++] = build->complex.node_child[at][side];
            continue;
        }
        int32_t cell = build->cell_of[-1 - at];
        if (cell < 0 || f->stamp[cell] == triangle + 1) continue;
        f->stamp[cell] = triangle + 1;
        if (!enf_array_reserve(f->details, f->detail_capacity, f->detail_count + 1))
            return out_of_memory(f->d);
        f->details[f->detail_count++] = (detail){cell, triangle};
    }
    return true;
}

/// Notes every cell that a detail triangle may touch (rather one too many), and the one that holds its
/// middle.
static bool find_cells(detail_finder *f, int32_t index) {
    const enf_file_view *view = &f->d->image->view;
    enf_file_triangle *triangle = &f->d->triangles[index];
    double at[3][3], low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    double middle[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        const double *world = f->d->points[triangle->point[k]];
        enf_frame_to_grid(&f->d->build->mesh.frame, world, at[k]);
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], at[k][a]);
            high[a] = fmax(high[a], at[k][a]);
            middle[a] += world[a] / 3;
        }
    }
    triangle->cell = enf_view_locate(view, middle, -1).cell;
    for (int32_t i = 0; i < view->box_count;) {
        const enf_file_box *box = &view->boxes[i];
        bool meets = true;
        for (int a = 0; a < 3; a++)
            meets = meets && low[a] <= (double)box->max[a] && high[a] >= (double)box->min[a];
        i = meets ? i + 1 : box->next;
        if (!meets || box->tetrahedron < 0) continue;
        for (int32_t t = box->tetrahedron; t < enf_file_box_end(box, view->tetrahedron_count); t++) {
            if (is_apart(view, view->tetrahedra[t], (const double(*)[3])at, 3)) continue;
            if (!note_cells(f, t, index)) return false;
        }
    }
    return true;
}

static int compare_details(const void *a, const void *b) {
    const detail *p = a, *q = b;
    if (p->cell != q->cell) return p->cell < q->cell ? -1 : 1;
    return (p->triangle > q->triangle) - (p->triangle < q->triangle);
}

static bool find_details(detail_finder *f) {
    drawer *d = f->d;
    int32_t first = d->polygon_triangle[d->build->mesh.polygon_count], count = (int32_t)d->triangle_count;
    if (first == count) return true;
    const enf_complex *complex = &d->build->complex;
    f->stamp = enf_array_zeroed((size_t)d->build->cell_count, sizeof *f->stamp);
    f->stack = enf_array_new((size_t)complex->node_count + 1, sizeof *f->stack);
    if (!f->stamp || !f->stack) return out_of_memory(d);
    for (int32_t i = first; i < count; i++) {
        if (!find_cells(f, i)) return false;
    }
    if (f->detail_count) qsort(f->details, f->detail_count, sizeof *f->details, compare_details);
    return true;
}

static bool list_cells(drawer *d, const detail_finder *f, const int32_t *fine_offset, const int32_t *fine,
                       seen_list *list) {
    enf_file_view *view = &d->image->view;
    enf_file_cell *cells = (enf_file_cell *)view->cells; // the image's own
    size_t next = 0;
    for (int32_t i = 0; i < view->cell_count; i++) {
        cells[i].triangle_first = (int64_t)d->list_count;
        if (!list_seen(d, fine + fine_offset[i], fine_offset[i + 1] - fine_offset[i], list)) return false;
        for (; next < f->detail_count && f->details[next].cell == i; next++) {
            if (!append(d, f->details[next].triangle)) return false;
        }
        cells[i].triangle_count = (int32_t)((int64_t)d->list_count - cells[i].triangle_first);
    }
    return true;
}

static bool list_triangles(drawer *d) {
    const enf_build *build = d->build;
    detail_finder finder = {.d = d};
    int32_t *offset = NULL, *fine = NULL;
    seen_list list = {.stamp = enf_array_zeroed(build->mesh.polygon_count, sizeof *list.stamp),
                      .found = enf_array_new(build->mesh.polygon_count, sizeof *list.found)};
    bool good = list.stamp && list.found;
    good = good && group_by(build->cell_of, build->complex.cell_count, build->cell_count, &offset, &fine);
    if (!good) out_of_memory(d);
    good = good && find_details(&finder) && list_cells(d, &finder, offset, fine, &list);
    free(offset);
    free(fine);
    free(list.stamp);
    free(list.found);
    free(finder.stack);
    free(finder.stamp);
    free(finder.details);
    return good;
}

// --- The whole
// ---------------------------------------------------------------------------------------------------

static bool copy_points(drawer *d) {
    const enf_soup *soup = &d->build->soup;
    if (!enf_array_reserve(d->points, d->point_capacity, soup->point_count + 1)) return out_of_memory(d);
    for (size_t i = 0; i < 3 * soup->point_count; i++)
        d->points[i / 3][i % 3] = finite_or_zero(soup->points[i]);
    d->point_count = soup->point_count;
    return true;
}

/// Normals and texture coordinates as read, without what is not a number.
static double *copy_looks(drawer *d, const double *values, size_t count) {
    double *copy = enf_build_image_new(d->image, count, sizeof *copy);
    if (!copy) out_of_memory(d);
    for (size_t i = 0; copy && i < count; i++) copy[i] = finite_or_zero(values[i]);
    return copy;
}

static const uint32_t *add_names(drawer *d, char **names, size_t count, enf_build_image_strings *strings) {
    uint32_t *offsets = enf_build_image_new(d->image, count, sizeof *offsets);
    for (size_t i = 0; offsets && i < count; i++) {
        if (!enf_build_image_add_string(strings, names[i], &offsets[i])) offsets = NULL;
    }
    if (!offsets) out_of_memory(d);
    return offsets;
}

static void set_view(drawer *d, enf_build_image_strings *strings) {
    enf_file_view *view = &d->image->view;
    const enf_soup *soup = &d->build->soup;
    view->render_points = (void *)d->points;
    view->render_point_count = (int32_t)d->point_count;
    view->render_normals = (void *)copy_looks(d, soup->normals, 3 * soup->normal_count);
    view->render_normal_count = (int32_t)soup->normal_count;
    view->render_texcoords = (void *)copy_looks(d, soup->texcoords, 2 * soup->texcoord_count);
    view->render_texcoord_count = (int32_t)soup->texcoord_count;
    view->triangles = d->triangles;
    view->triangle_count = (int32_t)d->triangle_count;
    view->cell_triangles = d->list;
    view->cell_triangle_count = (int64_t)d->list_count;
    view->group_names = add_names(d, soup->groups, soup->group_count, strings);
    view->group_count = (int32_t)soup->group_count;
    view->material_names = add_names(d, soup->materials, soup->material_count, strings);
    view->material_count = (int32_t)soup->material_count;
    view->has_geometry = true;
}

enf_status enf_build_image_draw(enf_build_image *image, const enf_build *build,
                                enf_build_image_strings *strings, enf_error *error) {
    drawer d = {.image = image, .build = build, .error = error, .status = ENF_OK};
    if (copy_points(&d) && add_polygons(&d) && list_triangles(&d)) set_view(&d, strings);
    enf_build_image_own(image, d.points);
    enf_build_image_own(image, d.triangles);
    enf_build_image_own(image, d.list);
    free(d.pieces_of);
    free(d.polygon_triangle);
    return d.status;
}
