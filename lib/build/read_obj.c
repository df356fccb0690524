// SPDX-License-Identifier: GPL-3.0-or-later
// Wavefront OBJ ("Object Files", Appendix B1 of the Advanced Visualizer manual). A reader of our own because
// OpenMesh's keeps neither objects nor groups nor comments, reads coordinates as floats (0.1 becomes
// 0.100000001), and knows no line numbers.
#include "build/read.h"

#include "base/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct reader {
    enf_soup *soup;
    enf_source *source;
    size_t first_point, first_normal, first_texcoord, first_polygon; ///< where this file's begin in the soup
    int32_t group, material;
    bool check;                            ///< some index must be judged at the end of the file
    int64_t line;                          ///< first line of the statement
    char *object, *group_name;             ///< current names, or null
    int32_t *points, *normals, *texcoords; ///< corners of the polygon at hand
    size_t point_capacity, normal_capacity, texcoord_capacity;
} reader;

static bool reject_line(reader *r) {
    return enf_soup_reject(r->soup, ENF_REJECT_SYNTAX, r->source->file, r->line, -1);
}

/// Reads up to `wanted` numbers; the rest of `values` stays. True if at least `needed` were there.
static bool take_numbers(reader *r, double *values, int needed, int wanted) {
    int count = 0;
    while (count < wanted && enf_source_number(r->source, &values[count])) count++;
    return count >= needed;
}

/// "v x y z [w] [r g b]". A vertex that can't be read still takes a number, so the ones after it keep theirs.
static bool read_vertex(reader *r) {
    double at[3] = {NAN, NAN, NAN};
    if (take_numbers(r, at, 3, 3)) return enf_soup_add_point(r->soup, at[0], at[1], at[2]);
    return reject_line(r) && enf_soup_add_point(r->soup, NAN, NAN, NAN);
}

static bool read_normal(reader *r) {
    double at[3] = {0, 0, 0};
    if (!take_numbers(r, at, 3, 3) && !reject_line(r)) return false;
    return enf_soup_add_normal(r->soup, at[0], at[1], at[2]);
}

static bool read_texcoord(reader *r) {
    double at[2] = {0, 0};
    if (!take_numbers(r, at, 1, 2) && !reject_line(r)) return false;
    return enf_soup_add_texcoord(r->soup, at[0], at[1]);
}

/// An index of the file (1-based, or negative: counted from the end) as a soup index; -2 for what can't be
/// one. An index beyond the elements read so far may become good later, so it is judged at the end of the
/// file.
static int32_t resolve(reader *r, int64_t index, size_t first, size_t count) {
    int64_t soup_index = index > 0 ? (int64_t)first + index - 1 : (int64_t)count + index;
    bool known = index != 0 && soup_index >= (int64_t)first && soup_index < (int64_t)count;
    if (known) return (int32_t)soup_index;
    r->check = true;
    return index > 0 && soup_index <= INT32_MAX ? (int32_t)soup_index : -2;
}

/// One corner, "p", "p/t", "p//n" or "p/t/n". False if it is none of these.
static bool read_corner(reader *r, int32_t *point, int32_t *normal, int32_t *texcoord) {
    enf_source *source = r->source;
    int64_t index;
    *normal = *texcoord = -1;
    if (!enf_source_whole(source, &index)) return false;
    *point = resolve(r, index, r->first_point, r->soup->point_count);
    if (*source->at == '/') {
        source->at++;
        if (enf_source_whole(source, &index))
            *texcoord = resolve(r, index, r->first_texcoord, r->soup->texcoord_count);
        if (*source->at == '/') {
            source->at++;
            if (enf_source_whole(source, &index))
                *normal = resolve(r, index, r->first_normal, r->soup->normal_count);
        }
    }
    return enf_source_word_ends(source);
}

static bool read_polygon(reader *r) {
    size_t count = 0;
    while (enf_source_more(r->source)) {
        if (*r->source->at == '#') break;
        if (!enf_array_reserve(r->points, r->point_capacity, count + 1) ||
            !enf_array_reserve(r->normals, r->normal_capacity, count + 1) ||
            !enf_array_reserve(r->texcoords, r->texcoord_capacity, count + 1))
            return false;
        if (!read_corner(r, &r->points[count], &r->normals[count], &r->texcoords[count]))
            return reject_line(r);
        count++;
    }
    if (count == 0) return reject_line(r);
    return enf_soup_add_polygon(r->soup, count, r->points, r->normals, r->texcoords, r->source->file, r->line,
                                r->group, r->material);
}

