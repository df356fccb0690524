// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report.h"

#include "build/json.h"

#include <inttypes.h>

static const char *const kind_names[] = {"air", "rock", "outside"};

static const char *file_of(const enf_soup *soup, int32_t file) {
    return file >= 0 && (size_t)file < soup->file_count ? soup->files[file] : "input";
}

static void put_rejected(enf_json *json, const enf_soup *soup, const cli_counts *counts) {
    enf_json_begin_array(json, "rejected");
    for (int reason = 0; reason < ENF_REJECT_COUNT; reason++) {
        if (counts->rejected[reason] == 0) continue;
        enf_json_begin_object(json, NULL);
        enf_json_text(json, "reason", enf_reject_name((enf_reject)reason));
        enf_json_whole(json, "count", counts->rejected[reason]);
        enf_json_begin_array(json, "lines");
        for (size_t i = 0; i < soup->rejected_count; i++) {
            const enf_rejected *rejected = &soup->rejected[i];
            if ((int)rejected->reason != reason) continue;
            enf_json_begin_object(json, NULL);
            json->one_line = true;
            enf_json_text(json, "file", file_of(soup, rejected->file));
            enf_json_whole(json, "line", rejected->line);
            enf_json_end_object(json);
            json->one_line = false;
        }
        enf_json_end_array(json);
        enf_json_end_object(json);
    }
    enf_json_end_array(json);
}

static void put_input(enf_json *json, const enf_soup *soup, const cli_counts *counts) {
    enf_json_begin_object(json, "input");
    enf_json_begin_array(json, "files");
    for (size_t i = 0; i < soup->file_count; i++) enf_json_text(json, NULL, soup->files[i]);
    enf_json_end_array(json);
    enf_json_whole(json, "vertices", (int64_t)soup->point_count);
    enf_json_whole(json, "polygons", (int64_t)soup->polygon_count);
    enf_json_whole(json, "spawns", (int64_t)soup->spawn_count);
    char hash[24];
    snprintf(hash, sizeof hash, "%016" PRIx64, soup->content_hash);
    enf_json_text(json, "hash", hash);
    put_rejected(json, soup, counts);
    enf_json_end_object(json);
}

static void put_clean(enf_json *json, const enf_mesh *mesh) {
    enf_json_begin_object(json, "clean");
    enf_json_number(json, "weld", mesh->weld);
    enf_json_number(json, "plane_tolerance", mesh->plane_tolerance);
    enf_json_text(json, "turn", enf_turn_outcome_name(mesh->turn_outcome));
    enf_json_number(json, "aligned", mesh->aligned);
    enf_json_bool(json, "flattened", mesh->flattened);
    enf_json_whole(json, "lattices", mesh->lattices);
    enf_json_whole(json, "welded", (int64_t)mesh->welded);
    enf_json_whole(json, "triangulated", (int64_t)mesh->triangulated);
    enf_json_whole(json, "two_sided", (int64_t)mesh->two_sided);
    enf_json_whole(json, "details", (int64_t)mesh->detail_count);
    enf_json_number(json, "grid_step", mesh->frame.step);
    enf_json_number(json, "displacement_max", mesh->displacement_max);
    enf_json_number(json, "displacement_mean", mesh->displacement_mean);
    enf_json_end_object(json);
}

static void put_regions(enf_json *json, const enf_build *build, const cli_counts *counts) {
    const enf_regions *regions = &build->regions;
    double step = build->mesh.frame.step;
    int64_t ambiguous = 0;
    enf_json_whole(json, "regions", regions->region_count);
    enf_json_whole(json, "regions_kept", counts->regions_kept);
    enf_json_begin_array(json, "region_list");
    for (int32_t i = 0; i < regions->region_count; i++) {
        ambiguous += regions->ambiguous[i];
        enf_json_begin_object(json, NULL);
        json->one_line = true;
        enf_json_text(json, "kind", kind_names[regions->kind[i] % 3]);
        enf_json_bool(json, "kept", regions->kept[i]);
        enf_json_number(json, "volume", regions->volume[i] * step * step * step);
        enf_json_whole(json, "winding", regions->winding[i]);
        enf_json_bool(json, "ambiguous", regions->ambiguous[i]);
        enf_json_end_object(json);
        json->one_line = false;
    }
    enf_json_end_array(json);
    enf_json_whole(json, "regions_ambiguous", ambiguous);
}

