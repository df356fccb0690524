// SPDX-License-Identifier: GPL-3.0-or-later
// Floor plans: a panel per storey, all to one scale, with a legend below.
#include "build/export.h"

#include "build/plan.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

// Pixels.
static const double page_width = 1600, margin = 36, gap = 28, head = 76, panel_head = 26, foot = 74,
                    padding = 14;
static const double label_space = 16; // a cell smaller than this across gets no number
static const char *const wall_colour = "#23262b", *const portal_colour = "#e4572e";

typedef struct drawing {
    const enf_file_view *view;
    enf_plan plan;
    FILE *out;
    double scale;    ///< pixels per world unit
    double panel[2]; ///< size of a panel's picture, pixels
    int columns, rows;
    double origin[2]; ///< of the panel being drawn: where the page box's low corner lies
    bool *portal_cut; ///< per portal: some cut meets it
} drawing;

/// Chooses how many panels stand side by side, for a page that is not much higher than wide.
static void lay_out(drawing *draw) {
    const enf_plan *plan = &draw->plan;
    double width = plan->high[0] - plan->low[0], height = plan->high[1] - plan->low[1], best = INFINITY;
    if (!(width > 0)) width = 1;
    if (!(height > 0)) height = 1;
    for (int columns = 1; columns <= plan->storey_count; columns++) {
        int rows = (plan->storey_count + columns - 1) / columns;
        double room = (page_width - 2 * margin - (columns - 1) * gap) / columns - 2 * padding;
        double scale = fmin(room / width, 1400 / height);
        double total = rows * (height * scale + 2 * padding + panel_head + gap);
        double cost = fabs(log(total / (0.75 * page_width)));
        if (cost >= best) continue;
        best = cost;
        draw->columns = columns;
        draw->rows = rows;
        draw->scale = scale;
    }
    draw->panel[0] = width * draw->scale + 2 * padding;
    draw->panel[1] = height * draw->scale + 2 * padding;
}

static double page_x(const drawing *draw, double x) {
    return draw->origin[0] + padding + (x - draw->plan.low[0]) * draw->scale;
}

static double page_y(const drawing *draw, double y) {
    return draw->origin[1] + draw->panel[1] - padding - (y - draw->plan.low[1]) * draw->scale;
}

static void put_escaped(FILE *out, const char *text) {
    for (; *text; text++) {
        unsigned char c = (unsigned char)*text;
        if (c == '<' || c == '>' || c == '&' || c == '"')
            fprintf(out, "&#%d;", c);
        else
            fputc(c < 0x20 || c >= 0x7f ? '?' : c, out);
    }
}

/// Hues a golden angle apart, so that neighbours in number differ; two lightnesses besides.
static void cell_colour(int32_t cell, char text[8]) {
    double hue = fmod(35 + cell * 137.50776405, 360) / 60, light = cell % 3 == 1   ? 0.86
                                                                   : cell % 3 == 2 ? 0.78
                                                                                   : 0.82;
    double chroma = (1 - fabs(2 * light - 1)) * 0.62, second = chroma * (1 - fabs(fmod(hue, 2) - 1));
    const double ramp[6][3] = {{chroma, second, 0}, {second, chroma, 0}, {0, chroma, second},
                               {0, second, chroma}, {second, 0, chroma}, {chroma, 0, second}};
    const double *rgb = ramp[(int)hue % 6];
    double base = light - chroma / 2;
    snprintf(text, 8, "#%02x%02x%02x", (unsigned)lrint(255 * (base + rgb[0])) & 255u,
             (unsigned)lrint(255 * (base + rgb[1])) & 255u, (unsigned)lrint(255 * (base + rgb[2])) & 255u);
}

static double area_of(const enf_storey *storey, const enf_plan_area *area, double middle[2]) {
    const double(*corners)[2] = (const double(*)[2])storey->corners + area->corner_first;
    double sum = 0;
    middle[0] = middle[1] = 0;
    for (int32_t k = 0; k < area->corner_count; k++) {
        const double *a = corners[k], *b = corners[(k + 1) % area->corner_count];
        sum += a[0] * b[1] - a[1] * b[0];
        for (int i = 0; i < 2; i++) middle[i] += a[i] / area->corner_count;
    }
    return sum / 2;
}

/// All areas of one cell as one path, with a thin line of its own colour over the seams between them.
static int32_t draw_cell(drawing *draw, const enf_storey *storey, int32_t first) {
    int32_t cell = storey->areas[first].cell, next = first;
    char colour[8];
    cell_colour(cell, colour);
    fprintf(draw->out, "<path fill=\"%s\" stroke=\"%s\" d=\"", colour, colour);
    for (; next < storey->area_count && storey->areas[next].cell == cell; next++) {
        const enf_plan_area *area = &storey->areas[next];
        for (int32_t k = 0; k < area->corner_count; k++) {
            const double *at = storey->corners[area->corner_first + k];
            fprintf(draw->out, "%c%.2f %.2f", k ? 'L' : 'M', page_x(draw, at[0]), page_y(draw, at[1]));
        }
        fputc('Z', draw->out);
    }
    fprintf(draw->out, "\"><title>cell %" PRId32 "</title></path>\n", cell);
    return next;
}

