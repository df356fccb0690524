// SPDX-License-Identifier: GPL-3.0-or-later
// What the exporters write, against what the file says and what point location answers.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "build/export.h"
#include "build/json.h"
#include "build/plan.h"
#include "build/soup.h"
#include "enfilade/run.h"
#include "process.h"

/// A world compiled by the program.
typedef struct fixture {
    const char *gen;
    enf_world *world;
    const enf_file_view *view;
} fixture;

static const char *const worlds[] = {"four-rooms", "cavern", "furnished", "office floors=3 rooms=4", "post"};
enum { WORLD_COUNT = sizeof worlds / sizeof *worlds };
static fixture fixtures[WORLD_COUNT];

static void must_run(const char *format, const char *word) {
    char line[256];
    snprintf(line, sizeof line, format, word);
    process ran = run_enfilade(NULL, line);
    if (ran.status) print_error("%s: %s\n", line, ran.err);
    assert_int_equal(ran.status, 0);
    process_free(&ran);
}

static int enter(void **state) {
    (void)state;
    if (!enter_test_folder()) return -1;
    for (int i = 0; i < WORLD_COUNT; i++) {
        must_run("gen %s -o world.obj", worlds[i]);
        must_run("compile world.obj -o world.enf --stop cells=%s", "24");
        fixture *made = &fixtures[i];
        made->gen = worlds[i];
        enf_error error;
        if (enf_world_open_path(&made->world, "world.enf", NULL, &error)) return -1;
        made->view = enf_world_file(made->world);
    }
    return 0;
}

static int leave(void **state) {
    (void)state;
    for (int i = 0; i < WORLD_COUNT; i++) enf_world_close(fixtures[i].world);
    leave_test_folder();
    return 0;
}

typedef enf_status exporter(const enf_file_view *view, FILE *out, enf_error *error);

static enf_status export_svg(const enf_file_view *view, FILE *out, enf_error *error) {
    const enf_svg_options options = {.title = "a <world> & \"more\"", .up = 2};
    return enf_export_svg(view, &options, out, error);
}

static char *export_text(exporter *export, const enf_file_view *view) {
    size_t size;
    enf_error error = {0};
    FILE *file = fopen("exported", "wb");
    assert_non_null(file);
    assert_int_equal(export(view, file, &error), ENF_OK);
    assert_int_equal(fclose(file), 0);
    char *text = read_file("exported", &size);
    assert_non_null(text);
    return text;
}

static int64_t count_of(const char *text, const char *word) {
    int64_t count = 0;
    for (const char *at = strstr(text, word); at; at = strstr(at + 1, word)) count++;
    return count;
}

/// Twice the area vector of a polygon.
static void area_vector(const double (*corners)[3], int64_t count, double out[3]) {
    out[0] = out[1] = out[2] = 0;
    for (int64_t k = 0; k < count; k++)
        for (int a = 0; a < 3; a++) {
            const double *p = corners[k], *q = corners[(k + 1) % count];
            int b = (a + 1) % 3, c = (a + 2) % 3;
            out[a] += (p[b] - corners[0][b]) * (q[c] - corners[0][c]) -
                      (p[c] - corners[0][c]) * (q[b] - corners[0][b]);
        }
}

