// SPDX-License-Identifier: GPL-3.0-or-later
// A hierarchy of boxes, halved at the median, and the usual test of T. Moeller and B. Trumbore, "Fast,
// minimum storage ray/triangle intersection", 1997, with triangles a hair larger so that seams are closed.
#include "cli/first_hit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEAF = 4, STACK = 128 };

static const double *corner(const first_hit_scene *scene, int32_t triangle, int k) {
    return scene->view->render_points[scene->view->triangles[triangle].point[k]];
}

static double middle(const first_hit_scene *scene, int32_t triangle, int axis) {
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += corner(scene, triangle, k)[axis];
    return sum;
}

static void bound(const first_hit_scene *scene, first_hit_node *node) {
    for (int a = 0; a < 3; a++) {
        node->min[a] = INFINITY;
        node->max[a] = -INFINITY;
    }
    for (int32_t i = node->first; i < node->first + node->count; i++)
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++) {
                double x = corner(scene, scene->triangles[i], k)[a];
                node->min[a] = fmin(node->min[a], x);
                node->max[a] = fmax(node->max[a], x);
            }
    for (int a = 0; a < 3; a++) { // rounding
        double more = 1e-9 * (fabs(node->min[a]) + fabs(node->max[a])) + 1e-30;
        node->min[a] -= more;
        node->max[a] += more;
    }
}

/// Puts the lesser half first (quickselect).
static void halve(first_hit_scene *scene, int32_t first, int32_t count, int axis) {
    int32_t low = first, high = first + count - 1, half = first + count / 2;
    int32_t *list = scene->triangles;
    while (low < high) {
        double pivot = middle(scene, list[(low + high) / 2], axis);
        int32_t i = low, j = high;
        while (i <= j) {
            while (middle(scene, list[i], axis) < pivot) i++;
            while (middle(scene, list[j], axis) > pivot) j--;
            if (i > j) break;
            int32_t swap = list[i];
            list[i++] = list[j];
            list[j--] = swap;
        }
        if (half <= j)
            high = j;
        else if (half >= i)
            low = i;
        else
            break;
    }
}

// NOLINTNEXTLINE(misc-no-recursion): halves
static void divide(first_hit_scene *scene, int32_t first, int32_t count) {
    first_hit_node *node = &scene->nodes[scene->node_count++];
    *node = (first_hit_node){.first = first, .count = count};
    bound(scene, node);
    if (count <= LEAF) return;
    int axis = 0;
    for (int a = 1; a < 3; a++)
        if (node->max[a] - node->min[a] > node->max[axis] - node->min[axis]) axis = a;
    halve(scene, first, count, axis);
    divide(scene, first, count / 2);
    node->first = scene->node_count;
    node->count = 0;
    divide(scene, first + count / 2, count - count / 2);
}

enf_status first_hit_create(first_hit_scene *scene, const enf_file_view *view, enf_error *error) {
    *scene = (first_hit_scene){.view = view, .seam = 1e-9};
    size_t count = (size_t)view->triangle_count;
    scene->triangles = malloc((count + 1) * sizeof *scene->triangles);
    scene->nodes = malloc((2 * count + 2) * sizeof *scene->nodes);
    if (!scene->triangles || !scene->nodes) {
        first_hit_free(scene);
        return enf_fail_memory(error, "boxes of triangles");
    }
    for (size_t i = 0; i < count; i++) scene->triangles[i] = (int32_t)i;
    if (count > 0) divide(scene, 0, (int32_t)count);
    return ENF_OK;
}

void first_hit_free(first_hit_scene *scene) {
    free(scene->nodes);
    free(scene->triangles);
    *scene = (first_hit_scene){0};
}

typedef struct ray {
    const double *origin, *direction;
    double inverse[3];
} ray;

static bool hits_box(const first_hit_node *node, const ray *ray, double least, double most) {
    for (int a = 0; a < 3; a++) {
        double s = (node->min[a] - ray->origin[a]) * ray->inverse[a];
        double t = (node->max[a] - ray->origin[a]) * ray->inverse[a];
        if (s != s || t != t) continue; // along a side
        least = fmax(least, fmin(s, t));
        most = fmin(most, fmax(s, t));
    }
    return least <= most * (1 + 1e-12);
}