/// Sets the group from the current object and group names.
static bool join_names(reader *r) {
    const char *object = r->object ? r->object : "", *group = r->group_name ? r->group_name : "";
    if (!*object || !*group) {
        r->group = enf_soup_group(r->soup, *object ? object : group);
        return r->group >= 0;
    }
    size_t length = strlen(object), size = length + strlen(group) + 2;
    char *joined = enf_array_new(size, 1);
    if (!joined) return false;
    memcpy(joined, object, length);
    joined[length] = '/';
    memcpy(joined + length + 1, group, size - length - 1);
    r->group = enf_soup_group(r->soup, joined);
    free(joined);
    return r->group >= 0;
}

/// "o NAME" ends the group, too.
static bool read_object(reader *r) {
    free(r->object);
    free(r->group_name);
    r->group_name = NULL;
    r->object = enf_source_rest(r->source);
    return r->object && join_names(r);
}

static bool read_group(reader *r) {
    free(r->group_name);
    r->group_name = enf_source_rest(r->source);
    return r->group_name && join_names(r);
}

static bool read_material(reader *r) {
    char *name = enf_source_rest(r->source);
    if (!name) return false;
    r->material = enf_soup_material(r->soup, name);
    free(name);
    return r->material >= 0;
}

/// "# spawn x y z [name]" is a spawn point; every other comment says nothing to us.
static bool read_comment(reader *r) {
    enf_source *source = r->source;
    while (source->at < source->end && *source->at == '#') source->at++;
    size_t length;
    const char *word = enf_source_word(source, &length);
    if (!enf_word_is(word, length, "spawn")) return true;
    double at[3];
    if (!take_numbers(r, at, 3, 3)) return true; // prose that begins with the word
    for (int a = 0; a < 3; a++)
        if (!isfinite(at[a]) || fabs(at[a]) > 1e100) return reject_line(r);
    return enf_soup_add_spawn(r->soup, at[0], at[1], at[2]);
}

static bool read_nothing(reader *r) {
    (void)r;
    return true;
}

/// What OBJ has and a world of polygons has no use for. None of these is a polygon or changes the numbering.
static bool is_known_keyword(const char *word, size_t length) {
    static const char *const known[] = {"mtllib",   "s",      "l",          "p",         "vp",    "mg",
                                        "usemap",   "maplib", "cstype",     "deg",       "bmat",  "step",
                                        "curv",     "curv2",  "surf",       "parm",      "trim",  "hole",
                                        "scrv",     "sp",     "end",        "con",       "bevel", "c_interp",
                                        "d_interp", "lod",    "shadow_obj", "trace_obj", "ctech", "stech"};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (enf_word_is(word, length, known[i])) return true;
    return false;
}

static bool read_statement(reader *r) {
    static const struct {
        const char *keyword;
        bool (*read)(reader *);
    } statements[] = {{"v", read_vertex},        {"f", read_polygon}, {"vn", read_normal},
                      {"vt", read_texcoord},     {"o", read_object},  {"g", read_group},
                      {"usemtl", read_material}, {"fo", read_polygon}};
    if (*r->source->at == '#') return read_comment(r);
    size_t length;
    const char *word = enf_source_word(r->source, &length);
    for (size_t i = 0; i < sizeof statements / sizeof *statements; i++)
        if (enf_word_is(word, length, statements[i].keyword)) return statements[i].read(r);
    return is_known_keyword(word, length) ? read_nothing(r) : reject_line(r);
}

static void skip_byte_order_mark(enf_source *source) {
    if (source->size >= 3 && memcmp(source->at, "\xef\xbb\xbf", 3) == 0) source->at += 3;
}

static enf_status read_statements(reader *r, enf_error *error) {
    enf_source *source = r->source;
    do {
        if (!enf_source_more(source)) continue;
        r->line = source->line;
        source->continues = *source->at != '#';
        if (!read_statement(r))
            return enf_fail_memory(error, "the input's polygons (or more than 2^31 of something)");
    } while (enf_source_next_line(source));
    if (r->check && !enf_read_check_corners(r->soup, r->first_polygon))
        return enf_fail_memory(error, "the list of rejections");
    return ENF_OK;
}

enf_status enf_read_obj(enf_soup *soup, enf_source *source, enf_error *error) {
    const char *zero = memchr(source->data, 0, source->size);
    if (zero) {
        for (const char *at = source->data; at < zero; at++) source->line += *at == '\n';
        return enf_source_fail(source, error,
                               "a zero byte: this is no OBJ text; check what the file really is");
    }
    reader r = {.soup = soup,
                .source = source,
                .first_point = soup->point_count,
                .first_normal = soup->normal_count,
                .first_texcoord = soup->texcoord_count,
                .first_polygon = soup->polygon_count,
                .material = -1};
    skip_byte_order_mark(source);
    enf_status status = read_statements(&r, error);
    free(r.object);
    free(r.group_name);
    free(r.points);
    free(r.normals);
    free(r.texcoords);
    return status;
}