static void obj_reads_back_as_the_cells_triangles_and_the_portals(void **state) {
    (void)state;
    for (int i = 0; i < WORLD_COUNT; i++) {
        const enf_file_view *view = fixtures[i].view;
        char *text = export_text(enf_export_obj, view);
        write_text("export.obj", text);
        enf_soup soup = {0};
        enf_error error = {0};
        assert_int_equal(enf_soup_read(&soup, "export.obj", &error), ENF_OK);
        assert_int_equal(soup.rejected_count, 0);
        assert_int_equal(soup.spawn_count, view->spawn_count);
        assert_int_equal(soup.polygon_count, view->cell_triangle_count + view->portal_polygon_count / 2);
        assert_int_equal(count_of(text, "\ng cell-"), view->cell_count);
        assert_int_equal(count_of(text, "\ng portal-"), view->portal_count / 2);
        // The portals' polygons come last, in order: as large as the file says, facing the lower cell.
        size_t polygon = (size_t)view->cell_triangle_count;
        for (int32_t p = 0; p < view->portal_count; p += 2)
            for (int32_t k = 0; k < view->portals[p].polygon_count; k++, polygon++) {
                const enf_file_portal_polygon *wanted =
                    &view->portal_polygons[view->portals[p].polygon_first + k];
                int64_t first = soup.polygon_corner[polygon],
                        count = soup.polygon_corner[polygon + 1] - first;
                double corners[64][3], area[3];
                assert_true(count == wanted->vertex_count && count <= 64);
                for (int64_t c = 0; c < count; c++)
                    memcpy(corners[c], &soup.points[3 * soup.corner_point[first + c]], sizeof corners[c]);
                area_vector((const double(*)[3])corners, count, area);
                double along = 0;
                for (int a = 0; a < 3; a++) along += area[a] * wanted->plane[a] / 2;
                assert_true(fabs(along - wanted->area) <= 1e-9 * (1 + wanted->area));
            }
        enf_soup_free(&soup);
        free(text);
    }
}

static void dot_and_json_name_every_cell_and_portal(void **state) {
    (void)state;
    for (int i = 0; i < WORLD_COUNT; i++) {
        const enf_file_view *view = fixtures[i].view;
        char *dot = export_text(enf_export_dot, view), *json = export_text(enf_export_json, view);
        assert_int_equal(count_of(dot, " -- "), view->portal_count / 2);
        assert_int_equal(count_of(dot, "volume"), view->cell_count);
        int64_t marked = 0;
        for (int32_t c = 0; c < view->cell_count; c++) {
            bool has_spawn = false;
            for (int32_t s = 0; s < view->spawn_count; s++)
                has_spawn = has_spawn || view->spawns[s].cell == c;
            marked += has_spawn;
        }
        assert_int_equal(count_of(dot, "doublecircle"), marked);
        assert_int_equal(count_of(json, "{\"cell\": "), view->cell_count);
        assert_int_equal(count_of(json, "\"portal\": "), view->portal_count / 2);
        assert_int_equal(count_of(json, "\"plane\": "), view->portal_polygon_count / 2);
        assert_int_equal(count_of(json, "\"position\": "), view->spawn_count);
        assert_int_equal(count_of(json, "{"), count_of(json, "}"));
        assert_int_equal(count_of(json, "["), count_of(json, "]"));
        free(dot);
        free(json);
    }
}

static bool is_inside(const enf_storey *storey, const enf_plan_area *area, const double at[2],
                      double *nearest) {
    bool inside = true;
    for (int32_t k = 0; k < area->corner_count; k++) {
        const double *p = storey->corners[area->corner_first + k];
        const double *q = storey->corners[area->corner_first + (k + 1) % area->corner_count];
        double side = (q[0] - p[0]) * (at[1] - p[1]) - (q[1] - p[1]) * (at[0] - p[0]);
        double distance = side / hypot(q[0] - p[0], q[1] - p[1]);
        *nearest = fmin(*nearest, fabs(distance));
        inside = inside && side >= 0;
    }
    return inside;
}

