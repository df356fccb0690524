// SPDX-License-Identifier: MIT
// Checks what the sections say: numbers are finite, indices name what exists, ranges lie in their arrays,
// walks end. After this no query needs to look twice. What the world *means* is the business of `enfilade
// check`.
#include "format/read.h"

#include "format/pvs_row.h"
#include "format/sections.h"

#include <math.h>
#include <stdlib.h>

typedef struct checker {
    const enf_file_view *view;
    enf_error *error;
} checker;

static enf_status element_fails(enf_error *error, const char *tag, int64_t element) {
    return enf_fail(
        error, ENF_BAD_INPUT,
        "not a usable world file: section %s, element %lld is out of range; compile the world again", tag,
        (long long)element);
}

static bool in_range(int64_t value, int64_t lowest, int64_t end) {
    return value >= lowest && value < end;
}

/// first >= 0, count >= 0 and first + count <= end.
static bool is_range(int64_t first, int64_t count, int64_t end) {
    return first >= 0 && count >= 0 && first <= end && count <= end - first;
}

static bool all_finite(const double *values, int count) {
    for (int i = 0; i < count; i++) {
        if (!isfinite(values[i])) return false;
    }
    return true;
}

static bool is_power_of_two(double value) {
    int exponent;
    return isfinite(value) && value > 0 && frexp(value, &exponent) == 0.5;
}

// --- Rules that the list of sections names. Each returns the first bad element, or -1.
// ---------------------------

static int64_t find_bad_index(const int32_t *values, int64_t count, int32_t lowest, int64_t end) {
    if (end <= lowest) return count ? 0 : -1;
    uint32_t span = (uint32_t)(end - lowest), bad = 0;
    for (int64_t i = 0; i < count; i++) bad |= (uint32_t)values[i] - (uint32_t)lowest >= span;
    if (!bad) return -1;
    int64_t i = 0;
    while (in_range(values[i], lowest, end)) i++;
    return i;
}

static int64_t find_bad_offset32(const int32_t *offsets, int64_t count, int64_t end) {
    if (offsets[0] != 0) return 0;
    for (int64_t i = 0; i < count; i++) {
        if (offsets[i + 1] < offsets[i]) return i + 1;
    }
    return offsets[count] == end ? -1 : count;
}

static int64_t find_bad_offset64(const int64_t *offsets, int64_t count, int64_t end) {
    if (offsets[0] != 0) return 0;
    for (int64_t i = 0; i < count; i++) {
        if (offsets[i + 1] < offsets[i]) return i + 1;
    }
    return offsets[count] == end ? -1 : count;
}

static int64_t find_bad_corner(const enf_file_view *view, const enf_file_corner *corners, int64_t count) {
    uint32_t vertices = (uint32_t)view->vertex_count, planes = (uint32_t)view->plane_count, bad = 0;
    for (int64_t i = 0; i < count; i++)
        bad |= ((uint32_t)corners[i].vertex >= vertices) | ((uint32_t)corners[i].edge_plane >= planes);
    if (!bad) return -1;
    int64_t i = 0;
    while ((uint32_t)corners[i].vertex < vertices && (uint32_t)corners[i].edge_plane < planes) i++;
    return i;
}

static int64_t find_bad_flag(const uint8_t *values, int64_t count) {
    for (int64_t i = 0; i < count; i++) {
        if (values[i] > 1) return i;
    }
    return -1;
}

/// NaN compares false with everything, so it is found as well.
static int64_t find_bad_double(const double *values, int64_t count, double largest) {
    for (int64_t i = 0; i < count; i++) {
        if (!(fabs(values[i]) <= largest)) return i;
    }
    return -1;
}

