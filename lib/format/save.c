// SPDX-License-Identifier: MIT
// The table first, the sections after it, straight from the arrays: nothing is copied but the few bytes of
// padding.
#ifndef _GNU_SOURCE
#define _GNU_SOURCE // O_TMPFILE
#endif
#include "format/save.h"

#include "base/hash.h"
#include "format/sections.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define SECTIONS_MAX 128
#define NAME_TRIES_MAX 1000

typedef struct layout {
    enf_file_header header;
    enf_file_section sections[SECTIONS_MAX];
    const void *arrays[SECTIONS_MAX];
} layout;

typedef struct target {
    int file;
    char *path; ///< the final name, links followed
    char *folder;
    char *temporary; ///< null: the file has no name yet
} target;

static uint64_t align(uint64_t offset) {
    return (offset + ENF_FILE_ALIGNMENT - 1) / ENF_FILE_ALIGNMENT * ENF_FILE_ALIGNMENT;
}

static void plan(layout *out, const enf_file_view *view) {
    memset(out, 0, sizeof *out);
    enf_file_header *header = &out->header;
    for (int i = 0; i < enf_section_spec_count && header->section_count < SECTIONS_MAX; i++) {
        const enf_section_spec *spec = &enf_section_specs[i];
        const void *array = enf_view_array(view, spec);
        if (!array) continue;
        out->arrays[header->section_count] = array;
        enf_file_section *section = &out->sections[header->section_count++];
        memcpy(section->tag, spec->tag, sizeof section->tag);
        section->count = (uint64_t)enf_view_count(view, spec->dimension) + spec->extra;
        section->element_size = spec->element_size;
        section->size = section->count * spec->element_size;
        section->checksum = enf_hash64(array, (size_t)section->size, 0);
    }
    size_t table_size = header->section_count * sizeof *out->sections;
    header->table_offset = sizeof *header;
    uint64_t end = header->table_offset + table_size;
    for (uint32_t i = 0; i < header->section_count; i++) {
        out->sections[i].offset = align(end);
        end = out->sections[i].offset + out->sections[i].size;
    }
    memcpy(header->magic, ENF_FILE_MAGIC, sizeof header->magic);
    header->major = ENF_FILE_MAJOR;
    header->minor = ENF_FILE_MINOR;
    header->header_size = sizeof *header;
    header->entry_size = sizeof *out->sections;
    header->file_size = end;
    header->table_checksum = enf_hash64(out->sections, table_size, 0);
    header->header_checksum = enf_hash64(header, offsetof(enf_file_header, header_checksum), 0);
}

static bool put(int file, const void *bytes, uint64_t size) {
    const char *at = bytes;
    while (size > 0) {
        size_t part = size < (1u << 30) ? (size_t)size : 1u << 30;
        ssize_t done = write(file, at, part);
        if (done < 0 && errno == EINTR) continue;
        if (done < 0) return false;
        at += done;
        size -= (uint64_t)done;
    }
    return true;
}

static bool put_layout(int file, const layout *plan) {
    static const char zeros[ENF_FILE_ALIGNMENT] = {0};
    uint64_t end = plan->header.table_offset + plan->header.section_count * sizeof *plan->sections;
    bool good = put(file, &plan->header, sizeof plan->header) &&
                put(file, plan->sections, plan->header.section_count * sizeof *plan->sections);
    for (uint32_t i = 0; good && i < plan->header.section_count; i++) {
        const enf_file_section *section = &plan->sections[i];
        good = put(file, zeros, section->offset - end) && put(file, plan->arrays[i], section->size);
        end = section->offset + section->size;
    }
    return good;
}

static enf_status cannot_write(enf_error *error, const char *path) {
    return enf_fail(error, ENF_NO_RESOURCES, "%s: can't be written: %s; nothing was written", path,
                    strerror(errno));
}

static void close_target(target *target) {
    if (target->file >= 0) close(target->file);
    if (target->temporary) unlink(target->temporary);
    free(target->path);
    free(target->folder);
    free(target->temporary);
}

