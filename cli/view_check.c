// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/view_check.h"

#include "cli/random.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TIES = 32, TRIES = 200 };

static double reach(const enf_file_view *view) {
    double most = 0;
    for (int a = 0; a < 3; a++) most = fmax(most, view->frame->box_max[a] - view->frame->box_min[a]);
    return most;
}

/// From triangles to cells: count, add up, fill.
static bool turn_lists(view_check *check) {
    const enf_file_view *view = check->view;
    check->triangle_first = calloc((size_t)view->triangle_count + 2, sizeof *check->triangle_first);
    check->triangle_cells = malloc(((size_t)view->cell_triangle_count + 1) * sizeof *check->triangle_cells);
    if (!check->triangle_first || !check->triangle_cells) return false;
    int32_t *first = check->triangle_first + 1;
    for (int64_t i = 0; i < view->cell_triangle_count; i++) first[view->cell_triangles[i]]++;
    for (int32_t i = 0, sum = 0; i < view->triangle_count; i++) {
        int32_t count = first[i];
        first[i] = sum;
        sum += count;
    }
    for (int32_t c = 0; c < view->cell_count; c++)
        for (int32_t k = 0; k < view->cells[c].triangle_count; k++)
            check->triangle_cells[first[view->cell_triangles[view->cells[c].triangle_first + k]]++] = c;
    return true; // the places of each triangle's end are those where the next one begins
}

enf_status view_check_create(view_check *check, const enf_world *world, uint64_t seed, enf_error *error) {
    *check = (view_check){.world = world, .view = enf_world_file(world), .seed = seed};
    enf_status status = first_hit_create(&check->scene, check->view, error);
    if (!status && !turn_lists(check)) status = enf_fail_memory(error, "lists of triangles");
    if (status) view_check_free(check);
    return status;
}

void view_check_free(view_check *check) {
    first_hit_free(&check->scene);
    free(check->triangle_first);
    free(check->triangle_cells);
    check->triangle_first = check->triangle_cells = NULL;
}

static void random_direction(uint64_t *seed, double direction[3]) {
    double square;
    do {
        square = 0;
        for (int a = 0; a < 3; a++) {
            direction[a] = 2 * cli_random_share(seed) - 1;
            square += direction[a] * direction[a];
        }
    } while (square > 1 || square < 0.01);
    for (int a = 0; a < 3; a++) direction[a] /= sqrt(square);
}

bool view_check_look(view_check *check, const double eye[3], check_camera *look) {
    const double fov = 1.3, aspect = 1.6;
    double forward[3], up[3], cosine;
    random_direction(&check->seed, forward);
    do {
        random_direction(&check->seed, up);
        cosine = forward[0] * up[0] + forward[1] * up[1] + forward[2] * up[2];
    } while (fabs(cosine) > 0.95);
    look->camera = enf_camera_look(eye, forward, up, fov, aspect);
    look->camera.viewport[0] = 1600;
    look->camera.viewport[1] = 1000;
    double tangent = tan(fov / 2), length = 0;
    for (int a = 0; a < 3; a++) {
        look->forward[a] = forward[a];
        up[a] -= cosine * forward[a];
        length += up[a] * up[a];
    }
    for (int a = 0; a < 3; a++) up[a] /= sqrt(length);
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        look->right[a] = (forward[b] * up[c] - forward[c] * up[b]) * tangent * aspect;
        look->up[a] = up[a] * tangent;
    }
    look->place = enf_world_locate(check->world, eye, -1);
    return look->place.cell >= 0;
}

bool view_check_random(view_check *check, check_camera *look) {
    const enf_file_view *view = check->view;
    for (int n = 0; n < TRIES && view->cell_count > 0; n++) {
        const enf_file_cell *cell =
            &view->cells[(int32_t)(cli_random_share(&check->seed) * view->cell_count)];
        double eye[3];
        for (int a = 0; a < 3; a++)
            eye[a] =
                cell->box_min[a] + cli_random_share(&check->seed) * (cell->box_max[a] - cell->box_min[a]);
        if (view_check_look(check, eye, look)) return true;
    }
    return false;
}