static int64_t find_bad_element(const enf_file_view *view, const enf_section_spec *spec) {
    const void *array = enf_view_array(view, spec);
    int64_t count = enf_view_count(view, spec->dimension), target = enf_view_count(view, spec->target);
    int64_t numbers = count * (spec->element_size / sizeof(int32_t)), bad = -1;
    switch ((enf_rule)spec->rule) {
    case ENF_RULE_NONE:
        break;
    case ENF_RULE_INDEX:
        bad = find_bad_index(array, numbers, spec->lowest, target);
        return bad < 0 ? bad : bad / (int64_t)(spec->element_size / sizeof(int32_t));
    case ENF_RULE_OFFSETS32:
        return find_bad_offset32(array, count, target);
    case ENF_RULE_OFFSETS64:
        return find_bad_offset64(array, count, target);
    case ENF_RULE_CORNERS:
        return find_bad_corner(view, array, count);
    case ENF_RULE_FLAG:
        return find_bad_flag(array, count);
    case ENF_RULE_FINITE:
    case ENF_RULE_GRID:
        bad = find_bad_double(array, numbers / 2, spec->rule == ENF_RULE_GRID ? ENF_FILE_GRID_MAX : 0x1p1000);
        return bad < 0 ? bad : bad / (int64_t)(spec->element_size / sizeof(double));
    }
    return -1;
}

// --- Sections that hold records
// ----------------------------------------------------------------------------------

static bool is_string(const enf_file_view *view, uint32_t string) {
    return (int64_t)string < view->string_bytes;
}

/// Rows of length 1, at right angles, right-handed; up to rounding.
static bool is_rotation(const double rows[3][3]) {
    if (!all_finite(rows[0], 9)) return false;
    for (int a = 0; a < 3; a++) {
        const double *p = rows[a], *q = rows[(a + 1) % 3], *r = rows[(a + 2) % 3];
        double length = 0, across = 0, volume = 0;
        for (int i = 0; i < 3; i++) {
            int b = (i + 1) % 3, c = (i + 2) % 3;
            length += p[i] * p[i];
            across += p[i] * q[i];
            volume += p[i] * (q[b] * r[c] - q[c] * r[b]);
        }
        if (!(fabs(length - 1) <= 0x1p-48 && fabs(across) <= 0x1p-48 && volume > 0)) return false;
    }
    return true;
}

static enf_status check_head(checker *check) {
    const enf_file_view *view = check->view;
    if (view->string_bytes < 1 || view->strings[view->string_bytes - 1] != 0)
        return element_fails(check->error, "STRINGS", view->string_bytes - 1);
    if (!is_string(view, view->provenance->options) || view->provenance->input_polygons < 0 ||
        !isfinite(view->provenance->sealed_area))
        return element_fails(check->error, "PROVEN", 0);

    const enf_file_frame *frame = view->frame;
    bool used[3] = {false, false, false}, good = is_power_of_two(frame->step);
    for (int a = 0; a < 3; a++) {
        if (!in_range(frame->axis[a], 0, 3) || used[frame->axis[a]] ||
            (frame->sign[a] != 1 && frame->sign[a] != -1))
            return element_fails(check->error, "FRAME", 0);
        used[frame->axis[a]] = true;
    }
    bool even = (frame->axis[1] - frame->axis[0] + 3) % 3 == 1;
    int turns = frame->sign[0] * frame->sign[1] * frame->sign[2] * (even ? 1 : -1);
    good =
        good && turns == frame->handedness && all_finite(frame->box_min, 3) && all_finite(frame->box_max, 3);
    good = good && isfinite(frame->weld) && isfinite(frame->plane_tolerance);
    good = good && isfinite(frame->displacement_max) && isfinite(frame->displacement_mean);
    good = good && is_power_of_two(frame->locate_scale) && frame->locate_scale >= 1;
    good = good && frame->locate_rounding >= 0 && frame->locate_rounding <= ENF_FILE_GRID_MAX;
    if (good && view->turn && !is_rotation(view->turn->rows)) return element_fails(check->error, "TURN", 0);
    return good ? ENF_OK : element_fails(check->error, "FRAME", 0);
}

static enf_status check_regions(checker *check) {
    const enf_file_view *view = check->view;
    for (int32_t i = 0; i < view->region_count; i++) {
        const enf_file_region *region = &view->regions[i];
        if (!all_finite(&region->volume, 1) || !all_finite(&region->front_area, 1) ||
            !all_finite(&region->back_area, 1) || region->kind > 2 || region->kept > 1 ||
            region->touches_outside > 1 || region->ambiguous > 1)
            return element_fails(check->error, "REGION", i);
    }
    for (int32_t i = 0; i < view->spawn_count; i++) {
        const enf_file_spawn *spawn = &view->spawns[i];
        if (!all_finite(spawn->position, 3) || !in_range(spawn->fine_cell, -1, view->fine_count) ||
            !in_range(spawn->cell, -1, view->cell_count))
            return element_fails(check->error, "SPAWN", i);
    }
    return ENF_OK;
}

