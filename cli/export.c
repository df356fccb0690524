// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade export: a world in forms that other programs read, told by the output's ending.
#include "build/export.h"

#include "cli/cli.h"
#include "cli/options.h"
#include "cli/world.h"
#include "format/output.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const char *const formats[] = {"obj", "svg", "dot", "json", NULL};
static const char *const formats_later[] = {"glb", "prt", NULL};
static const char *const axes[] = {"x", "y", "z", NULL};
enum { FORMAT_OBJ, FORMAT_SVG, FORMAT_DOT, FORMAT_JSON };

static int find_format(const char *const *names, const char *path) {
    const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
    for (int i = 0; dot && names[i]; i++)
        if (strcasecmp(dot + 1, names[i]) == 0) return i;
    return -1;
}

static enf_status write_format(int format, const enf_file_view *view, const enf_svg_options *svg, FILE *out,
                               enf_error *error) {
    switch (format) {
    case FORMAT_OBJ:
        return enf_export_obj(view, out, error);
    case FORMAT_SVG:
        return enf_export_svg(view, svg, out, error);
    case FORMAT_DOT:
        return enf_export_dot(view, out, error);
    default:
        return enf_export_json(view, out, error);
    }
}

static int export_world(const char *input, const char *path, int format, int up) {
    enf_world *world = NULL;
    enf_error error = {0};
    int opened = cli_open_world(&world, input);
    if (opened) return opened;
    const char *slash = strrchr(input, '/');
    const enf_svg_options svg = {.title = slash ? slash + 1 : input, .up = up};
    enf_output output;
    enf_status status = enf_output_open(&output, path, &error);
    if (!status) {
        enf_error wrong = {0};
        status = write_format(format, enf_world_file(world), &svg, output.file, &wrong);
        if (status) enf_fail(&error, status, "%s: %.900s", input, wrong.text);
    }
    if (!status) status = enf_output_commit(&output, &error);
    enf_output_discard(&output);
    enf_world_close(world);
    return status ? cli_fail(&error) : ENF_OK;
}

int cli_export(int argc, char **argv) {
    const char *path = NULL;
    int up = 2, named = -1;
    cli_option options[] = {
        {"--output", 'o', CLI_TEXT, &path, "OUT", "the file to write: .obj, .svg, .dot or .json", NULL,
         false},
        {"--format", 0, CLI_CHOICE, &named, "FORMAT", "instead of the ending: obj, svg, dot, json", formats,
         false},
        {"--up", 0, CLI_CHOICE, &up, "AXIS", "svg: the axis that points up; default z", axes, false},
        {0},
    };
    const cli_syntax syntax = {
        .command = "enfilade export",
        .usage = "WORLD.enf -o OUT.{obj,svg,dot,json}",
        .summary = "Writes a world in another form: obj (a group per cell, portals as polygons), svg (floor\n"
                   "plans), dot (the graph for GraphViz), json (cells, portals, spawn points).",
        .options = options,
        .operands_min = 1,
        .operands_max = 1,
        .operand = "the world file"};
    cli_texts operands = {0};
    int status = cli_parse(&syntax, argc, argv, &operands);
    int format = named >= 0 || !path ? named : find_format(formats, path);
    if (status >= 0)
        ;
    else if (!path)
        status = cli_misuse(&syntax, "-o OUT is missing");
    else if (format < 0 && find_format(formats_later, path) >= 0)
        status =
            cli_misuse(&syntax, "'%.100s': this form is not built yet; use .obj, .svg, .dot or .json", path);
    else if (format < 0)
        status = cli_misuse(
            &syntax, "'%.100s' does not tell the form; end it in .obj, .svg, .dot or .json, or give --format",
            path);
    else
        status = export_world(operands.items[0], path, format, up);
    free(operands.items);
    return status;
}