/// The distance; infinite if it misses.
static double hit(const first_hit_scene *scene, const ray *ray, int32_t triangle, bool *front) {
    const double *o = corner(scene, triangle, 0), *p = corner(scene, triangle, 1);
    const double *q = corner(scene, triangle, 2), *d = ray->direction;
    double u[3], v[3], w[3];
    for (int a = 0; a < 3; a++) {
        u[a] = p[a] - o[a];
        v[a] = q[a] - o[a];
        w[a] = ray->origin[a] - o[a];
    }
    double h[3] = {d[1] * v[2] - d[2] * v[1], d[2] * v[0] - d[0] * v[2], d[0] * v[1] - d[1] * v[0]};
    double determinant = u[0] * h[0] + u[1] * h[1] + u[2] * h[2];
    double seam = scene->seam;
    if (determinant == 0) return INFINITY;
    double s = (w[0] * h[0] + w[1] * h[1] + w[2] * h[2]) / determinant;
    if (!(s >= -seam && s <= 1 + seam)) return INFINITY;
    double k[3] = {w[1] * u[2] - w[2] * u[1], w[2] * u[0] - w[0] * u[2], w[0] * u[1] - w[1] * u[0]};
    double t = (d[0] * k[0] + d[1] * k[1] + d[2] * k[2]) / determinant;
    if (!(t >= -seam && s + t <= 1 + seam)) return INFINITY;
    *front = determinant > 0;
    return (v[0] * k[0] + v[1] * k[1] + v[2] * k[2]) / determinant;
}

/// With a list: all hits up to `most`; without: the nearest.
static first_hit search(const first_hit_scene *scene, const ray *ray, double least, double most,
                        int32_t *list, int capacity, int *found) {
    first_hit best = {.t = most, .triangle = -1};
    int32_t stack[STACK];
    int depth = 0;
    if (scene->view->triangle_count > 0) stack[depth++] = 0;
    while (depth > 0) {
        int32_t index = stack[--depth];
        const first_hit_node *node = &scene->nodes[index];
        if (!hits_box(node, ray, least, best.t)) continue;
        if (node->count == 0) {
            bool second_first = false;
            if (depth + 2 > STACK) continue;
            const first_hit_node *a = &scene->nodes[index + 1], *b = &scene->nodes[node->first];
            double side = 0;
            for (int k = 0; k < 3; k++)
                side += (b->min[k] + b->max[k] - a->min[k] - a->max[k]) * ray->direction[k];
            second_first = side < 0;
            stack[depth++] = second_first ? index + 1 : node->first;
            stack[depth++] = second_first ? node->first : index + 1;
            continue;
        }
        for (int32_t i = node->first; i < node->first + node->count; i++) {
            bool front = false;
            double t = hit(scene, ray, scene->triangles[i], &front);
            if (!(t >= least && t <= best.t)) continue;
            if (list && *found < capacity) list[(*found)++] = scene->triangles[i];
            if (!list) best = (first_hit){.t = t, .triangle = scene->triangles[i], .front = front};
        }
    }
    return best;
}

static ray make_ray(const double origin[3], const double direction[3]) {
    ray ray = {.origin = origin, .direction = direction};
    for (int a = 0; a < 3; a++) ray.inverse[a] = 1 / direction[a];
    return ray;
}

first_hit first_hit_cast(const first_hit_scene *scene, const double origin[3], const double direction[3],
                         double least) {
    ray ray = make_ray(origin, direction);
    return search(scene, &ray, least, INFINITY, NULL, 0, NULL);
}

int first_hit_collect(const first_hit_scene *scene, const double origin[3], const double direction[3],
                      double least, double most, int32_t *triangles, int capacity) {
    ray ray = make_ray(origin, direction);
    int found = 0;
    search(scene, &ray, least, most, triangles, capacity, &found);
    return found;
}
