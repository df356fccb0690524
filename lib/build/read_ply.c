// SPDX-License-Identifier: GPL-3.0-or-later
// PLY, the Polygon File Format (Turk, Stanford, 1994): text, binary little and big endian; any elements and
// properties, of which we keep vertices (position, normal, texture coordinate) and faces. In text, one
// element per line. A reader of our own: OpenMesh 9.0's gives coordinates rounded to float (0.1 becomes
// 0.100000001) even to a mesh of doubles, refuses lists counted by uint, tells of bad faces on standard error
// and without their line.
#include "build/read.h"

#include "base/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef enum value_type { NO_TYPE, INT8, UINT8, INT16, UINT16, INT32, UINT32, FLOAT32, FLOAT64 } value_type;

/// What a property is to us. The roles up to V are places in the array of a vertex's values.
typedef enum role { X, Y, Z, NX, NY, NZ, U, V, INDICES, OTHER } role;

typedef struct property {
    role role;
    value_type type, count_type; ///< count_type: of a list, else NO_TYPE
} property;

typedef enum element_kind { VERTEX, FACE, OTHER_ELEMENT } element_kind;

typedef struct element {
    element_kind kind;
    int64_t count;
    size_t first_property, property_count;
} element;

typedef struct reader {
    enf_soup *soup;
    enf_source *source;
    bool binary, big_endian, has_normals, has_texcoords;
    element *elements;
    property *properties;
    size_t element_count, element_capacity, property_count, property_capacity;
    int64_t vertices;
    size_t first_point, first_normal, first_texcoord;
    int32_t *corners[3]; ///< points, normals, texcoords of the face at hand
    size_t capacity[3], corner_count;
} reader;

// ---- the header

