// SPDX-License-Identifier: GPL-3.0-or-later
// Clean, in this order:
//   1 judge      polygons of excluded groups and with corners that are missing, not finite or beyond 1e100
//   go;
//                polygons of detail groups are set aside
//   2 turn       a world that a rotation has touched is turned back, so that most of its area is
//   axis-parallel
//                (turn.c)
//   3 flatten    axis-parallel planes that rounding has torn become planes again (flatten.c). Turned or not,
//   no
//                point is more than `plane_tolerance` from where it was (default 2e-7 of the diagonal of the
//                points' box, more than single precision takes from a world around its origin)
//   4 frame      the canonical axes and the grid step follow from the points (and polygons) in use (frame.c)
//   5 round      every point to the nearest grid point
//   6 weld       points within `weld` of an earlier one, in grid order, join it (default 1e-9 of the
//   diagonal;
//                weld.c)
//   7 polygons   repeated and collinear corners go; what is planar and convex stays whole, the rest becomes
//                triangles (ring.c, triangulate.c)
//   8 duplicates of polygons with the same corners in the same order one stays
//   9 order      points and polygons are numbered by their coordinates
// Everything after step 1 depends on the set of polygons only, not on their order or on where their lists
// begin.
#include "build/clean.h"

#include "base/array.h"
#include "build/frame.h"
#include "build/pieces.h"
#include "build/recover.h"
#include "build/ring.h"
#include "build/triangulate.h"
#include "build/weld.h"

#include <fnmatch.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LARGEST_COORDINATE 1e100 ///< volumes and their sums stay finite

enum { CUTS, IS_DETAIL, IS_EXCLUDED };

typedef struct cleaner {
    enf_mesh *mesh;
    enf_soup *soup;
    const enf_clean_options *options;
    enf_error *error;
    unsigned char *group_fate; ///< per group
    int32_t *cutting;          ///< soup polygons that cut and have passed step 1
    size_t cutting_count;

    int32_t *final_of; ///< per soup point: its point in `points`, or -1
    double *points;    ///< grid points after step 6, in order
    size_t point_count;

    enf_pieces pieces;
    int32_t *ring; ///< scratch for one polygon
    int32_t (*triangles)[3];
    size_t ring_capacity, triangle_capacity;
} cleaner;

static bool reject(cleaner *c, enf_reject reason, size_t polygon) {
    return enf_soup_reject(c->soup, reason, c->soup->polygon_file[polygon], c->soup->polygon_line[polygon],
                           (int32_t)polygon);
}

// ---- step 1: judge

