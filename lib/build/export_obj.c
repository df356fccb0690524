// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/export.h"

#include "build/json.h"

#include <inttypes.h>

static void put_tuple(FILE *out, const char *keyword, const double *numbers, int count) {
    fputs(keyword, out);
    for (int i = 0; i < count; i++) {
        char text[32];
        fprintf(out, " %s", enf_json_print_number(numbers[i], text));
    }
    fputc('\n', out);
}

/// v, v/t, v//n or v/t/n; OBJ counts from 1.
static void put_corner(FILE *out, const enf_file_triangle *triangle, int corner) {
    int32_t texcoord = triangle->texcoord[corner], normal = triangle->normal[corner];
    fprintf(out, " %" PRId64, (int64_t)triangle->point[corner] + 1);
    if (texcoord >= 0) fprintf(out, "/%" PRId64, (int64_t)texcoord + 1);
    if (normal >= 0) fprintf(out, "%s%" PRId64, texcoord >= 0 ? "/" : "//", (int64_t)normal + 1);
}

static void put_cell(FILE *out, const enf_file_view *view, int32_t number) {
    const enf_file_cell *cell = &view->cells[number];
    int32_t material = -1;
    fprintf(out, "g cell-%" PRId32 "\n", number);
    for (int32_t i = 0; i < cell->triangle_count; i++) {
        const enf_file_triangle *triangle = &view->triangles[view->cell_triangles[cell->triangle_first + i]];
        if (triangle->material >= 0 && triangle->material != material)
            fprintf(out, "usemtl %s\n", view->strings + view->material_names[triangle->material]);
        material = triangle->material;
        fputc('f', out);
        for (int k = 0; k < 3; k++) put_corner(out, triangle, k);
        fputc('\n', out);
    }
}

/// Vertices come right before the polygon that uses them, so that it can count back.
static void put_portal(FILE *out, const enf_file_view *view, int32_t number) {
    const enf_file_portal *portal = &view->portals[number];
    fprintf(out, "g portal-%" PRId32 "\n# cell %" PRId32 " to cell %" PRId32 "\n", number / 2, portal->from,
            portal->to);
    for (int32_t i = 0; i < portal->polygon_count; i++) {
        const enf_file_portal_polygon *polygon = &view->portal_polygons[portal->polygon_first + i];
        for (int32_t k = 0; k < polygon->vertex_count; k++)
            put_tuple(out, "v", view->portal_vertices[polygon->vertex_first + k], 3);
        fputc('f', out);
        for (int32_t k = polygon->vertex_count; k > 0; k--) fprintf(out, " -%" PRId32, k);
        fputc('\n', out);
    }
}

enf_status enf_export_obj(const enf_file_view *view, FILE *out, enf_error *error) {
    if (!view->has_geometry)
        return enf_fail(error, ENF_BAD_INPUT, "the file holds no triangles to draw; compile the world again");
    fprintf(out, "# %" PRId32 " cells, %" PRId32 " portals\n", view->cell_count, view->portal_count / 2);
    for (int32_t i = 0; i < view->spawn_count; i++) put_tuple(out, "# spawn", view->spawns[i].position, 3);
    for (int32_t i = 0; i < view->render_point_count; i++) put_tuple(out, "v", view->render_points[i], 3);
    for (int32_t i = 0; i < view->render_texcoord_count; i++)
        put_tuple(out, "vt", view->render_texcoords[i], 2);
    for (int32_t i = 0; i < view->render_normal_count; i++) put_tuple(out, "vn", view->render_normals[i], 3);
    fputs("o cells\n", out);
    for (int32_t i = 0; i < view->cell_count; i++) put_cell(out, view, i);
    fputs("o portals\n", out);
    for (int32_t i = 0; i < view->portal_count; i += 2) put_portal(out, view, i);
    return ENF_OK;
}
