// SPDX-License-Identifier: GPL-3.0-or-later
// Reading a file into the soup: hand it to the reader that its name asks for.
#include "build/read.h"

#include "base/array.h"
#include "base/hash.h"

#include <string.h>
#include <strings.h>

typedef enf_status read_function(enf_soup *, enf_source *, enf_error *);

static read_function *reader_for(const char *path) {
    static const struct {
        const char *suffix;
        read_function *read;
    } readers[] = {
        {".obj", enf_read_obj}, {".ply", enf_read_ply}, {".off", enf_read_off}, {".stl", enf_read_stl}};
    if (strcmp(path, "-") == 0) return enf_read_obj;
    size_t length = strlen(path);
    if (length > 3 && strcasecmp(path + length - 3, ".gz") == 0) length -= 3;
    for (size_t i = 0; i < sizeof readers / sizeof *readers; i++)
        if (length >= 4 && strncasecmp(path + length - 4, readers[i].suffix, 4) == 0) return readers[i].read;
    return NULL;
}

/// An attribute that there is not becomes none. True if there was one.
static bool drop_missing(int32_t *attribute, size_t count) {
    if (!attribute || *attribute == -1 || (*attribute >= 0 && (size_t)*attribute < count)) return false;
    *attribute = -1;
    return true;
}

bool enf_read_check_corners(enf_soup *soup, size_t first_polygon) {
    for (size_t p = first_polygon; p < soup->polygon_count; p++) {
        bool lost = false;
        for (int64_t c = soup->polygon_corner[p]; c < soup->polygon_corner[p + 1]; c++) {
            int32_t *point = &soup->corner_point[c];
            if (*point < 0 || (size_t)*point >= soup->point_count) *point = -1;
            lost |= drop_missing(soup->corner_normal ? &soup->corner_normal[c] : NULL, soup->normal_count);
            lost |=
                drop_missing(soup->corner_texcoord ? &soup->corner_texcoord[c] : NULL, soup->texcoord_count);
        }
        if (lost &&
            !enf_soup_reject(soup, ENF_REJECT_SYNTAX, soup->polygon_file[p], soup->polygon_line[p], -1))
            return false;
    }
    return true;
}

static int32_t add_file(enf_soup *soup, const char *path) {
    if (enf_soup_group(soup, "") < 0) return -1;
    if (!enf_array_reserve(soup->files, soup->file_capacity, soup->file_count + 1)) return -1;
    char *copy = strdup(path);
    if (!copy) return -1;
    soup->files[soup->file_count] = copy;
    return (int32_t)soup->file_count++;
}

/// A file must give at least one polygon; if it gave only rejections the first one explains.
static enf_status check_any_polygon(const enf_soup *soup, const enf_source *source, size_t polygons,
                                    size_t rejected, enf_error *error) {
    if (soup->polygon_count > polygons) return ENF_OK;
    if (soup->rejected_count > rejected)
        return enf_fail(
            error, ENF_BAD_INPUT,
            "%s:%lld: this cannot be understood (%s), and the file has no polygons; is it what its name "
            "says?",
            source->name, (long long)soup->rejected[rejected].line,
            enf_reject_name(soup->rejected[rejected].reason));
    return enf_fail(error, ENF_BAD_INPUT, "%s: no polygons; a world needs at least one", source->name);
}

static enf_status parse(enf_soup *soup, enf_source *source, read_function *read, enf_error *error) {
    source->file = add_file(soup, source->name);
    if (source->file < 0) return enf_fail_memory(error, "the input");
    size_t polygons = soup->polygon_count, rejected = soup->rejected_count;
    soup->content_hash = enf_hash64(source->data, source->size, soup->content_hash);
    enf_status status = source->size ? read(soup, source, error) : ENF_OK;
    return status ? status : check_any_polygon(soup, source, polygons, rejected, error);
}

enf_status enf_soup_read(enf_soup *soup, const char *path, enf_error *error) {
    read_function *read = reader_for(path);
    if (!read)
        return enf_fail(error, ENF_BAD_INPUT,
                        "%s: unknown kind of file; use .obj, .ply, .off or .stl (or .gz of these)", path);
    enf_source source;
    enf_status status = enf_source_open(&source, path, error);
    if (status == ENF_OK) status = parse(soup, &source, read, error);
    enf_source_close(&source);
    return status;
}