/// True if the glob matches the whole name, or the part before or after any of its slashes.
static bool glob_matches(const char *glob, const char *name, char *scratch) {
    if (fnmatch(glob, name, 0) == 0) return true;
    strcpy(scratch, name);
    for (char *slash = strchr(scratch, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = 0;
        bool matches = fnmatch(glob, scratch, 0) == 0 || fnmatch(glob, name + (slash - scratch) + 1, 0) == 0;
        *slash = '/';
        if (matches) return true;
    }
    return false;
}

static bool any_glob_matches(const char *const *globs, size_t count, const char *name, char *scratch) {
    for (size_t i = 0; i < count; i++)
        if (glob_matches(globs[i], name, scratch)) return true;
    return false;
}

static enf_status judge_groups(cleaner *c) {
    const enf_clean_options *options = c->options;
    c->group_fate = enf_array_zeroed(c->soup->group_count, sizeof *c->group_fate);
    if (!c->group_fate) return enf_fail_memory(c->error, "the groups");
    if (options->exclude_count + options->detail_count == 0) return ENF_OK;
    for (size_t g = 0; g < c->soup->group_count; g++) {
        const char *name = c->soup->groups[g];
        char *scratch = enf_array_new(strlen(name) + 1, 1);
        if (!scratch) return enf_fail_memory(c->error, "the groups");
        if (any_glob_matches(options->exclude, options->exclude_count, name, scratch))
            c->group_fate[g] = IS_EXCLUDED;
        else if (any_glob_matches(options->detail, options->detail_count, name, scratch))
            c->group_fate[g] = IS_DETAIL;
        free(scratch);
    }
    return ENF_OK;
}

/// Why a polygon cannot be used, or ENF_REJECT_COUNT if it can.
static enf_reject judge_corners(const enf_soup *soup, size_t polygon) {
    enf_reject reason = ENF_REJECT_COUNT;
    for (int64_t i = soup->polygon_corner[polygon]; i < soup->polygon_corner[polygon + 1]; i++) {
        int32_t point = soup->corner_point[i];
        if (point < 0 || (size_t)point >= soup->point_count) return ENF_REJECT_INDEX_RANGE;
        for (int a = 0; a < 3; a++) {
            double x = soup->points[3 * (size_t)point + a];
            if (!isfinite(x))
                reason = ENF_REJECT_NOT_FINITE;
            else if (fabs(x) > LARGEST_COORDINATE && reason == ENF_REJECT_COUNT)
                reason = ENF_REJECT_TOO_LARGE;
        }
    }
    return reason;
}

static enf_status judge_polygons(cleaner *c) {
    const enf_soup *soup = c->soup;
    c->cutting = enf_array_new(soup->polygon_count, sizeof *c->cutting);
    c->mesh->details = enf_array_new(soup->polygon_count, sizeof *c->mesh->details);
    if (!c->cutting || !c->mesh->details) return enf_fail_memory(c->error, "the polygons");
    for (size_t p = 0; p < soup->polygon_count; p++) {
        size_t group = (size_t)soup->polygon_group[p];
        int fate = soup->polygon_group[p] >= 0 && group < soup->group_count ? c->group_fate[group] : CUTS;
        enf_reject reason = fate == IS_EXCLUDED ? ENF_REJECT_EXCLUDED : judge_corners(soup, p);
        if (reason != ENF_REJECT_COUNT) {
            if (!reject(c, reason, p)) return enf_fail_memory(c->error, "the list of rejections");
        } else if (fate == IS_DETAIL) {
            c->mesh->details[c->mesh->detail_count++] = (int32_t)p;
        } else {
            c->cutting[c->cutting_count++] = (int32_t)p;
        }
    }
    return ENF_OK;
}

// ---- steps 2 to 6: points

/// Sets final_of to 0, 1, ... for the points that the cutting polygons use. Returns their number.
static size_t number_used_points(cleaner *c) {
    const enf_soup *soup = c->soup;
    memset(c->final_of, -1, soup->point_count * sizeof *c->final_of);
    size_t used = 0;
    for (size_t k = 0; k < c->cutting_count; k++) {
        int32_t p = c->cutting[k];
        for (int64_t i = soup->polygon_corner[p]; i < soup->polygon_corner[p + 1]; i++) {
            int32_t *number = &c->final_of[soup->corner_point[i]];
            if (*number < 0) *number = (int32_t)used++;
        }
    }
    return used;
}

/// map[i] = through[map[i]] for all i that map to something.
static void compose(int32_t *map, size_t count, const int32_t *through) {
    for (size_t i = 0; i < count; i++)
        if (map[i] >= 0) map[i] = through[map[i]];
}

/// Sorts the sites, makes equal ones one, renumbers them by their order, and follows that in final_of.
static size_t unite(cleaner *c, enf_site *sites, size_t count, int32_t *scratch) {
    enf_sites_sort(sites, count);
    size_t groups = enf_sites_unite(sites, count, scratch);
    compose(c->final_of, c->soup->point_count, scratch);
    for (size_t i = 0; i < groups; i++) sites[i].id = (int32_t)i;
    return groups;
}

/// Keeps those sites that joined none.
static size_t weld(cleaner *c, enf_site *sites, size_t count, double distance, int32_t *joined_to,
                   int32_t *kept_as, enf_status *status) {
    *status = enf_sites_weld(sites, count, distance, joined_to, c->error);
    if (*status != ENF_OK) return 0;
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        bool representative = joined_to[i] == (int32_t)i;
        kept_as[i] = representative ? (int32_t)kept : kept_as[joined_to[i]];
        if (!representative) continue;
        sites[kept] = sites[i];
        sites[kept].id = (int32_t)kept;
        kept++;
    }
    compose(c->final_of, c->soup->point_count, kept_as);
    return kept;
}

