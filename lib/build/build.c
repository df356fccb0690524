// SPDX-License-Identifier: GPL-3.0-or-later
// The recipe: clean > tetrahedralize > split > connect > colour > decimate > portals. Each stage takes what
// the one before it leaves.
#include "build/build.h"

#include "base/array.h"
#include "base/memory.h"
#include "base/timer.h"
#include "build/arrangement.h"
#include "build/connect.h"
#include "build/delaunay.h"
#include "build/flip.h"
#include "build/hairline.h"
#include "build/split.h"
#include "build/tet_order.h"
#include "shim/shim.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// What lives only while the recipe runs.
typedef struct kitchen {
    enf_build *build;
    const enf_build_options *options;
    enf_error *error;
    enf_tet_mesh tets; ///< until the arrangement takes them
    enf_arrangement arrangement;
    const char *stage;
    double begun, share; ///< the part of the stage that is at work: where it begins and how much it is of all
    enf_crew crew;
} kitchen;

void enf_build_free(enf_build *build) {
    enf_soup_free(&build->soup);
    enf_mesh_free(&build->mesh);
    enf_complex_free(&build->complex);
    enf_regions_free(&build->regions);
    enf_decimation_free(&build->decimation);
    enf_portals_free(&build->portals);
    free(build->cell_of);
    memset(build, 0, sizeof *build);
}

static void say(kitchen *k, const char *format, ...) ENF_PRINTF(2, 3);

/// What the stage did and what it did not have to do.
static void say(kitchen *k, const char *format, ...) {
    enf_stage_report *report = &k->build->stages[k->build->stage_count - 1];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(report->why, sizeof report->why, format, arguments);
    va_end(arguments);
}

static bool tell(void *user, double fraction) {
    kitchen *k = user;
    return !k->options->progress ||
           k->options->progress(k->options->progress_user, k->stage, k->begun + k->share * fraction);
}

// ---------------------------------------------------------------------------------------------- stages

static enf_status clean(kitchen *k) {
    enf_mesh *mesh = &k->build->mesh;
    enf_status status = enf_mesh_clean(mesh, &k->build->soup, &k->options->clean, k->error);
    if (status != ENF_OK) return status;
    static const char *const turns[] = {
        [ENF_TURN_OFF] = "no planes recovered: tolerance 0",
        [ENF_TURN_ROUND] = "not turned: round coordinates",
        [ENF_TURN_ALIGNED] = "not turned: axis-parallel already",
        [ENF_TURN_NONE] = "not turned: no common axes",
        [ENF_TURN_FOUND] = "turned to its own axes",
    };
    say(k, "%zu polygons kept, %zu lines rejected, %zu points welded, %zu polygons triangulated; %s",
        mesh->polygon_count, k->build->soup.rejected_count, mesh->welded, mesh->triangulated,
        turns[mesh->turn_outcome]);
    return ENF_OK;
}

static enf_status tetrahedralize(kitchen *k) {
    const enf_mesh *mesh = &k->build->mesh;
    enf_memory_counts *counts = &k->build->counts;
    *counts = enf_memory_count(&k->build->soup, mesh);
    k->build->peak_bytes_least = k->build->peak_bytes_predicted = enf_memory_estimate(counts);
    const enf_memory_allowance allowed = enf_memory_allow(k->options->memory);
    enf_status status = enf_memory_admit(counts, allowed, k->error);
    if (status != ENF_OK) return status;
    static const struct {
        const char *name;
        enf_status (*run)(const double *points, size_t point_count, enf_tetrahedra *out, enf_error *error);
    } tetrahedralizers[] = {[ENF_TETRAHEDRALIZER_OWN] = {"own code", enf_delaunay},
                            [ENF_TETRAHEDRALIZER_CGAL] = {"CGAL", enf_shim_delaunay_cgal},
                            [ENF_TETRAHEDRALIZER_TETGEN] = {"TetGen", enf_shim_delaunay_tetgen}};
    enf_tetrahedra made = {0};
    int chosen = (int)k->options->tetrahedralizer;
    status = tetrahedralizers[chosen].run(mesh->points, mesh->point_count, &made, k->error);
    if (status != ENF_OK) return status;
    if (!enf_tetrahedra_sort(&made.corners, made.count, mesh->points, mesh->point_count)) {
        free(made.corners);
        return enf_fail_memory(k->error, "the tetrahedra");
    }
    status = enf_tet_mesh_pair(&k->tets, made.corners, made.count, (int32_t)mesh->point_count, k->error);
    if (status != ENF_OK) return status;
    int32_t flips = 0;
    if (!k->options->plain_cells) status = enf_tet_mesh_flip(&k->tets, mesh, &flips, k->error);
    if (status != ENF_OK) return status;
    say(k, "%d tetrahedra by %s, %d flips to edges of polygons", (int)k->tets.count,
        tetrahedralizers[chosen].name, (int)flips);
    enf_memory_count_tetrahedra(counts, mesh, &k->tets);
    k->build->peak_bytes_predicted = enf_memory_estimate(counts);
    return enf_memory_admit(counts, allowed, k->error);
}