static value_type type_named(const char *word, size_t length) {
    static const struct {
        const char *name;
        value_type type;
    } names[] = {{"char", INT8},     {"int8", INT8},       {"uchar", UINT8},    {"uint8", UINT8},
                 {"short", INT16},   {"int16", INT16},     {"ushort", UINT16},  {"uint16", UINT16},
                 {"int", INT32},     {"int32", INT32},     {"uint", UINT32},    {"uint32", UINT32},
                 {"float", FLOAT32}, {"float32", FLOAT32}, {"double", FLOAT64}, {"float64", FLOAT64}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (enf_word_is(word, length, names[i].name)) return names[i].type;
    return NO_TYPE;
}

static role role_named(const char *word, size_t length, element_kind kind, bool list) {
    static const struct {
        const char *name;
        role role;
    } names[] = {{"x", X}, {"y", Y}, {"z", Z}, {"nx", NX}, {"ny", NY},       {"nz", NZ},
                 {"u", U}, {"v", V}, {"s", U}, {"t", V},   {"texture_u", U}, {"texture_v", V}};
    if (kind == FACE)
        return list && (enf_word_is(word, length, "vertex_indices") ||
                        enf_word_is(word, length, "vertex_index"))
                   ? INDICES
                   : OTHER;
    for (size_t i = 0; kind == VERTEX && !list && i < sizeof names / sizeof *names; i++)
        if (enf_word_is(word, length, names[i].name)) return names[i].role;
    return OTHER;
}

static enf_status read_format(reader *r, enf_error *error) {
    size_t length;
    const char *word = enf_source_word(r->source, &length);
    r->binary = !enf_word_is(word, length, "ascii");
    r->big_endian = enf_word_is(word, length, "binary_big_endian");
    if (!r->binary || r->big_endian || enf_word_is(word, length, "binary_little_endian")) return ENF_OK;
    return enf_source_fail(r->source, error,
                           "unknown format; ascii, binary_little_endian or binary_big_endian");
}

static enf_status read_element(reader *r, enf_error *error) {
    size_t length;
    const char *word = enf_source_word(r->source, &length);
    element added = {.first_property = r->property_count};
    added.kind = enf_word_is(word, length, "vertex") ? VERTEX
                 : enf_word_is(word, length, "face") ? FACE
                                                     : OTHER_ELEMENT;
    bool good = enf_source_more(r->source) && enf_source_whole(r->source, &added.count) && added.count >= 0;
    for (size_t e = 0; e < r->element_count; e++)
        good = good && (added.kind == OTHER_ELEMENT || added.kind != r->elements[e].kind);
    if (!good)
        return enf_source_fail(r->source, error, "\"element NAME COUNT\" should stand here, each name once");
    if (added.kind == VERTEX) r->vertices = added.count;
    if (!enf_array_reserve(r->elements, r->element_capacity, r->element_count + 1))
        return enf_fail_memory(error, "the file's header");
    r->elements[r->element_count++] = added;
    return ENF_OK;
}

static enf_status read_property(reader *r, enf_error *error) {
    size_t length;
    property added = {.role = OTHER};
    const char *word = enf_source_word(r->source, &length);
    bool list = enf_word_is(word, length, "list");
    if (list) {
        word = enf_source_word(r->source, &length);
        added.count_type = type_named(word, length);
        word = enf_source_word(r->source, &length);
    }
    added.type = type_named(word, length);
    bool good = r->element_count > 0 && added.type != NO_TYPE;
    good = good && (!list || (added.count_type != NO_TYPE && added.count_type < FLOAT32));
    word = enf_source_word(r->source, &length);
    if (!good || length == 0)
        return enf_source_fail(r->source, error,
                               "\"property TYPE NAME\" or \"property list TYPE TYPE NAME\" expected");
    element *last = &r->elements[r->element_count - 1];
    added.role = role_named(word, length, last->kind, list);
    r->has_normals = r->has_normals || added.role == NX;
    r->has_texcoords = r->has_texcoords || added.role == U;
    if (!enf_array_reserve(r->properties, r->property_capacity, r->property_count + 1))
        return enf_fail_memory(error, "the file's header");
    r->properties[r->property_count++] = added;
    last->property_count++;
    return ENF_OK;
}

static enf_status read_header(reader *r, enf_error *error) {
    enf_source *source = r->source;
    size_t length;
    const char *word = enf_source_word(source, &length);
    if (!enf_word_is(word, length, "ply"))
        return enf_source_fail(source, error, "no PLY file: \"ply\" should stand here");
    bool has_format = false;
    while (enf_source_next_line(source)) {
        enf_status status = ENF_OK;
        word = enf_source_word(source, &length);
        if (enf_word_is(word, length, "end_header")) {
            if (!has_format) return enf_source_fail(source, error, "the header has no \"format\" line");
            enf_source_next_line(source);
            return ENF_OK;
        }
        if (enf_word_is(word, length, "format"))
            status = read_format(r, error), has_format = true;
        else if (enf_word_is(word, length, "element"))
            status = read_element(r, error);
        else if (enf_word_is(word, length, "property"))
            status = read_property(r, error);
        else if (length && !enf_word_is(word, length, "comment") && !enf_word_is(word, length, "obj_info"))
            status = enf_source_fail(source, error, "not understood; this is no PLY header");
        if (status != ENF_OK) return status;
    }
    return enf_source_fail(source, error, "the header does not end (\"end_header\"); the file is truncated");
}

// ---- the body

static double decode(uint64_t bits, value_type type) {
    uint32_t low = (uint32_t)bits;
    float single;
    double wide;
    switch (type) {
    case INT8:
        return (int8_t)low;
    case UINT8:
        return (uint8_t)low;
    case INT16:
        return (int16_t)low;
    case UINT16:
        return (uint16_t)low;
    case INT32:
        return (int32_t)low;
    case UINT32:
        return low;
    case FLOAT32:
        memcpy(&single, &low, sizeof single);
        return single;
    case NO_TYPE:
    case FLOAT64:
        break;
    }
    memcpy(&wide, &bits, sizeof wide);
    return wide;
}

/// The next value of the element. False if the line (text) or the file (binary) ends before it, or it is no
/// number.
static bool take_value(reader *r, value_type type, double *value) {
    static const unsigned char sizes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
    enf_source *source = r->source;
    if (!r->binary) return enf_source_number(source, value);
    size_t size = sizes[type];
    if ((size_t)(source->end - source->at) < size) return false;
    uint64_t bits = 0;
    for (size_t k = 0; k < size; k++)
        bits |= (uint64_t)(unsigned char)source->at[k] << 8 * (r->big_endian ? size - 1 - k : k);
    source->at += size;
    *value = decode(bits, type);
    return true;
}

/// False only without memory.
static bool add_corner(reader *r, double index) {
    for (int k = 0; k < 3; k++)
        if (!enf_array_reserve(r->corners[k], r->capacity[k], r->corner_count + 1)) return false;
    bool known = index >= 0 && index < (double)r->vertices && index == floor(index);
    size_t first[3] = {r->first_point, r->first_normal, r->first_texcoord};
    for (int k = 0; k < 3; k++)
        r->corners[k][r->corner_count] = known ? (int32_t)((int64_t)first[k] + (int64_t)index) : -1;
    r->corner_count++;
    return true;
}

/// Takes the values of one element. Sets *good to whether all were there; false only without memory.
static bool take_element(reader *r, const element *e, double values[INDICES], bool *good) {
    *good = true;
    for (size_t p = 0; p < e->property_count && *good; p++) {
        const property *at = &r->properties[e->first_property + p];
        double value, count = 1;
        if (at->count_type != NO_TYPE)
            *good = take_value(r, at->count_type, &count) && count >= 0 && count == floor(count);
        for (double k = 0; *good && k < count; k++) {
            *good = take_value(r, at->type, &value);
            if (!*good) break;
            if (at->role < INDICES) values[at->role] = value;
            if (at->role == INDICES && !add_corner(r, value)) return false;
        }
    }
    return true;
}

static bool keep_vertex(reader *r, const double *values) {
    enf_soup *soup = r->soup;
    if (r->has_normals && !enf_soup_add_normal(soup, values[NX], values[NY], values[NZ])) return false;
    if (r->has_texcoords && !enf_soup_add_texcoord(soup, values[U], values[V])) return false;
    return enf_soup_add_point(soup, values[X], values[Y], values[Z]);
}

static enf_status fail_early(const reader *r, const element *e, int64_t number, enf_error *error) {
    static const char *const names[] = {
        [VERTEX] = "vertex", [FACE] = "face", [OTHER_ELEMENT] = "other element"};
    return enf_fail(error, ENF_BAD_INPUT,
                    "%s:%lld: the file ends in or before %s number %lld of %lld; it is truncated",
                    r->source->name, (long long)(r->binary ? number : r->source->line), names[e->kind],
                    (long long)number, (long long)e->count);
}

static enf_status read_elements(reader *r, const element *e, enf_error *error) {
    if (e->property_count == 0 && e->kind == OTHER_ELEMENT) return ENF_OK;
    for (int64_t i = 0; i < e->count; i++) {
        if (!r->binary && !enf_source_skip_space(r->source)) return fail_early(r, e, i + 1, error);
        int64_t line = r->binary ? i + 1 : r->source->line;
        double values[INDICES] = {NAN, NAN, NAN, 0, 0, 0, 0, 0};
        bool good;
        r->corner_count = 0;
        bool held = take_element(r, e, values, &good);
        if (!good && r->binary) return fail_early(r, e, i + 1, error);
        if (!good) values[X] = NAN;
        if (held && !good) held = enf_soup_reject(r->soup, ENF_REJECT_SYNTAX, r->source->file, line, -1);
        if (held && e->kind == VERTEX) held = keep_vertex(r, values);
        if (held && e->kind == FACE && good)
            held = enf_soup_add_polygon(
                r->soup, r->corner_count, r->corners[0], r->has_normals ? r->corners[1] : NULL,
                r->has_texcoords ? r->corners[2] : NULL, r->source->file, line, 0, -1);
        if (!held) return enf_fail_memory(error, "the input's polygons (or more than 2^31 of something)");
        if (!r->binary) enf_source_next_line(r->source);
    }
    return ENF_OK;
}

/// Faces and vertices that take no bytes could be announced in any number.
static enf_status check_counts(const reader *r, enf_error *error) {
    for (size_t e = 0; e < r->element_count; e++) {
        const element *at = &r->elements[e];
        if (at->kind == OTHER_ELEMENT || at->count == 0) continue;
        if (at->property_count == 0)
            return enf_source_fail(r->source, error, "vertices or faces without properties");
        if (at->count > (int64_t)r->source->size)
            return enf_source_fail(
                r->source, error,
                "the header announces more vertices or faces than the file can hold; is it truncated?");
    }
    return ENF_OK;
}

enf_status enf_read_ply(enf_soup *soup, enf_source *source, enf_error *error) {
    reader r = {.soup = soup,
                .source = source,
                .first_point = soup->point_count,
                .first_normal = soup->normal_count,
                .first_texcoord = soup->texcoord_count};
    enf_status status = read_header(&r, error);
    if (status == ENF_OK) status = check_counts(&r, error);
    for (size_t e = 0; e < r.element_count && status == ENF_OK; e++)
        status = read_elements(&r, &r.elements[e], error);
    free(r.elements);
    free(r.properties);
    for (int k = 0; k < 3; k++) free(r.corners[k]);
    return status;
}