/// How far the used points moved, in all, in world units.
static void measure_displacement(cleaner *c) {
    const enf_frame *frame = &c->mesh->frame;
    double largest = 0, sum = 0;
    size_t used = 0;
    for (size_t p = 0; p < c->soup->point_count; p++) {
        if (c->final_of[p] < 0) continue;
        double world[3], square = 0;
        enf_frame_to_world(frame, &c->points[3 * (size_t)c->final_of[p]], world);
        for (int a = 0; a < 3; a++) {
            double moved = (world[a] - c->soup->points[3 * p + (size_t)a]) / frame->step;
            square += moved * moved;
        }
        largest = fmax(largest, square);
        sum += sqrt(square);
        used++;
    }
    c->mesh->displacement_max = sqrt(largest) * frame->step;
    c->mesh->displacement_mean = used ? sum / (double)used * frame->step : 0;
}

static void take_points(enf_site *sites, const double *points, size_t count) {
    for (size_t i = 0; i < count; i++) {
        sites[i].id = (int32_t)i;
        for (int a = 0; a < 3; a++) sites[i].at[a] = points[3 * i + (size_t)a] + 0.0; // -0 becomes 0
    }
}

static void give_points(const enf_site *sites, double *points, size_t count) {
    for (size_t i = 0; i < count; i++) memcpy(&points[3 * i], sites[i].at, sizeof sites[i].at);
}

/// Steps 2 to 4; `distinct` is room for the points.
static enf_status settle_frame(cleaner *c, enf_site *sites, size_t *count, double *distinct,
                               int32_t *scratch) {
    enf_frame_rings rings = {c->soup, c->cutting, c->cutting_count, c->final_of};
    give_points(sites, distinct, *count);
    enf_tolerances_choose(c->mesh, c->options, distinct, *count);
    bool changed = false;
    enf_status status = enf_planes_recover(c->mesh, distinct, *count, &rings, &changed, c->error);
    if (status != ENF_OK) return status;
    if (changed) {
        take_points(sites, distinct, *count);
        *count = unite(c, sites, *count, scratch);
        give_points(sites, distinct, *count);
        enf_frame_choose(&c->mesh->frame, distinct, *count, &rings);
    }
    return ENF_OK;
}

static void round_to_grid(const enf_frame *frame, enf_site *sites, size_t count) {
    enf_frame untilted = *frame; // the sites have been turned
    untilted.is_turned = false;
    for (size_t i = 0; i < count; i++) {
        double grid[3];
        enf_frame_to_grid(&untilted, sites[i].at, grid);
        for (int a = 0; a < 3; a++) sites[i].at[a] = nearbyint(grid[a]) + 0.0; // -0 becomes 0
    }
}

/// Steps 2 to 6 on the sites; returns how many are left.
static size_t settle_sites(cleaner *c, enf_site *sites, size_t count, int32_t *scratch[2],
                           enf_status *status) {
    count = unite(c, sites, count, scratch[0]);
    size_t different = count;
    double *distinct = enf_array_new(count, 3 * sizeof *distinct);
    *status = distinct ? settle_frame(c, sites, &count, distinct, scratch[0])
                       : enf_fail_memory(c->error, "the points");
    free(distinct);
    if (*status != ENF_OK) return 0;
    round_to_grid(&c->mesh->frame, sites, count);
    count = unite(c, sites, count, scratch[0]);
    count = weld(c, sites, count, c->mesh->weld / c->mesh->frame.step, scratch[0], scratch[1], status);
    if (*status != ENF_OK) return 0;
    count = unite(c, sites, count, scratch[0]);
    c->mesh->welded = different - count;
    return count;
}

