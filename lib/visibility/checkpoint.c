// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef _GNU_SOURCE
#define _GNU_SOURCE // memmem
#endif
#include "visibility/checkpoint.h"

#include "base/array.h"
#include "base/hash.h"
#include "base/timer.h"
#include "format/output.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

enum { HEADER_SIZE = 64, RECORD_SIZE = 32, MARK_SIZE = 4 };

static const char magic[] = "ENFCKPT\n", mark[] = "job\n";
static const double sync_interval = 10; // seconds

struct enf_checkpoint {
    char *path;
    int file;
    double synced;
    enf_bytes old; ///< the file as it was
    enf_record *records;
    size_t record_count, record_capacity;
    enf_bytes next; ///< the record being written
};

static enf_status fail_system(enf_error *error, const char *path, const char *what, int reason) {
    return enf_fail(error, ENF_NO_RESOURCES,
                    "%s: the checkpoint can't be %s: %s; check the rights and the disk", path, what,
                    strerror(reason));
}

// ---------------------------------------------------------------------------------------------- header

static uint64_t hash_graph(const enf_portal_graph *graph) {
    size_t openings = (size_t)graph->opening_count;
    uint64_t hash = enf_hash64(graph->opening_cell, openings * sizeof *graph->opening_cell, 0);
    hash = enf_hash64(graph->opening_corner, (openings + 1) * sizeof *graph->opening_corner, hash);
    return enf_hash64(graph->corners, (size_t)graph->opening_corner[openings] * sizeof *graph->corners, hash);
}

static void put_header(enf_bytes *bytes, const enf_checkpoint_about *about) {
    enf_put_bytes(bytes, magic, 8);
    enf_put_word(bytes, ENF_CHECKPOINT_FORMAT, 4);
    enf_put_word(bytes, (uint64_t)about->method, 4);
    enf_put_word(bytes, about->keeps_lines, 4);
    enf_put_word(bytes, (uint64_t)about->graph->cell_count, 4);
    enf_put_word(bytes, (uint64_t)about->graph->opening_count, 4);
    enf_put_word(bytes, 0, 4);
    enf_put_word(bytes, hash_graph(about->graph), 8);
    enf_put_word(bytes, enf_hash64(ENF_VERSION_TEXT, strlen(ENF_VERSION_TEXT), 0), 8);
    enf_put_word(bytes, 0, 8);
    if (!bytes->failed) enf_put_word(bytes, enf_hash64(bytes->data, bytes->count, 0), 8);
}

static uint64_t word_at(const uint8_t *bytes, size_t at, int size) {
    enf_reader reader = {bytes + at, bytes + at + size, false};
    return enf_take_word(&reader, size);
}

/// Compares the header of the file with the one that it should have.
static enf_status check_header(const enf_checkpoint *checkpoint, const uint8_t *header, enf_error *error) {
    static const char advice[] = "remove it, or name another file";
    const uint8_t *found = checkpoint->old.data;
    const char *path = checkpoint->path;
    if (checkpoint->old.count < HEADER_SIZE || memcmp(found, magic, 8) != 0)
        return enf_fail(error, ENF_BAD_INPUT,
                        "%s: this is no checkpoint; it is left as it is, name another file", path);
    if (word_at(found, 56, 8) != enf_hash64(found, 56, 0))
        return enf_fail(error, ENF_BAD_INPUT, "%s: the checkpoint's header is damaged; %s", path, advice);
    if (word_at(found, 8, 4) != ENF_CHECKPOINT_FORMAT || memcmp(found + 40, header + 40, 8) != 0)
        return enf_fail(error, ENF_BAD_INPUT,
                        "%s: the checkpoint is from another version of this program; go on with that, or %s",
                        path, advice);
    if (memcmp(found + 20, header + 20, 20) != 0)
        return enf_fail(error, ENF_BAD_INPUT, "%s: the checkpoint is of another input; %s", path, advice);
    if (memcmp(found, header, HEADER_SIZE) != 0)
        return enf_fail(
            error, ENF_BAD_INPUT,
            "%s: the checkpoint is of a run with another --method, or with --witness where this one "
            "is without; %s",
            path, advice);
    return ENF_OK;
}

// ---------------------------------------------------------------------------------------------- records

/// The record at a place in the old file; false if there is no good one.
static bool read_record(const enf_checkpoint *checkpoint, size_t at, enf_record *record) {
    const uint8_t *bytes = checkpoint->old.data + at;
    size_t left = checkpoint->old.count - at;
    if (left < RECORD_SIZE || memcmp(bytes, mark, MARK_SIZE) != 0) return false;
    uint64_t cell = word_at(bytes, 16, 4);
    *record = (enf_record){.stage = (int32_t)word_at(bytes, 4, 4),
                           .cell = (int32_t)cell,
                           .key = word_at(bytes, 8, 8),
                           .result = bytes + RECORD_SIZE,
                           .size = (size_t)word_at(bytes, 20, 4)};
    return cell <= INT32_MAX && record->size <= left - RECORD_SIZE &&
           word_at(bytes, 24, 8) == enf_hash64(bytes, 24, enf_hash64(record->result, record->size, 0));
}

/// Finds the good records; *end: behind the last one.
static bool find_records(enf_checkpoint *checkpoint, size_t *end) {
    const enf_bytes *old = &checkpoint->old;
    *end = HEADER_SIZE;
    for (size_t at = HEADER_SIZE; at < old->count;) {
        enf_record record;
        if (read_record(checkpoint, at, &record)) {
            if (!enf_array_reserve(checkpoint->records, checkpoint->record_capacity,
                                   checkpoint->record_count + 1))
                return false;
            checkpoint->records[checkpoint->record_count++] = record;
            *end = at += RECORD_SIZE + record.size;
            continue;
        }
        const uint8_t *next = memmem(old->data + at + 1, old->count - at - 1, mark, MARK_SIZE);
        at = next ? (size_t)(next - old->data) : old->count;
    }
    return true;
}