static void put_stage(enf_json *json, const enf_stage_report *stage) {
    enf_json_begin_object(json, NULL);
    json->one_line = true;
    enf_json_text(json, "name", stage->name);
    enf_json_number(json, "seconds", stage->seconds);
    enf_json_number(json, "cpu_seconds", stage->cpu_seconds);
    enf_json_whole(json, "peak_bytes", (int64_t)stage->peak_bytes);
    enf_json_whole(json, "resident_bytes", (int64_t)stage->resident_bytes);
    enf_json_bool(json, "ran", stage->ran);
    enf_json_text(json, "why", stage->why);
    enf_json_end_object(json);
    json->one_line = false;
}

static void put_stages(enf_json *json, const cli_job *job) {
    enf_json_begin_array(json, "stages");
    put_stage(json, &job->read);
    for (int i = 0; i < job->build.stage_count; i++) put_stage(json, &job->build.stages[i]);
    put_stage(json, &job->write);
    enf_json_end_array(json);
}

static void put_graph(enf_json *json, const cli_job *job, const cli_counts *counts) {
    const enf_build *build = &job->build;
    enf_json_whole(json, "vertices", build->mesh.point_count ? (int64_t)build->mesh.point_count : 0);
    enf_json_whole(json, "polygons", (int64_t)build->mesh.polygon_count);
    enf_json_whole(json, "tetrahedra", build->complex.tetrahedron_count);
    enf_json_whole(json, "cells_split", build->complex.tetrahedra_cut);
    enf_json_whole(json, "fine_cells", build->complex.cell_count);
    enf_json_whole(json, "cells_joined", build->complex.cells_joined);
    put_regions(json, build, counts);
    enf_json_whole(json, "fine_cells_discarded", counts->fine_discarded);
    enf_json_whole(json, "fine_cells_active", counts->fine_active);
    enf_json_whole(json, "portals_initial", build->portals_initial);
    enf_json_whole(json, "collapses", (int64_t)build->decimation.collapse_count);
    enf_json_whole(json, "weight_evaluations", (int64_t)build->decimation.evaluations);
    enf_json_number(json, "next_weight", build->decimation.next_weight); // null: nothing was left to collapse
    enf_json_text(json, "heuristic", enf_heuristic_name(job->options.heuristic));
    enf_json_whole(json, "cells", build->cell_count);
    enf_json_whole(json, "portals", build->portals.opening_count);
    enf_json_whole(json, "portal_polygons", build->portals.polygons.count);
    enf_json_whole(json, "pieces_merged", build->portals.pieces_merged);
    enf_json_whole(json, "slivers", build->portals.slivers);
    enf_json_whole(json, "spawns", build->regions.spawn_count);
    enf_json_whole(json, "spawns_in_cells", counts->spawns_in_cells);
    enf_json_begin_object(json, "pvs");
    const enf_pvs *pvs = &job->visibility.pvs;
    enf_json_text(json, "method", pvs->rows ? enf_method_name(job->visibility.method) : "none");
    enf_json_whole(json, "pairs", pvs->rows ? enf_pvs_pairs(pvs) : 0);
    enf_json_end_object(json);
    enf_json_bool(json, "leak", build->regions.leak);
    if (build->regions.leak) {
        enf_json_whole(json, "leak_spawn", build->regions.leak_spawn);
        enf_json_number(json, "leak_width", build->regions.leak_width * build->mesh.frame.step);
    }
    enf_json_begin_object(json, "predicates");
    enf_json_whole(json, "filter", (int64_t)build->complex.predicates[ENF_TIER_FILTER]);
    enf_json_whole(json, "pairs", (int64_t)build->complex.predicates[ENF_TIER_PAIRS]);
    enf_json_whole(json, "exact", (int64_t)build->complex.predicates[ENF_TIER_EXACT]);
    enf_json_end_object(json);
}