/// The number stands in the largest piece.
static int32_t draw_label(drawing *draw, const enf_storey *storey, int32_t first) {
    int32_t cell = storey->areas[first].cell, next = first;
    double largest = 0, all = 0, at[2] = {0, 0};
    for (; next < storey->area_count && storey->areas[next].cell == cell; next++) {
        double middle[2], area = area_of(storey, &storey->areas[next], middle);
        all += area;
        if (area <= largest) continue;
        largest = area;
        at[0] = middle[0];
        at[1] = middle[1];
    }
    double across = sqrt(all) * draw->scale;
    if (across >= label_space)
        fprintf(draw->out, "<text x=\"%.1f\" y=\"%.1f\" font-size=\"%.1f\">%" PRId32 "</text>\n",
                page_x(draw, at[0]), page_y(draw, at[1]), fmin(fmax(across * 0.16, 9), 26), cell);
    return next;
}

/// `kind`: ENF_PLAN_WALL, ENF_PLAN_FLOOR, or 0 for portals.
static void draw_lines(drawing *draw, const enf_storey *storey, int kind) {
    fputs("<path d=\"", draw->out);
    for (int32_t i = 0; i < storey->line_count; i++) {
        const enf_plan_line *line = &storey->lines[i];
        if ((line->portal < 0 ? line->portal : 0) != kind) continue;
        fprintf(draw->out, "M%.2f %.2fL%.2f %.2f", page_x(draw, line->from[0]), page_y(draw, line->from[1]),
                page_x(draw, line->to[0]), page_y(draw, line->to[1]));
    }
    fputs("\"/>\n", draw->out);
}

/// The storey whose cut is nearest.
static int nearest_storey(const enf_plan *plan, double height) {
    int nearest = 0;
    for (int i = 1; i < plan->storey_count; i++)
        if (fabs(plan->storeys[i].height - height) < fabs(plan->storeys[nearest].height - height))
            nearest = i;
    return nearest;
}

/// A portal in a floor shows in the storey above it, any other in the nearest.
static int storey_of_polygon(const enf_plan *plan, const enf_file_portal_polygon *polygon, double height) {
    if (fabs(polygon->plane[plan->up]) > 0.7)
        for (int i = 0; i < plan->storey_count; i++)
            if (plan->storeys[i].height >= height) return i;
    return nearest_storey(plan, height);
}

/// Portals that lie flat, and those that no cut meets, are seen from above.
static void draw_flat_portals(drawing *draw, int storey) {
    const enf_file_view *view = draw->view;
    for (int32_t i = 0; i < view->portal_count; i += 2) {
        const enf_file_portal *portal = &view->portals[i];
        for (int32_t p = 0; p < portal->polygon_count; p++) {
            const enf_file_portal_polygon *polygon = &view->portal_polygons[portal->polygon_first + p];
            bool flat = fabs(polygon->plane[draw->plan.up]) > 0.7;
            if (!flat && draw->portal_cut[i]) continue;
            double height = 0, page[2];
            for (int32_t k = 0; k < polygon->vertex_count; k++)
                height +=
                    enf_plan_project(&draw->plan, view->portal_vertices[polygon->vertex_first + k], page) /
                    polygon->vertex_count;
            if (storey_of_polygon(&draw->plan, polygon, height) != storey) continue;
            fprintf(draw->out, "<path%s d=\"",
                    flat ? " fill=\"url(#hatch)\"" : " fill=\"none\" stroke-dasharray=\"5 4\"");
            for (int32_t k = 0; k < polygon->vertex_count; k++) {
                enf_plan_project(&draw->plan, view->portal_vertices[polygon->vertex_first + k], page);
                fprintf(draw->out, "%c%.2f %.2f", k ? 'L' : 'M', page_x(draw, page[0]),
                        page_y(draw, page[1]));
            }
            fputs("Z\"/>\n", draw->out);
        }
    }
}

static void draw_spawns(drawing *draw, int storey) {
    for (int32_t i = 0; i < draw->view->spawn_count; i++) {
        double page[2], height = enf_plan_project(&draw->plan, draw->view->spawns[i].position, page);
        if (nearest_storey(&draw->plan, height) != storey) continue;
        double x = page_x(draw, page[0]), y = page_y(draw, page[1]);
        fprintf(draw->out,
                "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4.2\"/><text x=\"%.1f\" y=\"%.1f\">%" PRId32 "</text>\n",
                x, y, x + 7, y + 4, i);
    }
}