static enf_status settle_points(cleaner *c) {
    const enf_soup *soup = c->soup;
    c->final_of = enf_array_new(soup->point_count, sizeof *c->final_of);
    if (!c->final_of) return enf_fail_memory(c->error, "the points");
    size_t count = number_used_points(c);
    enf_site *sites = enf_array_new(count, sizeof *sites);
    int32_t *scratch[2] = {enf_array_new(count, sizeof(int32_t)), enf_array_new(count, sizeof(int32_t))};
    enf_status status = ENF_OK;
    if (!sites || !scratch[0] || !scratch[1]) {
        status = enf_fail_memory(c->error, "the points");
    } else {
        for (size_t p = 0; p < soup->point_count; p++) {
            int32_t id = c->final_of[p];
            if (id < 0) continue;
            sites[id].id = id;
            for (int a = 0; a < 3; a++) sites[id].at[a] = soup->points[3 * p + a] + 0.0;
        }
        c->point_count = settle_sites(c, sites, count, scratch, &status);
    }
    if (status == ENF_OK) {
        c->points = enf_array_new(c->point_count, 3 * sizeof *c->points);
        if (!c->points) status = enf_fail_memory(c->error, "the points");
    }
    if (status == ENF_OK) {
        for (size_t i = 0; i < c->point_count; i++)
            memcpy(&c->points[3 * i], sites[i].at, sizeof sites[i].at);
        measure_displacement(c);
    }
    free(sites);
    free(scratch[0]);
    free(scratch[1]);
    return status;
}

// ---- step 7: polygons

/// Lays the polygon's corners into the scratch ring, turned over if the frame is a mirror.
static bool load_ring(cleaner *c, size_t polygon, size_t *count) {
    int64_t first = c->soup->polygon_corner[polygon];
    *count = (size_t)(c->soup->polygon_corner[polygon + 1] - first);
    if (!enf_array_reserve(c->ring, c->ring_capacity, *count)) return false;
    bool turn_over = c->mesh->frame.handedness < 0;
    for (size_t i = 0; i < *count; i++) {
        size_t from = turn_over ? *count - 1 - i : i;
        c->ring[i] = c->final_of[c->soup->corner_point[first + (int64_t)from]];
    }
    return true;
}

static enf_status add_triangles(cleaner *c, size_t polygon, size_t count, bool *any) {
    if (!enf_array_reserve(c->triangles, c->triangle_capacity, count))
        return enf_fail_memory(c->error, "triangles");
    size_t made;
    enf_status status = enf_triangulate(c->ring, count, c->points, c->triangles, &made, c->error);
    if (status != ENF_OK) return status;
    for (size_t t = 0; t < made; t++) {
        enf_ring_rotate(c->triangles[t], 3);
        if (!enf_pieces_add(&c->pieces, c->triangles[t], 3, (int32_t)polygon))
            return enf_fail_memory(c->error, "triangles");
    }
    *any = made > 0;
    c->mesh->triangulated += made > 0;
    return ENF_OK;
}

static enf_status clean_polygon(cleaner *c, size_t polygon) {
    size_t count;
    if (!load_ring(c, polygon, &count)) return enf_fail_memory(c->error, "a polygon");
    enf_reject reason = ENF_REJECT_COUNT;
    count = enf_ring_remove_repeats(c->ring, count);
    if (count < 3) {
        reason = ENF_REJECT_TOO_FEW_CORNERS;
    } else {
        count = enf_ring_remove_collinear(c->ring, count, c->points);
        if (count < 3) reason = ENF_REJECT_NO_AREA;
    }
    if (reason == ENF_REJECT_COUNT) {
        enf_ring_rotate(c->ring, count);
        bool any = true;
        if (enf_ring_is_convex(c->ring, count, c->points)) {
            if (!enf_pieces_add(&c->pieces, c->ring, count, (int32_t)polygon))
                return enf_fail_memory(c->error, "the polygons");
        } else if (count > ENF_TRIANGULATE_MOST) {
            reason = ENF_REJECT_TOO_COMPLEX;
        } else {
            enf_status status = add_triangles(c, polygon, count, &any);
            if (status != ENF_OK) return status;
        }
        if (!any) reason = ENF_REJECT_NO_AREA;
    }
    if (reason != ENF_REJECT_COUNT && !reject(c, reason, polygon))
        return enf_fail_memory(c->error, "the list of rejections");
    return ENF_OK;
}