/// Point location is other code, so it is the judge of the cuts; along all three axes.
static void a_cut_shows_at_every_point_the_cell_that_locate_finds(void **state) {
    (void)state;
    for (int i = 0; i < WORLD_COUNT * 3; i++) {
        const fixture *it = &fixtures[i / 3];
        enf_plan plan;
        enf_error error = {0};
        assert_int_equal(enf_plan_make(&plan, it->view, i % 3, &error), ENF_OK);
        uint64_t seed = 99 + (uint64_t)i;
        int compared = 0;
        for (int n = 0; n < 2000; n++) {
            double at[2], world[3], nearest = INFINITY;
            const enf_storey *storey = &plan.storeys[n % plan.storey_count];
            for (int a = 0; a < 2; a++) {
                seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
                at[a] = plan.low[a] + (plan.high[a] - plan.low[a]) * (double)(seed >> 11) * 0x1p-53;
            }
            world[plan.right] = at[0];
            world[plan.ahead] = plan.ahead_sign * at[1];
            world[plan.up] = storey->height;
            int32_t cell = -1;
            for (int32_t k = 0; k < storey->area_count; k++)
                if (is_inside(storey, &storey->areas[k], at, &nearest)) cell = storey->areas[k].cell;
            if (nearest < 1e-9) continue; // on a border both answers are right
            compared++;
            assert_int_equal(cell, enf_world_locate(it->world, world, -1).cell);
        }
        assert_true(compared > 1500);
        enf_plan_free(&plan);
    }
}

static void an_office_has_a_plan_for_each_floor(void **state) {
    (void)state;
    static const struct {
        const char *gen;
        int storeys;
    } cases[] = {
        {"office floors=1 rooms=3", 1}, {"office floors=2 rooms=6", 2}, {"office floors=5 rooms=2", 5}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        must_run("gen %s -o tower.obj", cases[i].gen);
        must_run("compile tower.obj -o %s --stop cells=60", "tower.enf");
        enf_world *world;
        enf_error error = {0};
        assert_int_equal(enf_world_open_path(&world, "tower.enf", NULL, &error), ENF_OK);
        const enf_file_view *view = enf_world_file(world);
        enf_plan plan;
        assert_int_equal(enf_plan_make(&plan, view, 2, &error), ENF_OK);
        assert_int_equal(plan.storey_count, cases[i].storeys);
        char *svg = export_text(export_svg, view);
        assert_int_equal(count_of(svg, "<g class=\"cells\">"), cases[i].storeys);
        // Every spawn point stands in a room that its storey's plan shows.
        for (int32_t s = 0; s < view->spawn_count; s++) {
            bool shown = false;
            for (int k = 0; k < plan.storey_count; k++)
                for (int32_t a = 0; a < plan.storeys[k].area_count; a++)
                    shown = shown || plan.storeys[k].areas[a].cell == view->spawns[s].cell;
            assert_true(shown);
        }
        free(svg);
        enf_plan_free(&plan);
        enf_world_close(world);
    }
}

/// Tags open and close in order; attributes are quoted; & and < are escaped.
static void expect_well_formed(const char *xml) {
    char stack[32][32];
    int depth = 0;
    for (const char *at = strchr(xml, '<'); at; at = strchr(at, '<')) {
        const char *end = strchr(at, '>');
        assert_non_null(end);
        size_t length = strcspn(at + 1, " \n/>");
        if (at[1] == '/') {
            assert_true(depth > 0);
            length = strcspn(at + 2, ">");
            assert_true(strlen(stack[--depth]) == length && strncmp(stack[depth], at + 2, length) == 0);
        } else if (end[-1] != '/') {
            assert_true(depth < 32 && length < 32);
            snprintf(stack[depth++], 32, "%.*s", (int)length, at + 1);
        }
        int quotes = 0;
        for (const char *c = at; c < end; c++) quotes += *c == '"';
        assert_int_equal(quotes % 2, 0);
        at = end;
    }
    assert_int_equal(depth, 0);
}

static void svg_is_well_formed_and_has_all_spawns(void **state) {
    (void)state;
    for (int i = 0; i < WORLD_COUNT; i++) {
        const enf_file_view *view = fixtures[i].view;
        char *svg = export_text(export_svg, view);
        expect_well_formed(svg);
        assert_non_null(strstr(svg, "a &#60;world&#62; &#38; &#34;more&#34;"));
        assert_int_equal(count_of(svg, "<circle"), view->spawn_count + 1); // one in the legend
        static const char *const wrong[] = {" nan", "\"nan", "Mnan", "Lnan", "inf", "-nan"};
        for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) assert_null(strstr(svg, wrong[k]));
        free(svg);
    }
}