bool view_check_on_portal(view_check *check, int kind, check_camera *look) {
    const enf_file_view *view = check->view;
    if (view->portal_polygon_count == 0) return false;
    const enf_file_portal_polygon *polygon =
        &view->portal_polygons[(int32_t)(cli_random_share(&check->seed) * view->portal_polygon_count)];
    const double(*v)[3] = view->portal_vertices + polygon->vertex_first;
    int32_t i = (int32_t)(cli_random_share(&check->seed) * polygon->vertex_count);
    int32_t j = (i + 1) % polygon->vertex_count, k = (i + 2) % polygon->vertex_count;
    double s = kind == 0 || kind == 3 ? 0 : cli_random_share(&check->seed);
    double t = kind == 2 || kind == 4 ? cli_random_share(&check->seed) * (1 - s) : 0;
    double eye[3], away[3];
    random_direction(&check->seed, away);
    for (int a = 0; a < 3; a++) {
        eye[a] = v[i][a] + s * (v[j][a] - v[i][a]) + t * (v[k][a] - v[i][a]);
        if (kind >= 3)
            eye[a] += away[a] * pow(10, -2 - 12 * cli_random_share(&check->seed)) * 0.01 * reach(view);
    }
    return view_check_look(check, eye, look);
}

void view_check_direction(const check_camera *look, double x, double y, double direction[3]) {
    for (int a = 0; a < 3; a++) direction[a] = look->forward[a] + x * look->right[a] + y * look->up[a];
}

bool view_check_covers(const enf_view_entry *entry, double x, double y) {
    const double slack = 64 * ENF_VIEW_SLACK, *r = entry->rectangle;
    if (x < r[0] - slack || x > r[2] + slack || y < r[1] - slack || y > r[3] + slack) return false;
    for (int32_t i = 0; i < entry->vertex_count; i++) {
        const double *from = entry->vertices[i], *to = entry->vertices[(i + 1) % entry->vertex_count];
        double u[2] = {to[0] - from[0], to[1] - from[1]}, length = sqrt(u[0] * u[0] + u[1] * u[1]);
        if (u[0] * (y - from[1]) - u[1] * (x - from[0]) < -slack * length - 1e-12) return false;
    }
    return true;
}

/// 2: a listed cell has the triangle, in its region; 1: not in its region; 0: no such cell.
static int find(const view_check *check, const enf_visible *visible, int32_t triangle, double x, double y) {
    int best = 0;
    for (int32_t i = check->triangle_first[triangle]; i < check->triangle_first[triangle + 1]; i++)
        for (int32_t k = 0; k < visible->entry_count; k++) {
            const enf_view_entry *entry = &visible->entries[k];
            if (entry->cell != check->triangle_cells[i] || entry->space != 0) continue;
            if (view_check_covers(entry, x, y)) return 2;
            best = 1;
        }
    return best;
}

/// Is a polygon that near to the eye?
static bool is_near(const enf_file_view *view, const enf_file_portal_polygon *polygon, const double eye[3],
                    double distance) {
    const double *n = polygon->plane;
    const double(*v)[3] = view->portal_vertices + polygon->vertex_first;
    if (fabs(n[0] * eye[0] + n[1] * eye[1] + n[2] * eye[2] + n[3]) > distance) return false;
    for (int32_t i = 0; i < polygon->vertex_count; i++) {
        const double *p = v[i], *q = v[(i + 1) % polygon->vertex_count];
        double side = 0, length = 0;
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, c = (a + 2) % 3;
            side += n[a] * ((q[b] - p[b]) * (eye[c] - p[c]) - (q[c] - p[c]) * (eye[b] - p[b]));
            length += (q[a] - p[a]) * (q[a] - p[a]);
        }
        if (side < -distance * sqrt(length)) return false;
    }
    return true;
}

