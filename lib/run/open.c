// SPDX-License-Identifier: MIT
// Opening and closing: a mapped file, or one that already lies in memory.
#include "run/open.h"

#include "format/locate.h"
#include "format/read.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

struct enf_world {
    enf_file_view view;
    void *mapping; ///< null: the bytes are the caller's
    size_t mapping_size;
};

static enf_status open_bytes(enf_world **out, const void *bytes, size_t size, const enf_open_options *options,
                             enf_error *error) {
    enf_world *world = calloc(1, sizeof *world);
    if (!world) return enf_fail_memory(error, "opening a world");
    bool skip_checksums = options && options->skip_checksums;
    enf_status status = enf_file_read(&world->view, bytes, size, skip_checksums, error);
    if (status) {
        free(world);
        return status;
    }
    *out = world;
    return ENF_OK;
}

enf_status enf_world_open_memory(enf_world **world, const void *bytes, size_t size,
                                 const enf_open_options *options, enf_error *error) {
    *world = NULL;
    if ((uintptr_t)bytes % 8)
        return enf_fail(error, ENF_BAD_USAGE,
                        "a world in memory must be aligned to 8 bytes; copy it to such a place");
    return open_bytes(world, bytes, size, options, error);
}

/// Maps the whole file. An empty file maps to nothing, which reads as "not a world file".
static enf_status map_file(const char *path, void **mapping, size_t *size, enf_error *error) {
    int file = open(path, O_RDONLY | O_CLOEXEC);
    struct stat about;
    if (file < 0 || fstat(file, &about) != 0) {
        enf_status status =
            enf_fail(error, ENF_NO_RESOURCES, "%s: %s; check the path", path, strerror(errno));
        if (file >= 0) close(file);
        return status;
    }
    enf_status status = ENF_OK;
    *mapping = NULL;
    *size = 0;
    if (!S_ISREG(about.st_mode)) {
        status = enf_fail(error, ENF_NO_RESOURCES, "%s: not a file; name the world file itself", path);
    } else if ((uint64_t)about.st_size > SIZE_MAX) {
        status = enf_fail(error, ENF_NO_RESOURCES, "%s: too large for this machine's address space", path);
    } else if (about.st_size > 0) {
        *size = (size_t)about.st_size;
        *mapping = mmap(NULL, *size, PROT_READ, MAP_PRIVATE, file, 0);
        if (*mapping == MAP_FAILED) {
            *mapping = NULL;
            status = enf_fail(error, ENF_NO_RESOURCES, "%s: can't be mapped: %s", path, strerror(errno));
        }
    }
    close(file);
    return status;
}

/// Puts the path before an error's words.
static void name_path(enf_error *error, const char *path) {
    if (!error) return;
    char text[sizeof error->text];
    memcpy(text, error->text, sizeof text);
    enf_fail(error, error->status, "%s: %s", path, text);
}

enf_status enf_world_open_path(enf_world **world, const char *path, const enf_open_options *options,
                               enf_error *error) {
    *world = NULL;
    void *mapping = NULL;
    size_t size = 0;
    enf_status status = map_file(path, &mapping, &size, error);
    if (status) return status;
    status = open_bytes(world, mapping, size, options, error);
    if (status) {
        if (mapping) munmap(mapping, size);
        name_path(error, path);
        return status;
    }
    (*world)->mapping = mapping;
    (*world)->mapping_size = size;
    return ENF_OK;
}

void enf_world_close(enf_world *world) {
    if (!world) return;
    if (world->mapping) munmap(world->mapping, world->mapping_size);
    free(world);
}

bool enf_world_is_mapped(const enf_world *world) {
    return world->mapping != NULL;
}

const enf_file_view *enf_world_file(const enf_world *world) {
    return &world->view;
}

const char *enf_world_string(const enf_world *world, uint32_t string) {
    return (int64_t)string < world->view.string_bytes ? world->view.strings + string : "";
}

enf_place enf_world_locate(const enf_world *world, const double point[3], int32_t hint) {
    return enf_view_locate(enf_world_file(world), point, hint);
}
