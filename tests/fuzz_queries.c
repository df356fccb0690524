// SPDX-License-Identifier: MIT
// What the fuzz target asks every world that opens. Each query, or group of queries, is a function in the
// list at the end: a new one is added there, by a line.
#include "fuzz_queries.h"

#include "enfilade/objects.h"
#include "enfilade/prefetch.h"
#include "enfilade/query.h"
#include "enfilade/sight.h"
#include "enfilade/sound.h"
#include "enfilade/view.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CELLS = 16 }; // of which queries are asked

static volatile double sink; // what is read must not be optimised away

static void use_portals(const enf_file_view *file, const enf_file_cell *cell) {
    for (int32_t i = 0; i < cell->portal_count; i++) {
        const enf_file_portal *portal = &file->portals[file->cell_portals[cell->portal_first + i]];
        sink += portal->radius + file->cells[portal->to].volume;
        for (int32_t p = 0; p < portal->polygon_count; p++) {
            const enf_file_portal_polygon *polygon = &file->portal_polygons[portal->polygon_first + p];
            for (int32_t v = 0; v < polygon->vertex_count; v++)
                sink += file->portal_vertices[polygon->vertex_first + v][2] * polygon->plane[2];
            if (file->has_exact) sink += (double)file->portal_loop_offset[polygon->loop + 1];
        }
    }
}

static void use_triangles(const enf_world *world, const enf_file_view *file, const enf_file_cell *cell) {
    for (int64_t i = 0; file->has_geometry && i < cell->triangle_count; i++) {
        const enf_file_triangle *triangle = &file->triangles[file->cell_triangles[cell->triangle_first + i]];
        sink += strlen(enf_world_string(world, file->group_names[triangle->group]));
        if (triangle->material >= 0)
            sink += strlen(enf_world_string(world, file->material_names[triangle->material]));
        for (int k = 0; k < 3; k++) {
            sink += file->render_points[triangle->point[k]][0];
            if (triangle->normal[k] >= 0) sink += file->render_normals[triangle->normal[k]][2];
            if (triangle->texcoord[k] >= 0) sink += file->render_texcoords[triangle->texcoord[k]][1];
        }
    }
}

static void use_loops(const enf_file_view *file, int32_t count, const int32_t *offset,
                      const enf_file_corner *corners) {
    for (int32_t i = 0; i < count; i++) {
        for (int32_t k = offset[i]; k < offset[i + 1]; k++) {
            sink += file->vertex_position[corners[k].vertex][0];
            sink += file->planes[corners[k].edge_plane][1];
        }
    }
}

static void use_exact(const enf_file_view *file) {
    if (!file->has_exact) return;
    use_loops(file, file->facet_count, file->facet_offset, file->facet_corners);
    use_loops(file, file->cover_count, file->cover_offset, file->cover_corners);
    use_loops(file, file->piece_count, file->piece_offset, file->piece_corners);
    use_loops(file, file->portal_loop_count, file->portal_loop_offset, file->portal_loop_corners);
    for (int32_t i = 0; i < file->fine_count; i++) {
        for (int32_t k = file->fine_facet[i]; k < file->fine_facet[i + 1]; k++)
            sink += file->facet_plane[file->fine_facets[k]];
        for (int64_t k = file->seen_offset[i]; k < file->seen_offset[i + 1]; k++)
            sink += file->mesh_polygon_source[file->seen[k]];
    }
}

static void use_sides(const enf_file_view *file) {
    for (int32_t f = 0; file->has_exact && f < file->facet_count; f++) {
        for (int side = 0; side < 2; side++) {
            if (file->facet_fine[f][side] >= 0) sink += file->fine_facet[file->facet_fine[f][side]];
        }
        for (int32_t c = file->facet_cover[f]; c < file->facet_cover[f + 1]; c++) sink += file->cover_side[c];
        for (int32_t p = file->facet_piece[f]; p < file->facet_piece[f + 1]; p++)
            sink += file->facet_plane[file->piece_facet[p]];
    }
}

/// Doors, one of them closed and one partly open, and a portal that leads round; null without portals.
static enf_instance *make_instance(const enf_world *world, const enf_file_view *file) {
    enf_instance *instance = NULL;
    const enf_door closed = {.state = ENF_DOOR_CLOSED};
    const enf_door partly = {ENF_DOOR_PARTLY, {1, 0, 0, 0}};
    const double round[12] = {1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1, 0};
    if (enf_instance_create(&instance, world, NULL, NULL)) return NULL;
    enf_instance_set_door(instance, 2, &closed, NULL);
    enf_instance_set_door(instance, 4, &partly, NULL);
    enf_instance_set_transform(instance, 0, 0, round, NULL);
    enf_instance_set_transform(instance, file->portal_count - 1, file->cell_count - 1, round, NULL);
    return instance;
}