static enf_status clean_polygons(cleaner *c) {
    enf_status status = ENF_OK;
    for (size_t k = 0; k < c->cutting_count && status == ENF_OK; k++)
        status = clean_polygon(c, (size_t)c->cutting[k]);
    return status;
}

// ---- steps 8 and 9: duplicates and order

/// A polygon of which no piece stayed is a duplicate of others.
static enf_status reject_duplicates(cleaner *c, const int32_t *order, size_t kept) {
    bool *stays = enf_array_zeroed(c->soup->polygon_count, sizeof *stays);
    if (!stays) return enf_fail_memory(c->error, "the polygons");
    for (size_t i = 0; i < kept; i++) stays[c->pieces.source[order[i]]] = true;
    bool listed = true;
    for (size_t i = 0; i < c->pieces.count && listed; i++) {
        int32_t source = c->pieces.source[i];
        if (stays[source]) continue;
        listed = reject(c, ENF_REJECT_DUPLICATE, (size_t)source);
        stays[source] = true; // listed once
    }
    free(stays);
    return listed ? ENF_OK : enf_fail_memory(c->error, "the list of rejections");
}

/// Numbers the points that the pieces use, in order, and copies them to the mesh.
static enf_status keep_points(cleaner *c, const int32_t *order, size_t kept, int32_t *number) {
    enf_mesh *mesh = c->mesh;
    memset(number, -1, c->point_count * sizeof *number);
    for (size_t i = 0; i < kept; i++)
        for (int64_t k = c->pieces.corner[order[i]]; k < c->pieces.corner[order[i] + 1]; k++)
            number[c->pieces.corners[k]] = 0;
    for (size_t p = 0; p < c->point_count; p++)
        if (number[p] == 0) number[p] = (int32_t)mesh->point_count++;
    mesh->points = enf_array_new(mesh->point_count, 3 * sizeof *mesh->points);
    if (!mesh->points) return enf_fail_memory(c->error, "the points");
    for (size_t p = 0; p < c->point_count; p++)
        if (number[p] >= 0)
            memcpy(&mesh->points[3 * (size_t)number[p]], &c->points[3 * p], 3 * sizeof(double));
    return ENF_OK;
}

static enf_status keep_polygons(cleaner *c, const int32_t *order, size_t kept, const int32_t *number) {
    enf_mesh *mesh = c->mesh;
    size_t corners = 0;
    for (size_t i = 0; i < kept; i++) corners += enf_pieces_size(&c->pieces, order[i]);
    mesh->polygon_corner = enf_array_new(kept + 1, sizeof *mesh->polygon_corner);
    mesh->corners = enf_array_new(corners, sizeof *mesh->corners);
    mesh->polygon_source = enf_array_new(kept, sizeof *mesh->polygon_source);
    mesh->polygon_plane = enf_array_new(kept, sizeof *mesh->polygon_plane);
    if (!mesh->polygon_corner || !mesh->corners || !mesh->polygon_source || !mesh->polygon_plane)
        return enf_fail_memory(c->error, "the polygons");
    mesh->polygon_count = kept;
    mesh->polygon_corner[0] = 0;
    for (size_t i = 0; i < kept; i++) {
        int64_t from = c->pieces.corner[order[i]], to = mesh->polygon_corner[i];
        size_t size = enf_pieces_size(&c->pieces, order[i]);
        for (size_t k = 0; k < size; k++)
            mesh->corners[to + (int64_t)k] = number[c->pieces.corners[from + (int64_t)k]];
        mesh->polygon_corner[i + 1] = to + (int64_t)size;
        mesh->polygon_source[i] = c->pieces.source[order[i]];
        enf_ring_plane(&mesh->corners[to], size, mesh->points, mesh->polygon_plane[i]);
    }
    return ENF_OK;
}