static enf_status split(kitchen *k) {
    enf_complex *complex = &k->build->complex;
    k->share = 0.5;
    enf_status status =
        enf_arrangement_make(&k->arrangement, &k->build->mesh, k->tets, k->crew.threads, k->error);
    memset(&k->tets, 0, sizeof k->tets); // taken, or freed
    if (status != ENF_OK) return status;
    k->begun = k->share = 0.5;
    k->arrangement.plain = k->options->plain_cells;
    status = enf_complex_split(complex, &k->arrangement, &k->crew, k->error);
    if (status != ENF_OK) return status;
    say(k, "%d of %d tetrahedra cut; the others already carry their polygons; %d pieces joined to others",
        (int)complex->tetrahedra_cut, (int)complex->tetrahedron_count, (int)complex->cells_joined);
    return ENF_OK;
}

static enf_status connect(kitchen *k) {
    enf_complex *complex = &k->build->complex;
    enf_status status = enf_complex_connect(complex, &k->arrangement, &k->crew, k->error);
    if (status != ENF_OK) return status;
    say(k, "%d facets in %d pieces; %.3f %% of the predicates took pairs of doubles, %.3f %% exact numbers",
        (int)complex->facet_count, (int)complex->pieces.count,
        100 * enf_complex_tier_share(complex, ENF_TIER_PAIRS),
        100 * enf_complex_tier_share(complex, ENF_TIER_EXACT));
    return ENF_OK;
}

/// What is thinner than the tolerances of clean is no opening and no place, grid steps.
static double crack_width(const enf_build *build) {
    return fmax(build->mesh.weld, build->mesh.plane_tolerance) / build->mesh.frame.step;
}

static enf_status colour(kitchen *k) {
    enf_build *build = k->build;
    enf_status status =
        enf_regions_colour(&build->regions, &build->complex, &build->mesh, &k->arrangement.tets,
                           k->options->keep, crack_width(build), k->error);
    enf_arrangement_free(&k->arrangement);
    if (status != ENF_OK) return status;
    int32_t kept = 0;
    for (int32_t r = 0; r < build->regions.region_count; r++) kept += build->regions.kept[r];
    say(k, "%d of %d regions kept, %d cracks sealed", (int)kept, (int)build->regions.region_count,
        (int)build->regions.sealed);
    return ENF_OK;
}

static enf_status decimate(kitchen *k) {
    enf_build *build = k->build;
    enf_complex *complex = &build->complex;
    size_t cells = (size_t)complex->cell_count;
    bool *cell_kept = enf_array_new(cells, sizeof *cell_kept);
    int32_t *node_of = build->cell_of = enf_array_new(cells, sizeof *node_of); // nodes, until they are cells
    int32_t nodes = 0, joined = 0;
    bool good = cell_kept && node_of;
    for (size_t c = 0; good && c < cells; c++)
        cell_kept[c] = build->regions.kept[build->regions.cell_region[c]];
    good = good && enf_complex_number_nodes(complex, cell_kept, crack_width(build), node_of, &nodes, &joined);
    free(cell_kept);
    if (!good) return enf_fail_memory(k->error, "the cells");
    enf_complex_unlist_facets(complex); // this stage needs the most memory, and asks for none of them
    enf_graph graph;
    enf_status status = enf_graph_build(&graph, complex, node_of, nodes, k->error);
    if (status != ENF_OK) return status;
    build->portals_initial = 0;
    for (int32_t p = 0; p < graph.piece_count; p++) build->portals_initial += graph.piece_open[p];
    double unit = build->mesh.frame.step * 0x1p53;
    status = enf_graph_decimate(&graph, k->options->heuristic, &k->options->stop, unit, tell, k,
                                &build->decimation, k->error);
    if (status != ENF_OK) return status;
    if (!enf_complex_list_facets(complex)) return enf_fail_memory(k->error, "the fine complex");
    build->cell_count = build->decimation.cell_count;
    for (int32_t c = 0; c < complex->cell_count; c++) {
        build->cell_of[c] = node_of[c] < 0 ? -1 : build->decimation.cell_of[node_of[c]];
    }
    say(k,
        "%d cells of %d (%d hairline cells joined to others first); %zu weights computed for %zu collapses",
        (int)build->cell_count, (int)nodes, (int)joined, build->decimation.evaluations,
        build->decimation.collapse_count);
    return ENF_OK;
}

