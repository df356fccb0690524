// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade info: what is in a world file.
#include "build/json.h"
#include "cli/cli.h"
#include "cli/options.h"
#include "cli/world.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

int cli_open_world(enf_world **world, const char *path) {
    enf_error error = {0};
    return enf_world_open_path(world, path, NULL, &error) == ENF_OK ? ENF_OK : cli_fail(&error);
}

static void put_regions(enf_json *json, const enf_file_view *file) {
    enf_json_begin_array(json, "region_list");
    for (int32_t i = 0; i < file->region_count; i++) {
        const enf_file_region *region = &file->regions[i];
        enf_json_begin_object(json, NULL);
        json->one_line = true;
        enf_json_text(json, "kind", enf_world_kind_name((enf_world_kind)region->kind));
        enf_json_bool(json, "kept", region->kept);
        enf_json_number(json, "volume", region->volume);
        enf_json_whole(json, "winding", region->winding);
        enf_json_bool(json, "touches_outside", region->touches_outside);
        enf_json_bool(json, "ambiguous", region->ambiguous);
        enf_json_end_object(json);
        json->one_line = false;
    }
    enf_json_end_array(json);
}

static void put_spawns(enf_json *json, const enf_file_view *file) {
    enf_json_begin_array(json, "spawn_list");
    for (int32_t i = 0; i < file->spawn_count; i++) {
        enf_json_begin_object(json, NULL);
        json->one_line = true;
        enf_json_numbers(json, "position", file->spawns[i].position, 3);
        enf_json_whole(json, "cell", file->spawns[i].cell);
        enf_json_end_object(json);
        json->one_line = false;
    }
    enf_json_end_array(json);
}

static void put_sections(enf_json *json, const enf_file_view *file) {
    enf_json_begin_array(json, "sections");
    for (uint32_t i = 0; i < file->header->section_count; i++) {
        const enf_file_section *section = &file->sections[i];
        char tag[9] = {0};
        for (int k = 0; k < 8; k++) tag[k] = section->tag[k];
        enf_json_begin_object(json, NULL);
        json->one_line = true;
        enf_json_text(json, "tag", tag);
        enf_json_whole(json, "count", (int64_t)section->count);
        enf_json_whole(json, "bytes", (int64_t)section->size);
        enf_json_end_object(json);
        json->one_line = false;
    }
    enf_json_end_array(json);
}

static void put_origin(enf_json *json, const enf_world_info *info) {
    char text[32];
    enf_json_begin_object(json, "file");
    snprintf(text, sizeof text, "%" PRIu32 ".%" PRIu32, info->file_major, info->file_minor);
    enf_json_text(json, "format", text);
    snprintf(text, sizeof text, "%" PRIu32 ".%" PRIu32 ".%" PRIu32, info->version[0], info->version[1],
             info->version[2]);
    enf_json_text(json, "compiler", text);
    enf_json_whole(json, "bytes", (int64_t)info->file_size);
    enf_json_bool(json, "has_exact", info->has_exact);
    enf_json_bool(json, "has_geometry", info->has_geometry);
    enf_json_end_object(json);
    enf_json_begin_object(json, "input");
    snprintf(text, sizeof text, "%016" PRIx64, info->input_hash);
    enf_json_text(json, "hash", text);
    enf_json_whole(json, "vertices", info->input_vertices);
    enf_json_whole(json, "polygons", info->input_polygons);
    enf_json_whole(json, "rejected", info->input_rejected);
    enf_json_end_object(json);
    enf_json_text(json, "options", info->options); // as it stands in the file, so it may be anything
}

static void print_json(const enf_world *world, const enf_world_info *info) {
    const enf_file_view *file = enf_world_file(world);
    enf_json json = {.file = stdout};
    enf_json_begin_object(&json, NULL);
    put_origin(&json, info);
    enf_json_whole(&json, "vertices", info->points);
    enf_json_whole(&json, "polygons", info->polygons);
    enf_json_whole(&json, "tetrahedra", info->tetrahedra);
    enf_json_whole(&json, "cells_split", info->tetrahedra_cut);
    enf_json_whole(&json, "fine_cells", info->fine_cells);
    enf_json_whole(&json, "fine_cells_discarded", info->fine_cells_discarded);
    enf_json_whole(&json, "fine_cells_active", info->fine_cells_active);
    enf_json_whole(&json, "regions", info->regions);
    enf_json_whole(&json, "regions_kept", info->regions_kept);
    put_regions(&json, file);
    enf_json_whole(&json, "portals_initial", info->portals_initial);
    enf_json_whole(&json, "collapses", info->collapses);
    enf_json_whole(&json, "cells", info->cells);
    enf_json_whole(&json, "portals", info->portals);
    enf_json_whole(&json, "portal_polygons", info->portal_polygons);
    enf_json_number(&json, "volume", info->volume_kept);
    enf_json_numbers(&json, "box_min", info->box_min, 3);
    enf_json_numbers(&json, "box_max", info->box_max, 3);
    enf_json_number(&json, "grid_step", info->grid_step);
    enf_json_number(&json, "weld", info->weld);
    enf_json_number(&json, "plane_tolerance", info->plane_tolerance);
    enf_json_number(&json, "displacement_max", info->displacement_max);
    enf_json_number(&json, "displacement_mean", info->displacement_mean);
    enf_json_whole(&json, "spawns", info->spawns);
    enf_json_whole(&json, "spawns_in_cells", info->spawns_in_cells);
    put_spawns(&json, file);
    enf_json_whole(&json, "triangles", info->triangles);
    enf_json_whole(&json, "detail_triangles", info->detail_triangles);
    enf_json_bool(&json, "leak", info->leak);
    put_sections(&json, file);
    enf_json_end_object(&json);
    enf_json_finish(&json);
}