/// Ranges that are longer together than what they point into share parts of it: a small file could make
/// every walk over them as long as it likes.
static enf_status check_cells(checker *check) {
    const enf_file_view *view = check->view;
    int64_t portals = 0, triangles = 0;
    for (int32_t i = 0; i < view->cell_count; i++) {
        const enf_file_cell *cell = &view->cells[i];
        bool good = all_finite(cell->box_min, 3) && all_finite(cell->box_max, 3) && isfinite(cell->volume) &&
                    in_range(cell->region, 0, view->region_count) &&
                    is_range(cell->portal_first, cell->portal_count, view->cell_portal_count) &&
                    (!view->has_geometry ||
                     is_range(cell->triangle_first, cell->triangle_count, view->cell_triangle_count));
        for (int32_t k = 0; good && k < cell->portal_count; k++)
            good = view->portals[view->cell_portals[cell->portal_first + k]].from == i;
        if (good) portals += cell->portal_count;
        if (good && view->has_geometry) triangles += cell->triangle_count;
        good = good && portals <= view->cell_portal_count && triangles <= view->cell_triangle_count;
        if (!good) return element_fails(check->error, "CELL", i);
    }
    return ENF_OK;
}

static enf_status check_portals(checker *check) {
    const enf_file_view *view = check->view;
    int64_t polygons = 0, vertices = 0;
    if (view->portal_count % 2) return element_fails(check->error, "PORTAL", view->portal_count);
    for (int32_t i = 0; i < view->portal_count; i++) {
        const enf_file_portal *portal = &view->portals[i], *twin = &view->portals[i ^ 1];
        if (!in_range(portal->from, 0, view->cell_count) || twin->to != portal->from ||
            portal->polygon_count < 1 || portal->polygon_count != twin->polygon_count ||
            !is_range(portal->polygon_first, portal->polygon_count, view->portal_polygon_count) ||
            !all_finite(portal->centre, 3) || !isfinite(portal->radius) || portal->radius < 0 ||
            (polygons += portal->polygon_count) > view->portal_polygon_count)
            return element_fails(check->error, "PORTAL", i);
    }
    for (int32_t i = 0; i < view->portal_polygon_count; i++) {
        const enf_file_portal_polygon *polygon = &view->portal_polygons[i];
        if (!all_finite(polygon->plane, 4) || !isfinite(polygon->area) || polygon->vertex_count < 3 ||
            !is_range(polygon->vertex_first, polygon->vertex_count, view->portal_vertex_count) ||
            (view->has_exact && !in_range(polygon->loop, 0, view->portal_loop_count)) ||
            (vertices += polygon->vertex_count) > view->portal_vertex_count)
            return element_fails(check->error, "PORTPOLY", i);
    }
    return ENF_OK;
}

static enf_status check_planes(checker *check) {
    const enf_file_view *view = check->view;
    for (int32_t i = 0; i < view->plane_count; i++) {
        const int32_t *plane = view->planes[i];
        if (!in_range(plane[0], 0, view->point_count) || !in_range(plane[1], 0, view->point_count) ||
            !in_range(plane[2], -3, view->point_count))
            return element_fails(check->error, "PLANE", i);
    }
    // Located points are whole numbers of the finer grid; beyond 2^53 of its steps they would not be.
    double largest = ENF_FILE_GRID_MAX / view->frame->locate_scale;
    int64_t bad = find_bad_double((const double *)view->points, (int64_t)view->point_count * 3, largest);
    return bad < 0 ? ENF_OK : element_fails(check->error, "POINT", bad / 3);
}

static enf_status check_boxes(checker *check) {
    const enf_file_view *view = check->view;
    for (int32_t i = 0; i < view->box_count; i++) {
        const enf_file_box *box = &view->boxes[i];
        bool good = box->next > i && box->next <= view->box_count &&
                    in_range(box->tetrahedron, -1, view->tetrahedron_count);
        for (int a = 0; a < 3; a++) good = good && box->min[a] <= box->max[a];
        if (!good) return element_fails(check->error, "BOX", i);
    }
    return ENF_OK;
}

