// SPDX-License-Identifier: MIT
// The summary of a world.
#include "enfilade/run.h"

#include <string.h>

static void count_regions(const enf_file_view *file, enf_world_info *info) {
    info->regions = file->region_count;
    for (int32_t i = 0; i < file->region_count; i++) {
        const enf_file_region *region = &file->regions[i];
        info->regions_of_kind[region->kind]++;
        info->volume_of_kind[region->kind] += region->volume;
        if (!region->kept) continue;
        info->regions_kept++;
        info->volume_kept += region->volume;
    }
    info->spawns = file->spawn_count;
    for (int32_t i = 0; i < file->spawn_count; i++) info->spawns_in_cells += file->spawns[i].cell >= 0;
}

static void count_cells(const enf_file_view *file, enf_world_info *info) {
    info->cells = file->cell_count;
    info->portals = file->portal_count / 2;
    info->portal_polygons = file->portal_polygon_count / 2;
    for (int32_t i = 0; i < file->cell_count; i++) {
        if (file->cells[i].portal_count > info->portals_of_cell_max)
            info->portals_of_cell_max = file->cells[i].portal_count;
    }
    info->triangles = file->triangle_count;
    for (int32_t i = 0; i < file->triangle_count; i++)
        info->detail_triangles += file->triangles[i].mesh_polygon < 0;
    info->groups = file->group_count;
    info->materials = file->material_count;
}

void enf_world_get_info(const enf_world *world, enf_world_info *info) {
    const enf_file_view *file = enf_world_file(world);
    const enf_file_provenance *made = file->provenance;
    memset(info, 0, sizeof *info);
    info->file_major = file->header->major;
    info->file_minor = file->header->minor;
    memcpy(info->version, made->version, sizeof info->version);
    info->input_hash = made->input_hash;
    info->options = enf_world_string(world, made->options);
    info->file_size = file->header->file_size;
    info->section_count = file->header->section_count;
    info->points = file->point_count;
    info->polygons = file->mesh_polygon_count;
    info->tetrahedra = file->tetrahedron_count;
    info->tetrahedra_cut = made->tetrahedra_cut;
    info->fine_cells = file->fine_count;
    info->fine_cells_discarded = made->fine_cells_discarded;
    info->fine_cells_active = made->fine_cells_active;
    info->sealed = made->sealed;
    info->sealed_area = made->sealed_area;
    info->portals_initial = made->portals_initial;
    info->collapses = made->collapses;
    info->input_vertices = made->input_vertices;
    info->input_polygons = made->input_polygons;
    info->input_rejected = made->input_rejected;
    count_regions(file, info);
    count_cells(file, info);
    memcpy(info->box_min, file->frame->box_min, sizeof info->box_min);
    memcpy(info->box_max, file->frame->box_max, sizeof info->box_max);
    info->grid_step = file->frame->step;
    info->weld = file->frame->weld;
    info->plane_tolerance = file->frame->plane_tolerance;
    info->displacement_max = file->frame->displacement_max;
    info->displacement_mean = file->frame->displacement_mean;
    info->leak = made->leak != 0;
    info->has_exact = file->has_exact;
    info->has_geometry = file->has_geometry;
}

const char *enf_world_kind_name(enf_world_kind kind) {
    static const char *const names[] = {"air", "rock", "outside"};
    return kind == ENF_WORLD_AIR || kind == ENF_WORLD_ROCK ? names[kind] : names[ENF_WORLD_OUTSIDE];
}