/// From one end of each cell's box to the other.
static void use_sight(const enf_world *world, const enf_file_view *file) {
    enf_instance *instance = make_instance(world, file);
    for (int32_t i = 0; i < file->cell_count && i < CELLS; i++) {
        const enf_place place = {.cell = i, .fine_cell = -1, .region = 0, .tetrahedron = -1};
        int32_t portals[4];
        enf_sight_query query = {sizeof query, {0}, {0}, &place, &place, portals, i % 5, i % 2};
        enf_ray ray = {sizeof ray, {0}, {0}, 0, &place, 0, portals, i % 5, i % 2};
        enf_step step = {sizeof step, place, {0}, {0}, 0, portals, i % 5};
        enf_sight sight;
        enf_ray_hit hit;
        enf_stepped stepped;
        for (int a = 0; a < 3; a++) {
            query.from[a] = step.from[a] = ray.origin[a] = file->cells[i].box_min[a];
            query.to[a] = step.to[a] = file->cells[i].box_max[a];
            ray.direction[a] = query.to[a] - query.from[a];
        }
        for (int k = 0; k < 2; k++) {
            if (!enf_sight_between(world, k ? instance : NULL, &query, &sight, NULL))
                sink += sight.portal_count;
            if (!enf_ray_cast(world, k ? instance : NULL, &ray, &hit, NULL)) sink += hit.distance;
            if (!enf_world_follow(world, k ? instance : NULL, &step, &stepped, NULL))
                sink += stepped.point[0];
        }
    }
    enf_instance_free(instance);
}

static void use_locate(const enf_world *world, const enf_file_view *file) {
    int32_t hint = -1;
    for (int32_t i = 0; i < file->point_count && i < 200; i++) {
        double at[3];
        for (int a = 0; a < 3; a++)
            at[file->frame->axis[a]] = file->points[i][a] * file->frame->step * file->frame->sign[a];
        for (int k = 0; k < 2; k++, at[k] += 0.3 * file->frame->step) {
            enf_place place = enf_world_locate(world, at, hint);
            hint = place.tetrahedron;
            if (place.cell >= 0) sink += file->cells[place.cell].volume;
            if (place.region >= 0) sink += file->regions[place.region].volume;
            sink += strlen(enf_world_kind_name(place.kind));
        }
    }
}

/// A sphere or a box around the middle of a cell, as far as its corners or beyond.
static enf_shape shape_at(const enf_file_cell *cell, int32_t number) {
    enf_shape shape = {.kind = number % 2 ? ENF_SHAPE_BOX : ENF_SHAPE_SPHERE};
    for (int a = 0; a < 3; a++) {
        shape.centre[a] = cell->box_min[a] / 2 + cell->box_max[a] / 2;
        shape.half[a] = fabs(cell->box_max[a] / 2 - cell->box_min[a] / 2) * (number % 3);
    }
    shape.radius = fmax(shape.half[0], fmax(shape.half[1], shape.half[2]));
    return shape;
}

static void use_shapes(const enf_world *world, const enf_file_view *file) {
    static const double up[3] = {0, 0, 1}, forward[3] = {1, 0.5, 0.125};
    enf_query *query = NULL;
    enf_objects *objects = NULL;
    enf_view *view = NULL;
    enf_instance *instance = make_instance(world, file);
    enf_objects_options options = {sizeof options, 8, 16};
    enf_object near = {0, 0};
    enf_view_create(&view, world, NULL, NULL);
    if (!enf_query_create(&query, world, NULL, NULL) &&
        !enf_objects_create(&objects, world, &options, NULL)) {
        for (int32_t i = 0; i < file->cell_count && i < CELLS; i++) {
            enf_shape shape = shape_at(&file->cells[i], i);
            enf_reach reach;
            enf_query_cells(query, NULL, i, &shape, NULL, 0, &reach, NULL);
            sink += (double)reach.count + (double)enf_query_triangles(query, NULL, 0);
            if (enf_objects_add(objects, &shape, 0, &near, &near, NULL)) continue;
            enf_objects_move(objects, near, &shape, NULL);
            sink += enf_objects_in_cells(objects, query, &i, 1, NULL, 0);
            enf_object_seen seen[4];
            enf_camera camera = enf_camera_look(shape.centre, forward, up, 1, 1);
            if (view)
                sink += enf_objects_in_view(objects, query, instance, enf_view_run(view, instance, &camera),
                                            seen, 4);
        }
    }
    enf_instance_free(instance);
    enf_view_free(view);
    enf_objects_free(objects);
    enf_query_free(query);
}

static void use_prefetch(const enf_world *world, const enf_file_view *file) {
    enf_prefetch *prefetch = NULL;
    enf_stream *stream = NULL;
    if (!enf_prefetch_create(&prefetch, world, NULL) && !enf_stream_create(&stream, world, NULL)) {
        for (int32_t i = 0; i < file->cell_count && i < CELLS; i++) {
            sink +=
                enf_prefetch_list(prefetch, i, file->cells[i].box_min, file->cells[i].box_max, 1, NULL, 0);
            enf_stream_load(stream, i);
            if (i % 2) enf_stream_drop(stream, i);
        }
    }
    enf_stream_free(stream);
    enf_prefetch_free(prefetch);
}