static enf_status portals(kitchen *k) {
    enf_build *build = k->build;
    enf_status status = enf_portals_find(&build->portals, &build->complex, build->cell_of, k->error);
    if (status != ENF_OK) return status;
    if (!enf_complex_list_seen(&build->complex)) return enf_fail_memory(k->error, "what cells see");
    say(k, "%d openings; %d pieces joined to %d polygons", (int)build->portals.opening_count,
        (int)build->portals.pieces_merged, (int)build->portals.polygons.count);
    return ENF_OK;
}

// ---------------------------------------------------------------------------------------------- the recipe

static enf_status run_stage(kitchen *k, const char *name, enf_status (*stage)(kitchen *)) {
    k->stage = name;
    k->begun = 0;
    k->share = 1;
    if (!tell(k, 0)) return enf_fail(k->error, ENF_NO_RESOURCES, "cancelled in stage '%s'", name);
    enf_stage_report *report = &k->build->stages[k->build->stage_count++];
    *report = (enf_stage_report){.name = name, .ran = true};
    double start = enf_timer_now(), cpu_start = enf_timer_cpu();
    enf_status status = stage(k);
    report->seconds = enf_timer_now() - start;
    report->cpu_seconds = enf_timer_cpu() - cpu_start;
    report->peak_bytes = enf_memory_peak();
    if (k->options->measure_resident) report->resident_bytes = enf_memory_resident();
    return status;
}

static void skip_stage(kitchen *k, const char *name, const char *why) {
    k->build->stages[k->build->stage_count++] = (enf_stage_report){.name = name};
    say(k, "%s", why);
}

enf_status enf_build_run(enf_build *build, const enf_build_options *options, enf_error *error) {
    static const struct {
        const char *name;
        enf_status (*run)(kitchen *);
    } recipe[ENF_STAGE_COUNT] = {
        [ENF_STAGE_CLEAN] = {"clean", clean},
        [ENF_STAGE_TETRAHEDRALIZE] = {"tetrahedralize", tetrahedralize},
        [ENF_STAGE_SPLIT] = {"split", split},
        [ENF_STAGE_CONNECT] = {"connect", connect},
        [ENF_STAGE_COLOUR] = {"colour", colour},
        [ENF_STAGE_DECIMATE] = {"decimate", decimate},
        [ENF_STAGE_PORTALS] = {"portals", portals},
    };
    kitchen k = {.build = build, .options = options, .error = error};
    k.crew = (enf_crew){.threads = options->threads > 0 ? options->threads : 1, .watch = tell, .user = &k};
    double start = enf_timer_now();
    enf_status status = ENF_OK;
    build->stage_count = 0;
    int wanted = options->stages > 0 ? options->stages : ENF_STAGE_COUNT;
    for (int i = 0; i < ENF_STAGE_COUNT && status == ENF_OK; i++) {
        if (i < wanted)
            status = run_stage(&k, recipe[i].name, recipe[i].run);
        else
            skip_stage(&k, recipe[i].name, "not asked for");
    }
    if (status == ENF_OK) skip_stage(&k, "visibility", "no PVS asked for");
    enf_tet_mesh_free(&k.tets);
    enf_arrangement_free(&k.arrangement);
    build->seconds = enf_timer_now() - start;
    build->peak_bytes = enf_memory_peak();
    return status;
}