/// Another free name in the folder of the target, to be tried with O_EXCL or link.
static bool name_temporary(target *target, int number) {
    free(target->temporary);
    int length = asprintf(&target->temporary, "%s.%ld.%d.tmp", target->path, (long)getpid(), number);
    if (length < 0) target->temporary = NULL;
    return length >= 0;
}

static bool open_named(target *target) {
    for (int i = 0; i < NAME_TRIES_MAX; i++) {
        if (!name_temporary(target, i)) return false;
        target->file = open(target->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (target->file >= 0) return true;
        int reason = errno;
        free(target->temporary); // not ours: it must not be removed
        target->temporary = NULL;
        errno = reason;
        if (reason != EEXIST) return false;
    }
    return false;
}

static enf_status open_target(target *target, const char *path, enf_error *error) {
    *target = (struct target){.file = -1};
    target->path = realpath(path, NULL);
    if (!target->path) target->path = strdup(path);
    char *copy = target->path ? strdup(target->path) : NULL;
    if (copy) target->folder = strdup(dirname(copy));
    free(copy);
    if (!target->folder) return enf_fail_memory(error, "an output path");
#ifdef O_TMPFILE
    target->file = open(target->folder, O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666);
    if (target->file >= 0) return ENF_OK;
#endif
    return open_named(target) ? ENF_OK : cannot_write(error, path);
}

/// Gives a file without a name a temporary one.
static bool link_target(target *target) {
    char self[64];
    snprintf(self, sizeof self, "/proc/self/fd/%d", target->file);
    for (int i = 0; i < NAME_TRIES_MAX; i++) {
        if (!name_temporary(target, i)) return false;
        if (linkat(AT_FDCWD, self, AT_FDCWD, target->temporary, AT_SYMLINK_FOLLOW) == 0) return true;
        int reason = errno;
        free(target->temporary);
        target->temporary = NULL;
        errno = reason;
        if (reason != EEXIST) return false;
    }
    return false;
}

static void sync_folder(const char *folder) {
    int file = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file < 0) return;
    fsync(file); // some file systems can't; the data itself is safe by then
    close(file);
}

/// Sync, name, rename.
static bool publish(target *target) {
    if (fsync(target->file) != 0) return false;
    if (!target->temporary && !link_target(target)) return false;
    int file = target->file;
    target->file = -1;
    if (close(file) != 0 || rename(target->temporary, target->path) != 0) return false;
    free(target->temporary);
    target->temporary = NULL;
    sync_folder(target->folder);
    return true;
}

/// Where no link can be made (no /proc), the whole thing again with a temporary name.
static bool publish_or_retry(target *target, const layout *plan) {
    bool nameless = !target->temporary;
    if (publish(target)) return true;
    if (!nameless || target->file < 0) return false;
    close(target->file);
    return open_named(target) && put_layout(target->file, plan) && publish(target);
}

static enf_status save_whole(const layout *plan, const char *path, enf_error *error) {
    target target;
    enf_status status = open_target(&target, path, error);
    if (!status && !(put_layout(target.file, plan) && publish_or_retry(&target, plan)))
        status = cannot_write(error, path);
    close_target(&target);
    return status;
}

static enf_status save_direct(const layout *plan, int file, const char *path, enf_error *error) {
    return put_layout(file, plan) ? ENF_OK : cannot_write(error, path);
}

enf_status enf_view_save(const enf_file_view *view, const char *path, enf_error *error) {
    layout *out = malloc(sizeof *out);
    if (!out) return enf_fail_memory(error, "the section table");
    plan(out, view);
    struct stat about;
    enf_status status;
    if (strcmp(path, "-") == 0) {
        status = save_direct(out, STDOUT_FILENO, "standard output", error);
    } else if (stat(path, &about) == 0 && S_ISDIR(about.st_mode)) {
        errno = EISDIR;
        status = cannot_write(error, path);
    } else if (stat(path, &about) == 0 && !S_ISREG(about.st_mode)) {
        int file = open(path, O_WRONLY | O_CLOEXEC);
        status = file >= 0 ? save_direct(out, file, path, error) : cannot_write(error, path);
        if (file >= 0) close(file);
    } else {
        status = save_whole(out, path, error);
    }
    free(out);
    return status;
}