void cli_report_json(const cli_job *job, FILE *out) {
    cli_counts counts = cli_job_count(job);
    enf_json json = {.file = out};
    enf_json_begin_object(&json, NULL);
    enf_json_text(&json, "program", "enfilade " ENF_VERSION_TEXT);
    put_input(&json, &job->build.soup, &counts);
    put_clean(&json, &job->build.mesh);
    put_graph(&json, job, &counts);
    put_stages(&json, job);
    enf_json_number(&json, "seconds", job->seconds);
    enf_json_whole(&json, "peak_bytes", (int64_t)job->peak_bytes);
    enf_json_whole(&json, "peak_bytes_least", (int64_t)job->build.peak_bytes_least);
    enf_json_whole(&json, "peak_bytes_predicted", (int64_t)job->build.peak_bytes_predicted);
    enf_json_whole(&json, "file_bytes", (int64_t)job->file_size);
    enf_json_whole(&json, "threads", job->settings->threads);
    enf_json_raw(&json, "options", job->options_json);
    enf_json_end_object(&json);
    enf_json_finish(&json);
}

static void print_rejections(const enf_soup *soup, const cli_counts *counts, FILE *out) {
    if (soup->rejected_count == 0) return;
    fprintf(out, "left out: %zu of %zu polygons and lines (", soup->rejected_count, soup->polygon_count);
    const char *comma = "";
    for (int reason = 0; reason < ENF_REJECT_COUNT; reason++) {
        if (counts->rejected[reason] == 0) continue;
        fprintf(out, "%s%" PRId64 " %s", comma, counts->rejected[reason],
                enf_reject_name((enf_reject)reason));
        comma = ", ";
    }
    fputs("); -v lists them\n", out);
}

void cli_report_summary(const cli_job *job, const char *output, FILE *out) {
    const enf_build *build = &job->build;
    cli_counts counts = cli_job_count(job);
    print_rejections(&build->soup, &counts, out);
    fprintf(out,
            "%s: %" PRId32 " cells, %" PRId32 " portals; from %" PRId32 " tetrahedra, %" PRId32
            " fine cells (%" PRId64 " kept); %.2f s, %.0f MB\n",
            output, build->cell_count, build->portals.opening_count, build->complex.tetrahedron_count,
            build->complex.cell_count, counts.fine_active, job->seconds, (double)job->peak_bytes / 1e6);
}

static void print_stage(FILE *out, const enf_stage_report *stage) {
    fprintf(out, "%-14s %8.3f s %7.0f MB  %s%s\n", stage->name, stage->seconds,
            (double)stage->resident_bytes / 1e6, stage->ran ? "" : "skipped: ", stage->why);
}

static void print_more(const cli_job *job, const cli_counts *counts, FILE *out) {
    const enf_build *build = &job->build;
    const enf_mesh *mesh = &build->mesh;
    fprintf(out,
            "  clean: %zu vertices of %zu; grid step %g, points moved by at most %g; weld %g, plane "
            "tolerance %g; "
            "%zu two-sided and %zu detail polygons\n",
            mesh->point_count, build->soup.point_count, mesh->frame.step, mesh->displacement_max, mesh->weld,
            mesh->plane_tolerance, mesh->two_sided, mesh->detail_count);
    fprintf(out,
            "  colour: %" PRId64 " fine cells kept, %" PRId64 " discarded; %" PRId64 " of %" PRId32
            " spawn points in cells\n",
            counts->fine_active, counts->fine_discarded, counts->spawns_in_cells, build->regions.spawn_count);
    fprintf(out, "  decimate: by %s, stop %s; the next collapse would weigh %g\n",
            enf_heuristic_name(job->options.heuristic), job->settings->stop, build->decimation.next_weight);
    fprintf(out, "  portals: %" PRId32 " slivers dropped\n", build->portals.slivers);
}

void cli_report_verbose(const cli_job *job, FILE *out) {
    const enf_build *build = &job->build;
    const enf_soup *soup = &build->soup;
    cli_counts counts = cli_job_count(job);
    for (size_t i = 0; i < soup->rejected_count; i++)
        fprintf(out, "%s:%" PRId64 ": left out: %s\n", file_of(soup, soup->rejected[i].file),
                soup->rejected[i].line, enf_reject_name(soup->rejected[i].reason));
    print_stage(out, &job->read);
    for (int i = 0; i < build->stage_count; i++) print_stage(out, &build->stages[i]);
    print_stage(out, &job->write);
    fprintf(
        out,
        "  memory: at most %.0f MB; predicted %.0f MB, and at least %.0f MB before there were tetrahedra\n",
        (double)job->peak_bytes / 1e6, (double)build->peak_bytes_predicted / 1e6,
        (double)build->peak_bytes_least / 1e6);
    print_more(job, &counts, out);
}
