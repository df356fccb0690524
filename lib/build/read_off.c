// SPDX-License-Identifier: GPL-3.0-or-later
// OFF, the Object File Format of Geomview, text form, with the prefixes ST, C and N. A reader of our own:
// OpenMesh 9.0's gives coordinates rounded to float (0.1 becomes 0.100000001) even to a mesh of doubles,
// allocates what the header announces (51 GB for a 30-byte file), tells of bad faces on standard error and
// without their line.
#include "build/read.h"

#include "base/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct reader {
    enf_soup *soup;
    enf_source *source;
    bool has_texcoords, has_colours, has_normals;
    int64_t vertices, faces;
    size_t first_point, first_normal, first_texcoord;
    int32_t *corners[3]; ///< points, normals, texcoords of the face at hand
    size_t capacity[3];
} reader;

static bool take_prefix(const char **word, size_t *length, const char *prefix) {
    size_t size = strlen(prefix);
    if (*length < size || memcmp(*word, prefix, size) != 0) return false;
    *word += size;
    *length -= size;
    return true;
}

static bool take_count(enf_source *source, int64_t *count) {
    return enf_source_skip_space(source) && enf_source_whole(source, count) && enf_source_word_ends(source) &&
           *count >= 0;
}

static enf_status read_header(reader *r, enf_error *error) {
    enf_source *source = r->source;
    size_t length = 0;
    const char *word = enf_source_skip_space(source) ? enf_source_word(source, &length) : "";
    r->has_texcoords = take_prefix(&word, &length, "ST");
    r->has_colours = take_prefix(&word, &length, "C");
    r->has_normals = take_prefix(&word, &length, "N");
    if (!enf_word_is(word, length, "OFF"))
        return enf_source_fail(
            source, error,
            "no OFF header (OFF, with ST, C, N before it); 4OFF and nOFF are not understood, "
            "convert the file");
    const char *at = source->at;
    word = enf_source_word(source, &length);
    if (enf_word_is(word, length, "BINARY"))
        return enf_source_fail(source, error, "binary OFF is not understood; save it as text, or as PLY");
    source->at = at;
    if (!take_count(source, &r->vertices) || !take_count(source, &r->faces))
        return enf_source_fail(source, error, "the numbers of vertices and faces should stand here");
    // Every vertex and every face takes two bytes at least, so this also bounds what will be allocated.
    if (r->vertices > (int64_t)source->size || r->faces > (int64_t)source->size)
        return enf_source_fail(
            source, error,
            "the header announces more vertices or faces than the file can hold; is it truncated?");
    enf_source_next_line(source); // the number of edges is of no use
    return ENF_OK;
}

static enf_status fail_early(const reader *r, enf_error *error) {
    return enf_source_fail(r->source, error,
                           "the file ends before all vertices and faces have come; is it truncated?");
}

/// x y z [normal] [colour] [s t]
static bool read_vertex(reader *r) {
    enum { MOST = 3 + 3 + 4 + 2 };
    double values[MOST];
    int count = 0;
    int64_t line = r->source->line;
    while (count < MOST && enf_source_number(r->source, &values[count])) count++;
    int needed = 3 + (r->has_normals ? 3 : 0) + (r->has_texcoords ? 2 : 0);
    bool good = count >= needed;
    if (!good && !enf_soup_reject(r->soup, ENF_REJECT_SYNTAX, r->source->file, line, -1)) return false;
    if (!good) values[0] = values[1] = values[2] = values[3] = values[4] = values[5] = NAN;
    if (r->has_normals && !enf_soup_add_normal(r->soup, values[3], values[4], values[5])) return false;
    const double *uv = good && r->has_texcoords ? &values[count - 2] : values;
    if (r->has_texcoords && !enf_soup_add_texcoord(r->soup, uv[0], uv[1])) return false;
    return enf_soup_add_point(r->soup, values[0], values[1], values[2]);
}

/// count, that many indices, [colour]
static bool read_face(reader *r) {
    int64_t line = r->source->line;
    double size;
    bool good = enf_source_number(r->source, &size) && size >= 1 && size == floor(size);
    size_t count = 0;
    for (; good && (double)count < size; count++) {
        double index;
        good = enf_source_number(r->source, &index);
        if (!good) break;
        for (int k = 0; k < 3; k++)
            if (!enf_array_reserve(r->corners[k], r->capacity[k], count + 1)) return false;
        bool known = index >= 0 && index < (double)r->vertices && index == floor(index);
        r->corners[0][count] = known ? (int32_t)((int64_t)r->first_point + (int64_t)index) : -1;
        r->corners[1][count] = known ? (int32_t)((int64_t)r->first_normal + (int64_t)index) : -1;
        r->corners[2][count] = known ? (int32_t)((int64_t)r->first_texcoord + (int64_t)index) : -1;
    }
    if (!good) return enf_soup_reject(r->soup, ENF_REJECT_SYNTAX, r->source->file, line, -1);
    return enf_soup_add_polygon(r->soup, count, r->corners[0], r->has_normals ? r->corners[1] : NULL,
                                r->has_texcoords ? r->corners[2] : NULL, r->source->file, line, 0, -1);
}

static enf_status read_body(reader *r, enf_error *error) {
    for (int64_t i = 0; i < r->vertices + r->faces; i++) {
        if (!enf_source_skip_space(r->source)) return fail_early(r, error);
        bool held = i < r->vertices ? read_vertex(r) : read_face(r);
        if (!held) return enf_fail_memory(error, "the input's polygons (or more than 2^31 of something)");
        enf_source_next_line(r->source);
    }
    return ENF_OK;
}

enf_status enf_read_off(enf_soup *soup, enf_source *source, enf_error *error) {
    reader r = {.soup = soup,
                .source = source,
                .first_point = soup->point_count,
                .first_normal = soup->normal_count,
                .first_texcoord = soup->texcoord_count};
    enf_status status = read_header(&r, error);
    if (status == ENF_OK) status = read_body(&r, error);
    for (int k = 0; k < 3; k++) free(r.corners[k]);
    return status;
}