/// An eye on an edge of a wall touches cells with which its own cell has nothing to do there: is the ray's
/// first cell linked with the eye's by portals at the eye?
static bool begins_here(const view_check *check, const check_camera *look, const double direction[3]) {
    const enf_file_view *view = check->view;
    double point[3], step = 1e-9 * reach(view);
    for (int a = 0; a < 3; a++) point[a] = look->camera.eye[a] + step * direction[a];
    int32_t cell = enf_world_locate(check->world, point, look->place.tetrahedron).cell;
    int32_t cells[TIES] = {look->place.cell};
    for (int i = 0, count = 1; i < count; i++) {
        if (cells[i] == cell) return true;
        for (int32_t k = 0; k < view->cells[cells[i]].portal_count; k++) {
            const enf_file_portal *p =
                &view->portals[view->cell_portals[view->cells[cells[i]].portal_first + k]];
            bool touches = false, known = false;
            for (int32_t n = 0; n < p->polygon_count && !touches; n++)
                touches = is_near(view, &view->portal_polygons[p->polygon_first + n], look->camera.eye, step);
            for (int n = 0; n < count; n++) known = known || cells[n] == p->to;
            if (touches && !known && count < TIES) cells[count++] = p->to;
        }
    }
    return false;
}

/// Is the cell in which the ray ends listed with the pixel? Then the file's lists of triangles are to blame.
static bool ends_in_view(const view_check *check, const check_camera *look, const enf_visible *visible,
                         first_hit hit, double x, double y, const double direction[3]) {
    double point[3];
    for (int a = 0; a < 3; a++) point[a] = look->camera.eye[a] + hit.t * (1 - 1e-7) * direction[a];
    int32_t cell = enf_world_locate(check->world, point, -1).cell;
    for (int32_t i = 0; i < visible->entry_count; i++)
        if (visible->entries[i].cell == cell && view_check_covers(&visible->entries[i], x, y)) return true;
    return false;
}

static void tell(const view_check *check, const check_camera *look, double x, double y, first_hit hit,
                 int found, const double d[3]) {
    if (!check->talks) return;
    const double *e = look->camera.eye;
    printf("  miss (%s): direction %.17g %.17g %.17g eye %.17g %.17g %.17g cell %" PRId32
           ", screen %.9g %.9g, triangle %" PRId32 " at %.9g\n",
           found ? "region" : "cell", d[0], d[1], d[2], e[0], e[1], e[2], look->place.cell, x, y,
           hit.triangle, hit.t);
}

int64_t view_check_rays(view_check *check, const check_camera *look, const enf_visible *visible, int rays) {
    int64_t before = check->missed_cells + check->missed_regions;
    double least = 1e-12 * reach(check->view);
    for (int n = 0; n < rays; n++) {
        double x = 2 * cli_random_share(&check->seed) - 1, y = 2 * cli_random_share(&check->seed) - 1, d[3];
        view_check_direction(look, x, y, d);
        first_hit hit = first_hit_cast(&check->scene, look->camera.eye, d, least);
        check->rays++;
        check->lost += hit.triangle < 0;
        check->backs += hit.triangle >= 0 && !hit.front;
        if (hit.triangle < 0 || !hit.front) continue;
        check->hits++;
        int found = find(check, visible, hit.triangle, x, y);
        if (found == 2) continue;
        int32_t ties[TIES];
        int count = first_hit_collect(&check->scene, look->camera.eye, d, hit.t * (1 - 1e-9) - 1e3 * least,
                                      hit.t * (1 + 1e-9) + 1e3 * least, ties, TIES);
        for (int i = 0; i < count && found < 2; i++) {
            int now = find(check, visible, ties[i], x, y);
            found = now > found ? now : found;
        }
        if (found == 2) continue;
        first_hit_scene strict = check->scene;
        strict.seam = 0;
        if (first_hit_cast(&strict, look->camera.eye, d, least).triangle != hit.triangle) {
            check->seams++;
            continue;
        }
        if (!begins_here(check, look, d)) {
            check->elsewhere++;
            continue;
        }
        if (ends_in_view(check, look, visible, hit, x, y, d)) {
            check->unlisted++;
            continue;
        }
        check->missed_cells += found == 0;
        check->missed_regions += found == 1;
        tell(check, look, x, y, hit, found, d);
    }
    return check->missed_cells + check->missed_regions - before;
}
