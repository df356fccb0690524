// SPDX-License-Identifier: GPL-3.0-or-later
// STL (3D Systems, "StereoLithography Interface Specification", 1988), text and binary. A reader of our own:
// OpenMesh 9.0's reads text coordinates as floats, welds corners by its own tolerance and drops the triangles
// that this makes degenerate without a word.
#include "build/read.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { HEADER = 84, RECORD = 50 }; // bytes of a binary file

static uint32_t load_u32(const char *bytes) {
    const unsigned char *b = (const unsigned char *)bytes;
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static double load_float(const char *bytes) {
    uint32_t bits = load_u32(bytes);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/// Adds the last `count` points as a polygon.
static bool add_last_points(enf_soup *soup, const enf_source *source, size_t count, int64_t line,
                            int32_t group) {
    int32_t corners[16];
    for (size_t k = 0; k < count; k++) corners[k] = (int32_t)(soup->point_count - count + k);
    return enf_soup_add_polygon(soup, count, corners, NULL, NULL, source->file, line, group, -1);
}

static enf_status read_binary(enf_soup *soup, enf_source *source, enf_error *error) {
    if (source->size < HEADER)
        return enf_source_fail(source, error,
                               "neither text STL (\"solid\", \"facet\") nor long enough for binary STL");
    uint64_t triangles = load_u32(source->data + 80);
    if (HEADER + triangles * RECORD > source->size)
        return enf_fail(
            error, ENF_BAD_INPUT,
            "%s:%llu: the file ends in this triangle, but announces %llu; it is truncated, or no STL",
            source->name, (unsigned long long)((source->size - HEADER) / RECORD + 1),
            (unsigned long long)triangles);
    for (uint64_t t = 0; t < triangles; t++) {
        const char *record = source->data + HEADER + t * RECORD;
        for (int k = 1; k <= 3; k++) { // 0 is the normal, which the corners tell better
            const char *at = record + 12 * k;
            if (!enf_soup_add_point(soup, load_float(at), load_float(at + 4), load_float(at + 8)))
                return enf_fail_memory(error, "the input's points (or more than 2^31 of them)");
        }
        if (!add_last_points(soup, source, 3, (int64_t)t + 1, 0))
            return enf_fail_memory(error, "the input's polygons");
    }
    return ENF_OK;
}

typedef struct reader {
    enf_soup *soup;
    enf_source *source;
    bool in_facet;
    int64_t facet_line;
    size_t corner_count;
    int32_t group;
} reader;

static bool same_word(const char *word, size_t length, const char *text) {
    return strlen(text) == length && strncasecmp(word, text, length) == 0;
}

static bool reject_line(reader *r) {
    return enf_soup_reject(r->soup, ENF_REJECT_SYNTAX, r->source->file, r->source->line, -1);
}

static bool take_point(reader *r, double at[3]) {
    for (int k = 0; k < 3; k++)
        if (!enf_source_number(r->source, &at[k])) return false;
    return true;
}

static bool read_solid(reader *r) {
    char *name = enf_source_rest(r->source);
    if (!name) return false;
    r->group = enf_soup_group(r->soup, name);
    free(name);
    return r->group >= 0;
}

static bool read_vertex(reader *r) {
    enum { MOST = 16 };
    double at[3] = {NAN, NAN, NAN};
    if (!r->in_facet || r->corner_count == MOST) return reject_line(r);
    if (!take_point(r, at)) {
        if (!reject_line(r)) return false;
        at[0] = at[1] = at[2] = NAN;
    }
    r->corner_count++;
    return enf_soup_add_point(r->soup, at[0], at[1], at[2]);
}

static bool end_facet(reader *r) {
    if (!r->in_facet) return reject_line(r);
    r->in_facet = false;
    return add_last_points(r->soup, r->source, r->corner_count, r->facet_line, r->group);
}

/// One word and what belongs to it. False without memory. *known: the rest of the line can be taken further.
static bool read_word(reader *r, const char *word, size_t length, bool *known) {
    *known = true;
    if (same_word(word, length, "vertex")) return read_vertex(r);
    if (same_word(word, length, "endfacet")) return end_facet(r);
    if (same_word(word, length, "solid")) return read_solid(r);
    if (same_word(word, length, "facet")) {
        bool held = !r->in_facet || end_facet(r); // a lost "endfacet"
        r->in_facet = true;
        r->facet_line = r->source->line;
        r->corner_count = 0;
        return held;
    }
    if (same_word(word, length, "normal")) {
        double unused[3];
        if (!take_point(r, unused)) *known = false; // some exporters write what is no number here
        return true;
    }
    if (same_word(word, length, "outer") || same_word(word, length, "loop") ||
        same_word(word, length, "endloop"))
        return true;
    *known = false;
    return same_word(word, length, "endsolid") || reject_line(r);
}

static enf_status read_text(enf_soup *soup, enf_source *source, enf_error *error) {
    reader r = {.soup = soup, .source = source};
    do {
        bool known = true;
        while (known && enf_source_more(source)) {
            size_t length;
            const char *word = enf_source_word(source, &length);
            if (!read_word(&r, word, length, &known))
                return enf_fail_memory(error, "the input's polygons (or more than 2^31 of something)");
        }
    } while (enf_source_next_line(source));
    if (r.in_facet) return enf_source_fail(source, error, "the file ends inside a facet; it is truncated");
    return ENF_OK;
}

enf_status enf_read_stl(enf_soup *soup, enf_source *source, enf_error *error) {
    bool exact =
        source->size >= HEADER && HEADER + (uint64_t)load_u32(source->data + 80) * RECORD == source->size;
    bool text = !exact && source->size >= 5 && strncasecmp(source->data, "solid", 5) == 0 &&
                !memchr(source->data, 0, source->size);
    return text ? read_text(soup, source, error) : read_binary(soup, source, error);
}