static void draw_storey(drawing *draw, int number) {
    const enf_storey *storey = &draw->plan.storeys[number];
    FILE *out = draw->out;
    int column = number % draw->columns, row = number / draw->columns;
    draw->origin[0] = margin + column * (draw->panel[0] + gap);
    draw->origin[1] = head + row * (draw->panel[1] + panel_head + gap) + panel_head;
    fprintf(out, "<g>\n<text class=\"panel\" x=\"%.1f\" y=\"%.1f\">", draw->origin[0], draw->origin[1] - 8);
    if (draw->plan.storey_count > 1) fprintf(out, "Storey %d of %d, ", number + 1, draw->plan.storey_count);
    fprintf(out, "%s at %c = %.4g</text>\n", draw->plan.storey_count > 1 ? "cut" : "Cut",
            "xyz"[draw->plan.up], storey -> height);
    fprintf(out, "<rect class=\"ground\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" rx=\"4\"/>\n",
            draw->origin[0], draw->origin[1], draw->panel[0], draw->panel[1]);
    fputs("<g class=\"cells\">\n", out);
    for (int32_t i = 0; i < storey->area_count;) i = draw_cell(draw, storey, i);
    fprintf(out,
            "</g>\n<clipPath id=\"panel%d\"><rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" "
            "height=\"%.1f\"/></clipPath>\n"
            "<g class=\"floors\" clip-path=\"url(#panel%d)\">\n",
            number, draw->origin[0], draw->origin[1], draw->panel[0], draw->panel[1], number);
    draw_lines(draw, storey, ENF_PLAN_FLOOR);
    fputs("</g>\n<g class=\"walls\">\n", out);
    draw_lines(draw, storey, ENF_PLAN_WALL);
    fputs("</g>\n<g class=\"flat\">\n", out);
    draw_flat_portals(draw, number);
    fputs("</g>\n<g class=\"portals\">\n", out);
    draw_lines(draw, storey, 0);
    fputs("</g>\n<g class=\"numbers\">\n", out);
    for (int32_t i = 0; i < storey->area_count;) i = draw_label(draw, storey, i);
    fputs("</g>\n<g class=\"spawns\">\n", out);
    draw_spawns(draw, number);
    fputs("</g>\n</g>\n", out);
}

static void draw_head(const drawing *draw, const char *title, double width, double height) {
    FILE *out = draw->out;
    fprintf(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" viewBox=\"0 0 %.0f %.0f\" "
        "font-family=\"DejaVu Sans, Helvetica, Arial, sans-serif\">\n",
        width, height, width, height);
    fprintf(out,
            "<style>\n"
            ".title { font-size: 24px; font-weight: bold; fill: #23262b }\n"
            ".counts, .legend { font-size: 14px; fill: #5a606a }\n"
            ".panel { font-size: 14px; font-weight: bold; fill: #3a3f47 }\n"
            ".ground { fill: #eceae5 }\n"
            ".cells path { stroke-width: 0.7; stroke-linejoin: round }\n"
            ".floors path { stroke: #23262b; stroke-opacity: 0.28; stroke-width: 0.9; fill: none }\n"
            ".walls path { stroke: %s; stroke-width: 2; stroke-linecap: round; fill: none }\n"
            ".portals path { stroke: %s; stroke-width: %.1f; stroke-linecap: round; fill: none }\n"
            ".flat path { stroke: %s; stroke-width: 1.4; stroke-linejoin: round }\n"
            ".numbers text { fill: #23262b; fill-opacity: 0.55; font-weight: bold; text-anchor: middle; "
            "dominant-baseline: central }\n"
            ".spawns circle { fill: #1d4ed8; stroke: #fff; stroke-width: 1.3 }\n"
            ".spawns text { font-size: 12px; fill: #1d4ed8; stroke: #fff; stroke-width: 2.5; paint-order: "
            "stroke }\n"
            "</style>\n",
            wall_colour, portal_colour, fmin(fmax(0.005 * fmin(draw->panel[0], draw->panel[1]), 1.6), 4),
            portal_colour);
    fprintf(out,
            "<defs><pattern id=\"hatch\" width=\"7\" height=\"7\" patternUnits=\"userSpaceOnUse\" "
            "patternTransform=\"rotate(45)\"><path d=\"M0 0V7\" stroke=\"%s\" "
            "stroke-width=\"1.4\" stroke-opacity=\"0.6\"/></pattern></defs>\n",
            portal_colour);
    fprintf(out,
            "<rect width=\"100%%\" height=\"100%%\" fill=\"#fbfaf8\"/>\n<text class=\"title\" x=\"%.0f\" "
            "y=\"40\">",
            margin);
    put_escaped(out, title ? title : "World");
    fprintf(out,
            "</text>\n<text class=\"counts\" x=\"%.0f\" y=\"62\">%" PRId32 " cell%s, %" PRId32
            " portal%s, %" PRId32 " spawn point%s</text>\n",
            margin, draw->view->cell_count, draw->view->cell_count == 1 ? "" : "s",
            draw->view->portal_count / 2, draw->view->portal_count == 2 ? "" : "s", draw->view->spawn_count,
            draw->view->spawn_count == 1 ? "" : "s");
}