enum { SPAWNS_SHOWN = 64 };

static void print_spawns(const enf_file_view *file) {
    for (int32_t i = 0; i < file->spawn_count && i < SPAWNS_SHOWN; i++) {
        const enf_file_spawn *spawn = &file->spawns[i];
        printf("  spawn %" PRId32 " (%g %g %g): ", i, spawn->position[0], spawn->position[1],
               spawn->position[2]);
        if (spawn->cell >= 0)
            printf("cell %" PRId32 "\n", spawn->cell);
        else
            puts("in no cell");
    }
    if (file->spawn_count > SPAWNS_SHOWN)
        printf("  ... and %d more (--json)\n", (int)file->spawn_count - SPAWNS_SHOWN);
}

static void print_text(const char *path, const enf_world *world, const enf_world_info *info) {
    const enf_file_view *file = enf_world_file(world);
    printf("%s: %" PRIu64 " bytes in %" PRIu32 " sections, format %" PRIu32 ".%" PRIu32
           ", by enfilade %" PRIu32 ".%" PRIu32 ".%" PRIu32 "\n",
           path, info->file_size, info->section_count, info->file_major, info->file_minor, info->version[0],
           info->version[1], info->version[2]);
    printf("input      %" PRId64 " vertices, %" PRId64 " polygons, %" PRId64 " left out; hash %016" PRIx64
           "\n",
           info->input_vertices, info->input_polygons, info->input_rejected, info->input_hash);
    printf("options    %s\n", *info->options ? info->options : "not recorded");
    printf("box        %g %g %g .. %g %g %g, grid step %g\n", info->box_min[0], info->box_min[1],
           info->box_min[2], info->box_max[0], info->box_max[1], info->box_max[2], info->grid_step);
    printf("clean      %" PRId64 " vertices, %" PRId64 " polygons; moved by at most %g, %g on average\n",
           info->points, info->polygons, info->displacement_max, info->displacement_mean);
    printf("fine cells %" PRId64 ", from %" PRId64 " tetrahedra of which %" PRId64 " were cut; %" PRId64
           " kept\n",
           info->fine_cells, info->tetrahedra, info->tetrahedra_cut, info->fine_cells_active);
    printf("regions    %" PRId64 ", %" PRId64 " kept:", info->regions, info->regions_kept);
    for (int kind = 0; kind < 3; kind++)
        printf(" %" PRId64 " %s (volume %.6g)%s", info->regions_of_kind[kind],
               enf_world_kind_name((enf_world_kind)kind), info->volume_of_kind[kind], kind < 2 ? "," : "\n");
    printf("cells      %" PRId64 ", volume %.6g, after %" PRId64 " collapses\n", info->cells,
           info->volume_kept, info->collapses);
    printf("portals    %" PRId64 " in %" PRId64 " polygons; at most %" PRId64 " at a cell\n", info->portals,
           info->portal_polygons, info->portals_of_cell_max);
    printf("drawn      %" PRId64 " triangles, %" PRId64 " of them detail; %" PRId64 " groups, %" PRId64
           " materials\n",
           info->triangles, info->detail_triangles, info->groups, info->materials);
    printf("spawns     %" PRId64 ", %" PRId64 " in cells%s\n", info->spawns, info->spawns_in_cells,
           info->leak ? "; LEAK: one can reach the outside" : "");
    print_spawns(file);
}

int cli_info(int argc, char **argv) {
    bool as_json = false;
    cli_option options[] = {
        {"--json", 0, CLI_FLAG, &as_json, NULL, "everything, as JSON", NULL, false},
        {0},
    };
    const cli_syntax syntax = {.command = "enfilade info",
                               .usage = "WORLD.enf [--json]",
                               .summary = "Says what is in a world file.",
                               .options = options,
                               .operands_min = 1,
                               .operands_max = 1,
                               .operand = "the world file"};
    cli_texts operands = {0};
    int status = cli_parse(&syntax, argc, argv, &operands);
    enf_world *world = NULL;
    if (status < 0) status = cli_open_world(&world, operands.items[0]);
    if (world) {
        enf_world_info info;
        enf_world_get_info(world, &info);
        if (as_json)
            print_json(world, &info);
        else
            print_text(operands.items[0], world, &info);
    }
    enf_world_close(world);
    free(operands.items);
    return status;
}