static void every_portal_is_drawn(void **state) {
    (void)state;
    for (int i = 0; i < WORLD_COUNT; i++) {
        const enf_file_view *view = fixtures[i].view;
        enf_plan plan;
        enf_error error = {0};
        assert_int_equal(enf_plan_make(&plan, view, 2, &error), ENF_OK);
        char *svg = export_text(export_svg, view);
        int64_t flat = 0;
        for (int32_t p = 0; p < view->portal_count; p += 2) {
            bool cut = false;
            for (int s = 0; s < plan.storey_count; s++)
                for (int32_t k = 0; k < plan.storeys[s].line_count; k++)
                    cut = cut || plan.storeys[s].lines[k].portal == p;
            for (int32_t k = 0; k < view->portals[p].polygon_count; k++)
                flat +=
                    !cut || fabs(view->portal_polygons[view->portals[p].polygon_first + k].plane[2]) > 0.7;
        }
        assert_int_equal(count_of(svg, "<path fill=\"url(#hatch)\"") +
                             count_of(svg, "<path fill=\"none\" stroke-dash"),
                         flat + 2); // two in the legend
        free(svg);
        enf_plan_free(&plan);
    }
}

static void a_world_without_the_parts_needed_is_refused(void **state) {
    (void)state;
    enf_file_view view = *fixtures[0].view;
    enf_error error = {0};
    FILE *out = tmpfile();
    assert_non_null(out);
    view.has_exact = view.has_geometry = false;
    assert_int_equal(export_svg(&view, out, &error), ENF_BAD_INPUT);
    assert_int_equal(enf_export_obj(&view, out, &error), ENF_BAD_INPUT);
    fclose(out);
}

static void json_escapes_what_it_must(void **state) {
    (void)state;
    char *text = NULL;
    size_t size;
    enf_json json = {.file = open_memstream(&text, &size), .one_line = true};
    assert_non_null(json.file);
    enf_json_begin_array(&json, NULL);
    enf_json_text(&json, NULL, "a\"b\\c\n\x01 \xc3\xa9 \xff \xed\xa0\x80");
    enf_json_number(&json, NULL, 0.1);
    enf_json_number(&json, NULL, NAN);
    enf_json_number(&json, NULL, -INFINITY);
    enf_json_number(&json, NULL, 0x1.fffffffffffffp1023);
    enf_json_text(&json, NULL, NULL);
    enf_json_begin_object(&json, NULL);
    enf_json_whole(&json, "n", INT64_MIN);
    enf_json_end_object(&json);
    enf_json_end_array(&json);
    assert_int_equal(fclose(json.file), 0);
    assert_string_equal(
        text, "[\"a\\\"b\\\\c\\u000a\\u0001 \xc3\xa9 \\ufffd \\ufffd\\ufffd\\ufffd\", 0.1, null, null, "
              "1.7976931348623157e+308, null, {\"n\": -9223372036854775808}]");
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(obj_reads_back_as_the_cells_triangles_and_the_portals),
        cmocka_unit_test(dot_and_json_name_every_cell_and_portal),
        cmocka_unit_test(a_cut_shows_at_every_point_the_cell_that_locate_finds),
        cmocka_unit_test(an_office_has_a_plan_for_each_floor),
        cmocka_unit_test(svg_is_well_formed_and_has_all_spawns),
        cmocka_unit_test(every_portal_is_drawn),
        cmocka_unit_test(a_world_without_the_parts_needed_is_refused),
        cmocka_unit_test(json_escapes_what_it_must),
    };
    return cmocka_run_group_tests(tests, enter, leave);
}