static enf_status check_start(checker *check) {
    const enf_file_start *start = check->view->start;
    if (!start) return ENF_OK;
    int64_t bricks = 1;
    bool good = all_finite(start->origin, 3) && all_finite(start->per_step, 3);
    for (int a = 0; a < 3 && good; a++) {
        good = start->per_step[a] >= 0 && start->count[a] >= 1;
        if (good) bricks *= start->count[a]; // at most 2^31 before, so this does not overflow
        good = good && bricks <= check->view->start_count;
    }
    return good && bricks == check->view->start_count ? ENF_OK : element_fails(check->error, "BRICKS", 0);
}

/// Notes a reference from a root or node. Where a node is referred to by roots only, or by one other node
/// only, a walk from a root can meet no node twice, so it ends.
static bool note_child(const enf_file_view *view, uint8_t *referred, int32_t child, bool from_root) {
    enum { BY_ROOT = 1, BY_NODE = 2 };
    if (child < 0) return -1 - child < view->fine_count;
    if (child >= view->node_count || (referred[child] && !(from_root && referred[child] == BY_ROOT)))
        return false;
    referred[child] = from_root ? BY_ROOT : BY_NODE;
    return true;
}

static enf_status check_cut_trees(checker *check) {
    const enf_file_view *view = check->view;
    uint8_t *referred = calloc((size_t)view->node_count + 1, 1);
    if (!referred) return enf_fail_memory(check->error, "checking the cut trees");
    enf_status status = ENF_OK;
    for (int32_t i = 0; !status && i < view->tetrahedron_count; i++) {
        if (!note_child(view, referred, view->tetrahedron_root[i], true))
            status = element_fails(check->error, "TETROOT", i);
    }
    for (int32_t i = 0; !status && i < view->node_count; i++) {
        if (!note_child(view, referred, view->node_child[i][0], false) ||
            !note_child(view, referred, view->node_child[i][1], false))
            status = element_fails(check->error, "NODCHILD", i);
    }
    free(referred);
    return status;
}

static enf_status check_exact(checker *check) {
    const enf_file_view *view = check->view;
    if (!view->has_exact) return ENF_OK;
    if (view->vertex_count < view->point_count)
        return element_fails(check->error, "VXPLANE", view->vertex_count);
    for (int32_t i = 0; i < view->mesh_polygon_count; i++) {
        if (!in_range(view->mesh_polygon_source[i], 0, view->provenance->input_polygons))
            return element_fails(check->error, "POLYSRC", i);
    }
    return ENF_OK;
}

static bool triangle_fits(const enf_file_view *view, const enf_file_triangle *triangle) {
    for (int k = 0; k < 3; k++) {
        if (!in_range(triangle->point[k], 0, view->render_point_count) ||
            !in_range(triangle->normal[k], -1, view->render_normal_count) ||
            !in_range(triangle->texcoord[k], -1, view->render_texcoord_count))
            return false;
    }
    return in_range(triangle->polygon, 0, view->provenance->input_polygons) &&
           in_range(triangle->group, 0, view->group_count) &&
           in_range(triangle->material, -1, view->material_count) &&
           in_range(triangle->mesh_polygon, -1, view->has_exact ? view->mesh_polygon_count : INT32_MAX) &&
           in_range(triangle->cell, -1, view->cell_count);
}

static enf_status check_geometry(checker *check) {
    const enf_file_view *view = check->view;
    if (!view->has_geometry) return ENF_OK;
    for (int32_t i = 0; i < view->triangle_count; i++) {
        if (!triangle_fits(view, &view->triangles[i])) return element_fails(check->error, "TRIANGLE", i);
    }
    for (int32_t i = 0; i < view->group_count; i++) {
        if (!is_string(view, view->group_names[i])) return element_fails(check->error, "GROUP", i);
    }
    for (int32_t i = 0; i < view->material_count; i++) {
        if (!is_string(view, view->material_names[i])) return element_fails(check->error, "MATERIAL", i);
    }
    return ENF_OK;
}