static enf_status put_in_order(cleaner *c) {
    int32_t *order = enf_array_new(c->pieces.count, sizeof *order);
    int32_t *number = enf_array_new(c->point_count, sizeof *number);
    c->mesh->polygon_copies = enf_array_new(c->pieces.count, sizeof *c->mesh->polygon_copies);
    enf_status status = ENF_OK;
    if (!order || !number || !c->mesh->polygon_copies) {
        status = enf_fail_memory(c->error, "the polygons");
    } else {
        size_t kept = 0;
        status = enf_pieces_sort(&c->pieces, order, c->mesh->polygon_copies, &kept, c->error);
        if (status == ENF_OK)
            status = enf_pieces_count_two_sided(&c->pieces, order, kept, &c->mesh->two_sided, c->error);
        if (status == ENF_OK) status = reject_duplicates(c, order, kept);
        if (status == ENF_OK) status = keep_points(c, order, kept, number);
        if (status == ENF_OK) status = keep_polygons(c, order, kept, number);
    }
    free(order);
    free(number);
    return status;
}

// ---- the whole

static enf_status keep_spawns(cleaner *c) {
    enf_mesh *mesh = c->mesh;
    mesh->spawns = enf_array_new(c->soup->spawn_count, 3 * sizeof *mesh->spawns);
    if (!mesh->spawns) return enf_fail_memory(c->error, "the spawn points");
    mesh->spawn_count = c->soup->spawn_count;
    for (size_t i = 0; i < mesh->spawn_count; i++)
        enf_frame_to_grid(&mesh->frame, &c->soup->spawns[3 * i], &mesh->spawns[3 * i]);
    return ENF_OK;
}

/// Nothing is left: says why, by the first polygon that was turned down.
static enf_status fail_nothing_left(const cleaner *c) {
    const enf_soup *soup = c->soup;
    if (c->mesh->detail_count)
        return enf_fail(c->error, ENF_BAD_INPUT,
                        "no polygon is left that cuts space; let --detail match less");
    for (size_t i = 0; i < soup->rejected_count; i++) {
        const enf_rejected *first = &soup->rejected[i];
        if (first->polygon < 0) continue;
        bool named = first->file >= 0 && (size_t)first->file < soup->file_count;
        return enf_fail(
            c->error, ENF_BAD_INPUT,
            "%s:%lld: this polygon cannot be used (%s), and none of the input's other %zu can; check the "
            "file and the options",
            named ? soup->files[first->file] : "input", (long long)first->line,
            enf_reject_name(first->reason), soup->polygon_count - 1);
    }
    return enf_fail(c->error, ENF_BAD_INPUT, "no polygons; a world needs at least one");
}

static enf_status check_options(const enf_clean_options *options, enf_error *error) {
    if (isfinite(options->weld) && isfinite(options->plane_tolerance)) return ENF_OK;
    return enf_fail(error, ENF_BAD_USAGE, "the weld distance and the plane tolerance must be finite numbers");
}

static enf_status run_steps(cleaner *c) {
    enf_status status = check_options(c->options, c->error);
    if (status == ENF_OK) status = judge_groups(c);
    if (status == ENF_OK) status = judge_polygons(c);
    if (status == ENF_OK) status = settle_points(c);
    if (status == ENF_OK) status = clean_polygons(c);
    if (status == ENF_OK && c->pieces.count == 0) status = fail_nothing_left(c);
    if (status == ENF_OK) status = put_in_order(c);
    if (status == ENF_OK) status = keep_spawns(c);
    return status;
}

void enf_mesh_free(enf_mesh *mesh) {
    if (!mesh) return;
    free(mesh->points);
    free(mesh->polygon_corner);
    free(mesh->corners);
    free(mesh->polygon_source);
    free(mesh->polygon_copies);
    free(mesh->polygon_plane);
    free(mesh->details);
    free(mesh->spawns);
    *mesh = (enf_mesh){0};
}

enf_status enf_mesh_clean(enf_mesh *mesh, enf_soup *soup, const enf_clean_options *options,
                          enf_error *error) {
    static const enf_clean_options defaults = {.weld = -1, .plane_tolerance = -1};
    *mesh = (enf_mesh){0};
    cleaner c = {.mesh = mesh, .soup = soup, .options = options ? options : &defaults, .error = error};
    enf_status status = run_steps(&c);
    free(c.group_fate);
    free(c.cutting);
    free(c.final_of);
    free(c.points);
    free(c.ring);
    free(c.triangles);
    enf_pieces_free(&c.pieces);
    if (status != ENF_OK) enf_mesh_free(mesh);
    return status;
}