static void use_view(enf_view *view, const enf_instance *instance, const enf_file_view *file) {
    static const double up[3] = {0, 0, 1}, forward[3] = {1, 0.5, 0.125};
    for (int32_t i = 0; i < file->cell_count && i < CELLS; i++) {
        double eye[3];
        for (int a = 0; a < 3; a++) eye[a] = file->cells[i].box_min[a] / 2 + file->cells[i].box_max[a] / 2;
        enf_camera camera = enf_camera_look(eye, forward, up, 1 + i % 2, 1.5);
        const enf_visible *visible = enf_view_run(view, i % 3 ? instance : NULL, &camera);
        for (int32_t k = 0; k < visible->entry_count; k++) {
            const enf_view_entry *entry = &visible->entries[k];
            sink += file->cells[entry->cell].volume + visible->spaces[entry->space].to_camera[0];
            for (int32_t v = 0; v < entry->vertex_count; v++) sink += entry->vertices[v][0];
        }
    }
}

static void use_views(const enf_world *world, const enf_file_view *file) {
    enf_instance *instance = make_instance(world, file);
    const enf_view_options options[] = {{.size = sizeof *options},
                                        {.size = sizeof *options, .rectangles = true, .every_region = true},
                                        {.size = sizeof *options, .visit_capacity = 4, .edges_max = 4}};
    for (size_t i = 0; i < sizeof options / sizeof *options; i++) {
        enf_view *view = NULL;
        if (!enf_view_create(&view, world, &options[i], NULL)) use_view(view, instance, file);
        enf_view_free(view);
    }
    enf_instance_free(instance);
}

static void use_finder(enf_path_finder *finder, const enf_instance *instance, const enf_file_view *file) {
    for (int32_t i = 0; i < file->cell_count && i < CELLS; i++) {
        int32_t portals[8], count, far = file->cell_count - 1 - i;
        double points[10][3];
        enf_path_query query = {.size = sizeof query,
                                .from_cell = i,
                                .to_cell = far,
                                .from = file->cells[i].box_min,
                                .to = file->cells[far].box_max,
                                .portals = portals,
                                .portal_capacity = 8,
                                .points = points,
                                .point_capacity = 10};
        enf_path path;
        enf_near_cell near[8];
        if (!enf_path_find(finder, instance, &query, &path, NULL)) sink += path.length + path.line_length;
        if (!enf_path_near(finder, instance, i, query.from, 100, near, 8, &count, NULL)) sink += count;
        enf_sound_query heard = {.size = sizeof heard,
                                 .source_cell = i,
                                 .listener_cell = far,
                                 .range = INFINITY,
                                 .fade_length = 1,
                                 .door_factor = 0.5,
                                 .portals = portals,
                                 .portal_capacity = 8};
        enf_sound_path ways[3];
        enf_sound sound;
        memcpy(heard.source, query.from, sizeof heard.source);
        memcpy(heard.listener, query.to, sizeof heard.listener);
        if (!enf_sound_find(finder, instance, &heard, ways, 3, &sound, NULL)) sink += sound.count;
    }
}

/// Paths, what is near, and sound.
static void use_paths(const enf_world *world, const enf_file_view *file) {
    enf_instance *instance = make_instance(world, file);
    const enf_path_finder_options few = {.size = sizeof few, .sound_steps_max = 200};
    for (int k = 0; k < 2; k++) {
        const enf_paths_options options = {
            .size = sizeof options, .table_bytes_max = 1 << 16, .skip_table = k, .skip_contraction = k};
        enf_paths *paths = NULL;
        enf_path_finder *finder = NULL;
        if (!enf_paths_create(&paths, world, &options, NULL) &&
            !enf_path_finder_create(&finder, paths, &few, NULL))
            use_finder(finder, k ? instance : NULL, file);
        enf_path_finder_free(finder);
        enf_paths_free(paths);
    }
    enf_instance_free(instance);
}

static void use_info(const enf_world *world, const enf_file_view *file) {
    enf_world_info info;
    enf_world_get_info(world, &info);
    sink += (double)strlen(info.options) + file->string_bytes;
}

static void use_cells(const enf_world *world, const enf_file_view *file) {
    for (int32_t i = 0; i < file->cell_count; i++) {
        use_portals(file, &file->cells[i]);
        use_triangles(world, file, &file->cells[i]);
    }
}

static void use_complex(const enf_world *world, const enf_file_view *file) {
    (void)world;
    use_exact(file);
    use_sides(file);
}

typedef void use(const enf_world *world, const enf_file_view *file);

void fuzz_queries(const enf_world *world) {
    static use *const uses[] = {
        use_info,   use_cells, use_complex,  use_locate, use_sight,
        use_shapes, use_views, use_prefetch, use_paths,
    };
    for (size_t i = 0; i < sizeof uses / sizeof *uses; i++) uses[i](world, enf_world_file(world));
}
