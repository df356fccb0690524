// SPDX-License-Identifier: GPL-3.0-or-later
// The graph as text: GraphViz and JSON.
#include "build/export.h"

#include "build/json.h"

#include <inttypes.h>

static double portal_area(const enf_file_view *view, const enf_file_portal *portal) {
    double area = 0;
    for (int32_t i = 0; i < portal->polygon_count; i++)
        area += view->portal_polygons[portal->polygon_first + i].area;
    return area;
}

static bool has_spawn(const enf_file_view *view, int32_t cell) {
    for (int32_t i = 0; i < view->spawn_count; i++)
        if (view->spawns[i].cell == cell) return true;
    return false;
}

static void put_node(FILE *out, const enf_file_view *view, int32_t cell) {
    fprintf(out, "  cell%" PRId32 " [label=\"%" PRId32 "\\nvolume %.4g", cell, cell,
            view->cells[cell].volume);
    bool marked = has_spawn(view, cell);
    if (marked) {
        fputs("\\nspawn", out);
        for (int32_t i = 0; i < view->spawn_count; i++)
            if (view->spawns[i].cell == cell) fprintf(out, " %" PRId32, i);
    }
    fprintf(out, "\"%s];\n", marked ? ", shape=doublecircle, fillcolor=\"#ffe9b8\"" : "");
}

enf_status enf_export_dot(const enf_file_view *view, FILE *out, enf_error *error) {
    (void)error;
    fputs(
        "graph world {\n"
        "  graph [overlap=false, splines=true];\n"
        "  node [shape=circle, style=filled, fillcolor=\"#e8eef5\", fontname=\"sans-serif\", fontsize=11];\n"
        "  edge [color=\"#c05010\", fontname=\"sans-serif\", fontsize=9];\n",
        out);
    for (int32_t i = 0; i < view->cell_count; i++) put_node(out, view, i);
    for (int32_t i = 0; i < view->portal_count; i += 2) {
        const enf_file_portal *portal = &view->portals[i];
        double area = portal_area(view, portal);
        fprintf(out,
                "  cell%" PRId32 " -- cell%" PRId32 " [label=\"portal %" PRId32
                "\\narea %.4g\", weight=%d];\n",
                portal->from, portal->to, i / 2, area, 1);
    }
    fputs("}\n", out);
    return ENF_OK;
}

static void put_cells(enf_json *json, const enf_file_view *view) {
    enf_json_begin_array(json, "cells");
    for (int32_t i = 0; i < view->cell_count; i++) {
        const enf_file_cell *cell = &view->cells[i];
        enf_json_begin_object(json, NULL);
        json->one_line = true;
        enf_json_whole(json, "cell", i);
        enf_json_whole(json, "region", cell->region);
        enf_json_number(json, "volume", cell->volume);
        enf_json_numbers(json, "box_min", cell->box_min, 3);
        enf_json_numbers(json, "box_max", cell->box_max, 3);
        enf_json_whole(json, "triangles", cell->triangle_count);
        enf_json_begin_array(json, "portals");
        for (int32_t k = 0; k < cell->portal_count; k++)
            enf_json_whole(json, NULL, view->cell_portals[cell->portal_first + k] / 2);
        enf_json_end_array(json);
        enf_json_begin_array(json, "neighbours");
        for (int32_t k = 0; k < cell->portal_count; k++)
            enf_json_whole(json, NULL, view->portals[view->cell_portals[cell->portal_first + k]].to);
        enf_json_end_array(json);
        enf_json_end_object(json);
        json->one_line = false;
    }
    enf_json_end_array(json);
}

static void put_polygon(enf_json *json, const enf_file_view *view, const enf_file_portal_polygon *polygon) {
    enf_json_begin_object(json, NULL);
    json->one_line = true;
    enf_json_number(json, "area", polygon->area);
    enf_json_numbers(json, "plane", polygon->plane, 4);
    enf_json_begin_array(json, "vertices");
    for (int32_t k = 0; k < polygon->vertex_count; k++)
        enf_json_numbers(json, NULL, view->portal_vertices[polygon->vertex_first + k], 3);
    enf_json_end_array(json);
    enf_json_end_object(json);
    json->one_line = false;
}

static void put_portals(enf_json *json, const enf_file_view *view) {
    enf_json_begin_array(json, "portals");
    for (int32_t i = 0; i < view->portal_count; i += 2) {
        const enf_file_portal *portal = &view->portals[i];
        const int32_t cells[2] = {portal->from, portal->to};
        enf_json_begin_object(json, NULL);
        enf_json_whole(json, "portal", i / 2);
        enf_json_wholes(json, "cells", cells, 2);
        enf_json_number(json, "area", portal_area(view, portal));
        enf_json_numbers(json, "centre", portal->centre, 3);
        enf_json_number(json, "radius", portal->radius);
        enf_json_begin_array(json, "polygons");
        for (int32_t k = 0; k < portal->polygon_count; k++)
            put_polygon(json, view, &view->portal_polygons[portal->polygon_first + k]);
        enf_json_end_array(json);
        enf_json_end_object(json);
    }
    enf_json_end_array(json);
}

enf_status enf_export_json(const enf_file_view *view, FILE *out, enf_error *error) {
    (void)error;
    enf_json json = {.file = out};
    enf_json_begin_object(&json, NULL);
    put_cells(&json, view);
    put_portals(&json, view);
    enf_json_begin_array(&json, "spawns");
    for (int32_t i = 0; i < view->spawn_count; i++) {
        enf_json_begin_object(&json, NULL);
        json.one_line = true;
        enf_json_numbers(&json, "position", view->spawns[i].position, 3);
        enf_json_whole(&json, "cell", view->spawns[i].cell);
        enf_json_end_object(&json);
        json.one_line = false;
    }
    enf_json_end_array(&json);
    enf_json_end_object(&json);
    enf_json_finish(&json);
    return ENF_OK;
}
