// SPDX-License-Identifier: GPL-3.0-or-later
// From a path to a source: load the file whole, gunzip it if it is gzip (RFC 1952, by zlib). Whole files in
// memory keep the readers simple: no buffer ends, no longest line.
#include "build/read.h"

#include "base/array.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
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

enf_status enf_source_over(enf_source *source, const char *name, const char *data, size_t size,
                           enf_error *error) {
    *source =
        (enf_source){.name = name, .data = data, .size = size, .at = data, .end = data + size, .line = 1};
    source->locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    return source->locale ? ENF_OK : enf_fail_memory(error, "the input");
}

enf_status enf_source_open(enf_source *source, const char *path, enf_error *error) {
    const char *name = strcmp(path, "-") == 0 ? "standard input" : path;
    buffer data = {0};
    *source = (enf_source){0};
    enf_status status = load(path, &data, error);
    if (status == ENF_OK && data.size >= 2 && memcmp(data.data, "\x1f\x8b", 2) == 0)
        status = gunzip(name, &data, error);
    if (status == ENF_OK) status = enf_source_over(source, name, data.data, data.size, error);
    source->owned = data.data;
    return status;
}

void enf_source_close(enf_source *source) {
    if (source->locale) freelocale(source->locale);
    free(source->owned);
    *source = (enf_source){0};
}