/// 1, 2 or 5 times a power of ten, at most a sixth of the page.
static void draw_scale_bar(const drawing *draw, double width, double y) {
    double most = page_width / 6 / draw->scale, length = pow(10, floor(log10(most)));
    if (length * 5 <= most)
        length *= 5;
    else if (length * 2 <= most)
        length *= 2;
    double right = width - margin, left = right - length * draw->scale;
    fprintf(
        draw->out,
        "<path d=\"M%.1f %.1fv-6v12v-6H%.1fv-6v12\" stroke=\"#3a3f47\" stroke-width=\"1.6\" fill=\"none\"/>\n"
        "<text class=\"legend\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%g unit%s</text>\n",
        left, y, right, (left + right) / 2, y + 22, length, length == 1 ? "" : "s");
}

static void draw_legend(const drawing *draw, double width, double y) {
    FILE *out = draw->out;
    char colour[8];
    double x = margin;
    for (int i = 0; i < 3; i++) {
        cell_colour(i, colour);
        fprintf(out, "<rect x=\"%.1f\" y=\"%.1f\" width=\"12\" height=\"16\" fill=\"%s\"/>\n", x + 12 * i,
                y - 8, colour);
    }
    fprintf(out, "<text class=\"legend\" x=\"%.1f\" y=\"%.1f\">cells</text>\n", x + 44, y + 5);
    x += 110;
    fprintf(out,
            "<g class=\"walls\"><path d=\"M%.1f %.1fh34\"/></g><text class=\"legend\" x=\"%.1f\" "
            "y=\"%.1f\">wall</text>\n",
            x, y, x + 42, y + 5);
    x += 100;
    fprintf(out,
            "<g class=\"portals\"><path d=\"M%.1f %.1fh34\"/></g><text class=\"legend\" x=\"%.1f\" "
            "y=\"%.1f\">portal</text>\n",
            x, y, x + 42, y + 5);
    x += 114;
    fprintf(out,
            "<g class=\"flat\"><path fill=\"url(#hatch)\" d=\"M%.1f %.1fh34v16h-34Z\"/></g><text "
            "class=\"legend\" "
            "x=\"%.1f\" y=\"%.1f\">portal in a floor</text>\n",
            x, y - 8, x + 42, y + 5);
    x += 184;
    fprintf(out,
            "<g class=\"flat\"><path fill=\"none\" stroke-dasharray=\"5 4\" d=\"M%.1f %.1fh34\"/></g><text "
            "class=\"legend\" x=\"%.1f\" y=\"%.1f\">portal above or below the cut</text>\n",
            x, y, x + 42, y + 5);
    x += 280;
    fprintf(out,
            "<g class=\"spawns\"><circle cx=\"%.1f\" cy=\"%.1f\" r=\"4.2\"/></g><text class=\"legend\" "
            "x=\"%.1f\" "
            "y=\"%.1f\">spawn point</text>\n",
            x + 6, y, x + 18, y + 5);
    draw_scale_bar(draw, width, y);
}

static void note_cut_portals(drawing *draw) {
    for (int s = 0; s < draw->plan.storey_count; s++)
        for (int32_t i = 0; i < draw->plan.storeys[s].line_count; i++) {
            int32_t portal = draw->plan.storeys[s].lines[i].portal;
            if (portal >= 0) draw->portal_cut[portal] = true;
        }
}

enf_status enf_export_svg(const enf_file_view *view, const enf_svg_options *options, FILE *out,
                          enf_error *error) {
    drawing draw = {.view = view, .out = out};
    enf_status status = enf_plan_make(&draw.plan, view, options->up, error);
    draw.portal_cut = calloc((size_t)view->portal_count + 1, sizeof *draw.portal_cut);
    if (!status && !draw.portal_cut) status = enf_fail_memory(error, "the floor plans");
    if (!status) {
        note_cut_portals(&draw);
        lay_out(&draw);
        double width = fmax(draw.columns * (draw.panel[0] + gap) - gap + 2 * margin, 1240);
        double height = head + draw.rows * (draw.panel[1] + panel_head + gap) + foot;
        draw_head(&draw, options->title, width, height);
        for (int i = 0; i < draw.plan.storey_count; i++) draw_storey(&draw, i);
        draw_legend(&draw, width, height - foot + 22);
        fputs("</svg>\n", out);
    }
    free(draw.portal_cut);
    enf_plan_free(&draw.plan);
    return status;
}
