// SPDX-License-Identifier: GPL-3.0-or-later
// Reading a file into the soup: load it whole, gunzip it if it is gzip (RFC 1952, by zlib), hand it to the
// reader that its name asks for. Whole files in memory keep the readers simple: no buffer ends, no longest
// line.
#include "build/read.h"

#include "base/array.h"
#include "base/hash.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

/// No input is longer than this, packed or unpacked: it would not fit the 32-bit indices, and a gzip bomb
/// must end.
#define LARGEST_INPUT ((size_t)1 << 33)

typedef struct buffer {
    char *data;
    size_t size, capacity;
} buffer;

static enf_status fail_size(enf_error *error, const char *path) {
    return enf_fail(
        error, ENF_NO_RESOURCES,
        "%s: does not fit into memory, or is longer than 8 GiB; split the world into smaller files", path);
}

static enf_status read_all(int descriptor, const char *path, buffer *out, enf_error *error) {
    for (;;) {
        if (!enf_array_reserve(out->data, out->capacity, out->size + 65537)) return fail_size(error, path);
        ssize_t got = read(descriptor, out->data + out->size, out->capacity - out->size - 1);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0)
            return enf_fail(error, ENF_NO_RESOURCES, "%s: cannot be read (%s); check the file", path,
                            strerror(errno));
        out->size += (size_t)got;
        out->data[out->size] = 0;
        if (out->size > LARGEST_INPUT) return fail_size(error, path);
        if (got == 0) return ENF_OK;
    }
}

static enf_status load(const char *path, buffer *out, enf_error *error) {
    if (strcmp(path, "-") == 0) return read_all(STDIN_FILENO, "standard input", out, error);
    int descriptor = open(path, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0)
        return enf_fail(error, ENF_NO_RESOURCES,
                        "%s: cannot be opened (%s); check the name and the permissions", path,
                        strerror(errno));
    struct stat info;
    enf_status status = ENF_OK;
    if (fstat(descriptor, &info) == 0) {
        if (S_ISDIR(info.st_mode))
            status = enf_fail(error, ENF_NO_RESOURCES, "%s: is a directory; name a file in it", path);
        else if (S_ISREG(info.st_mode) && (uintmax_t)info.st_size > LARGEST_INPUT)
            status = fail_size(error, path);
        else if (info.st_size > 0 &&
                 !enf_array_reserve(out->data, out->capacity, (size_t)info.st_size + 65537))
            status = fail_size(error, path);
    }
    if (status == ENF_OK) status = read_all(descriptor, path, out, error);
    close(descriptor);
    return status;
}

/// Inflates every member of the gzip data; what follows the last member and is no member is ignored, as gzip
/// does.
static enf_status inflate_members(z_stream *stream, const char *path, const buffer *packed, buffer *out,
                                  enf_error *error) {
    size_t fed = 0;
    for (;;) {
        if (stream->avail_in == 0) {
            size_t piece = packed->size - fed < (1u << 30) ? packed->size - fed : 1u << 30;
            stream->next_in = (unsigned char *)packed->data + fed;
            stream->avail_in = (uInt)piece;
            fed += piece;
        }
        if (!enf_array_reserve(out->data, out->capacity, out->size + 65537)) return fail_size(error, path);
        size_t room = out->capacity - out->size - 1;
        uInt given = room < (1u << 30) ? (uInt)room : 1u << 30;
        stream->next_out = (unsigned char *)out->data + out->size;
        stream->avail_out = given;
        int result = inflate(stream, Z_NO_FLUSH);
        out->size += given - stream->avail_out;
        if (out->size > LARGEST_INPUT || result == Z_MEM_ERROR) return fail_size(error, path);
        if (result == Z_STREAM_END) {
            size_t used = fed - stream->avail_in;
            if (packed->size - used < 2 || memcmp(packed->data + used, "\x1f\x8b", 2) != 0) break;
            if (inflateReset(stream) != Z_OK) return fail_size(error, path);
            continue;
        }
        if (result == Z_BUF_ERROR ||
            (result == Z_OK && stream->avail_in == 0 && fed == packed->size && stream->avail_out))
            return enf_fail(error, ENF_BAD_INPUT,
                            "%s: the gzip data end early; the file is truncated, fetch it again", path);
        if (result != Z_OK)
            return enf_fail(error, ENF_BAD_INPUT, "%s: the gzip data are damaged (%s); fetch the file again",
                            path, stream->msg ? stream->msg : "unknown");
    }
    out->data[out->size] = 0;
    return ENF_OK;
}

static enf_status gunzip(const char *path, buffer *data, enf_error *error) {
    z_stream stream = {0};
    if (inflateInit2(&stream, 15 + 16) != Z_OK) return enf_fail_memory(error, "unpacking");
    buffer out = {0};
    enf_status status = inflate_members(&stream, path, data, &out, error);
    inflateEnd(&stream);
    free(data->data);
    *data = out;
    return status;
}

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

bool enf_read_check_corners(enf_soup *soup, size_t first_polygon) {
    for (size_t p = first_polygon; p < soup->polygon_count; p++) {
        bool attribute_lost = false;
        for (int64_t c = soup->polygon_corner[p]; c < soup->polygon_corner[p + 1]; c++) {
            int32_t *point = &soup->corner_point[c];
            int32_t *normal = &soup->corner_normal[c], *texcoord = &soup->corner_texcoord[c];
            if (*point < 0 || (size_t)*point >= soup->point_count) *point = -1;
            if (*normal < -1 || (*normal >= 0 && (size_t)*normal >= soup->normal_count))
                *normal = -1, attribute_lost = true;
            if (*texcoord < -1 || (*texcoord >= 0 && (size_t)*texcoord >= soup->texcoord_count))
                *texcoord = -1, attribute_lost = true;
        }
        if (attribute_lost &&
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

static enf_status parse(enf_soup *soup, const char *path, read_function *read, const buffer *data,
                        enf_error *error) {
    enf_source source = {.name = strcmp(path, "-") == 0 ? "standard input" : path,
                         .data = data->data,
                         .size = data->size,
                         .at = data->data,
                         .end = data->data + data->size,
                         .line = 1};
    source.file = add_file(soup, source.name);
    source.locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    enf_status status = ENF_OK;
    if (source.file < 0 || !source.locale) {
        status = enf_fail_memory(error, "the input");
    } else {
        size_t polygons = soup->polygon_count, rejected = soup->rejected_count;
        soup->content_hash = enf_hash64(data->data, data->size, soup->content_hash);
        if (data->size) status = read(soup, &source, error);
        if (status == ENF_OK) status = check_any_polygon(soup, &source, polygons, rejected, error);
    }
    if (source.locale) freelocale(source.locale);
    return status;
}

enf_status enf_soup_read(enf_soup *soup, const char *path, enf_error *error) {
    read_function *read = reader_for(path);
    if (!read)
        return enf_fail(error, ENF_BAD_INPUT,
                        "%s: unknown kind of file; use .obj, .ply, .off or .stl (or .gz of these)", path);
    buffer data = {0};
    enf_status status = load(path, &data, error);
    if (status == ENF_OK && data.size >= 2 && memcmp(data.data, "\x1f\x8b", 2) == 0)
        status = gunzip(path, &data, error);
    if (status == ENF_OK) status = parse(soup, path, read, &data, error);
    free(data.data);
    return status;
}