static enf_status check_pvs(checker *check) {
    const enf_file_view *view = check->view;
    if (!view->pvs) return ENF_OK;
    if (view->pvs->method >= ENF_FILE_PVS_METHODS) return element_fails(check->error, "PVS", 0);
    for (int32_t i = 0; i < view->cell_count; i++) {
        const int64_t *offset = &view->pvs_offset[i];
        if (!enf_pvs_row_decode(view->pvs_rows + offset[0], (size_t)(offset[1] - offset[0]), NULL,
                                view->cell_count))
            return element_fails(check->error, "PVSROW", offset[0]);
    }
    return ENF_OK;
}

static bool barrier_fits(const enf_file_view *view, const enf_file_barrier *barrier) {
    bool is_portal = barrier->kind == ENF_FILE_BARRIER_PORTAL;
    int32_t end = is_portal ? view->portal_count : view->has_geometry ? view->triangle_count : INT32_MAX;
    return in_range(barrier->kind, 0, ENF_FILE_BARRIER_KINDS) && all_finite(barrier->normal, 3) &&
           barrier->vertex_count >= 3 &&
           is_range(barrier->vertex_first, barrier->vertex_count, view->barrier_vertex_count) &&
           in_range(barrier->index, is_portal ? 0 : -1, end) && !(is_portal && barrier->index % 2);
}

/// Nodes are referred to once each, level by level, so every walk is one of a tree that is not too deep; and
/// the corners of all barriers in it, counted as often as they are in it, are no more than there are.
static enf_status check_barrier_tree(checker *check, const char *tag, const enf_file_barrier_node *nodes,
                                     int32_t count, int64_t *vertices) {
    int32_t next = 1, level_end = 1, levels = 1;
    for (int32_t i = 0; i < count; i++) {
        if (i == level_end) {
            level_end = next;
            levels++;
        }
        for (int k = 0; k < 4; k++) {
            int32_t child = nodes[i].child[k];
            bool good = child < 0 ? child == -1 || -2 - child < check->view->barrier_count : child == next;
            if (!good) return element_fails(check->error, tag, i);
            next += child >= 0;
            if (child < -1) *vertices += check->view->barriers[-2 - child].vertex_count;
            if (*vertices > check->view->barrier_vertex_count) return element_fails(check->error, tag, i);
        }
        if (next <= i + 1 && i + 1 < count)
            return element_fails(check->error, tag, i); // the rest hangs loose
    }
    if ((count && next != count) || levels > ENF_FILE_BARRIER_DEPTH_MAX)
        return element_fails(check->error, tag, count);
    return ENF_OK;
}

static enf_status check_sight(checker *check) {
    const enf_file_view *view = check->view;
    if (!view->sight) return ENF_OK;
    const enf_file_sight *sight = view->sight;
    bool good = sight->extent >= 1 && sight->extent <= ENF_FILE_GRID_MAX;
    for (int a = 0; a < 3; a++)
        good = good && fabs(sight->box_min[a]) <= sight->extent && fabs(sight->box_max[a]) <= sight->extent;
    if (!good) return element_fails(check->error, "SIGHT", 0);
    for (int32_t i = 0; i < view->barrier_count; i++) {
        if (!barrier_fits(view, &view->barriers[i])) return element_fails(check->error, "BARRIER", i);
    }
    int64_t vertices = 0;
    enf_status status =
        check_barrier_tree(check, "WALLTREE", view->wall_nodes, view->wall_node_count, &vertices);
    if (status) return status;
    return check_barrier_tree(check, "PORTTREE", view->portal_nodes, view->portal_node_count, &vertices);
}

enf_status enf_view_check(const enf_file_view *view, enf_error *error) {
    for (int i = 0; i < enf_section_spec_count; i++) {
        const enf_section_spec *spec = &enf_section_specs[i];
        if (!enf_view_array(view, spec)) continue;
        int64_t bad = find_bad_element(view, spec);
        if (bad >= 0) return element_fails(error, spec->tag, bad);
    }
    static enf_status (*const checks[])(checker *) = {
        check_head,  check_regions,   check_portals, check_cells,    check_planes, check_boxes,
        check_start, check_cut_trees, check_exact,   check_geometry, check_pvs,    check_sight};
    checker check = {view, error};
    for (size_t i = 0; i < sizeof checks / sizeof *checks; i++) {
        enf_status status = checks[i](&check);
        if (status) return status;
    }
    return ENF_OK;
}