const enf_record *enf_checkpoint_records(const enf_checkpoint *checkpoint, size_t *count) {
    *count = checkpoint->record_count;
    return checkpoint->records;
}

const char *enf_checkpoint_path(const enf_checkpoint *checkpoint) {
    return checkpoint->path;
}

static bool write_all(int file, const uint8_t *data, size_t size) {
    while (size > 0) {
        ssize_t written = write(file, data, size);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return false;
        data += written;
        size -= (size_t)written;
    }
    return true;
}

enf_status enf_checkpoint_add(enf_checkpoint *checkpoint, const enf_record *record, enf_error *error) {
    enf_bytes *next = &checkpoint->next;
    if (record->size > UINT32_MAX) return ENF_OK; // it will have to be done again
    next->count = 0;
    enf_put_bytes(next, mark, MARK_SIZE);
    enf_put_word(next, (uint64_t)record->stage, 4);
    enf_put_word(next, record->key, 8);
    enf_put_word(next, (uint64_t)record->cell, 4);
    enf_put_word(next, record->size, 4);
    if (!next->failed)
        enf_put_word(next, enf_hash64(next->data, next->count, enf_hash64(record->result, record->size, 0)),
                     8);
    enf_put_bytes(next, record->result, record->size);
    if (next->failed) return enf_fail_memory(error, "the checkpoint");
    errno = 0;
    if (!write_all(checkpoint->file, next->data, next->count))
        return fail_system(error, checkpoint->path, "written", errno ? errno : EIO);
    double now = enf_timer_now();
    if (now - checkpoint->synced < sync_interval) return ENF_OK;
    checkpoint->synced = now;
    return fdatasync(checkpoint->file) == 0 || errno == EINVAL
               ? ENF_OK
               : fail_system(error, checkpoint->path, "written", errno);
}

// ---------------------------------------------------------------------------------------------- file

/// A file that is not there yet appears with its whole header.
static enf_status create(const char *path, const enf_bytes *header, enf_error *error) {
    struct stat about;
    if (stat(path, &about) == 0 && !S_ISREG(about.st_mode))
        return enf_fail(error, ENF_NO_RESOURCES, "%s: a checkpoint must be a file; name another one", path);
    if (stat(path, &about) == 0 && about.st_size > 0) return ENF_OK;
    enf_output output;
    enf_status status = enf_output_open(&output, path, error);
    if (status) return status;
    enf_output_write(&output, header->data, header->count);
    return enf_output_commit(&output, error);
}

static enf_status read_old(enf_checkpoint *checkpoint, enf_error *error) {
    struct stat about;
    enf_bytes *old = &checkpoint->old;
    if (fstat(checkpoint->file, &about) != 0) return fail_system(error, checkpoint->path, "read", errno);
    old->data = enf_array_new((size_t)about.st_size, 1);
    if (!old->data) return enf_fail_memory(error, "the checkpoint");
    while (old->count < (size_t)about.st_size) {
        ssize_t got = read(checkpoint->file, old->data + old->count, (size_t)about.st_size - old->count);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return fail_system(error, checkpoint->path, "read", errno);
        if (got == 0) break;
        old->count += (size_t)got;
    }
    return ENF_OK;
}

static enf_status open_file(enf_checkpoint *checkpoint, const enf_bytes *header, enf_error *error) {
    enf_status status = create(checkpoint->path, header, error);
    if (status) return status;
    checkpoint->file = open(checkpoint->path, O_RDWR | O_APPEND | O_CLOEXEC);
    if (checkpoint->file < 0) return fail_system(error, checkpoint->path, "opened", errno);
    if (flock(checkpoint->file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        return enf_fail(error, ENF_NO_RESOURCES,
                        "%s: another run writes this checkpoint; wait for its end, or name another file",
                        checkpoint->path);
    return read_old(checkpoint, error);
}

static enf_status open_all(enf_checkpoint *checkpoint, const enf_bytes *header, enf_error *error) {
    size_t end;
    enf_status status = open_file(checkpoint, header, error);
    if (!status) status = check_header(checkpoint, header->data, error);
    if (status) return status;
    if (!find_records(checkpoint, &end)) return enf_fail_memory(error, "the checkpoint");
    if (end < checkpoint->old.count && ftruncate(checkpoint->file, (off_t)end) != 0)
        return fail_system(error, checkpoint->path, "cut", errno);
    return ENF_OK;
}

enf_status enf_checkpoint_open(enf_checkpoint **checkpoint, const char *path,
                               const enf_checkpoint_about *about, enf_error *error) {
    enf_bytes header = {0};
    put_header(&header, about);
    enf_checkpoint *opened = calloc(1, sizeof *opened);
    if (opened) *opened = (enf_checkpoint){.path = strdup(path), .file = -1, .synced = enf_timer_now()};
    enf_status status = opened && opened->path && !header.failed ? open_all(opened, &header, error)
                                                                 : enf_fail_memory(error, "the checkpoint");
    enf_bytes_free(&header);
    *checkpoint = opened;
    if (!status) return ENF_OK;
    enf_checkpoint_close(opened);
    *checkpoint = NULL;
    return status;
}

void enf_checkpoint_close(enf_checkpoint *checkpoint) {
    if (!checkpoint) return;
    if (checkpoint->file >= 0) {
        fdatasync(checkpoint->file);
        close(checkpoint->file);
    }
    enf_bytes_free(&checkpoint->old);
    enf_bytes_free(&checkpoint->next);
    free(checkpoint->records);
    free(checkpoint->path);
    free(checkpoint);
}
