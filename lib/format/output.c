// SPDX-License-Identifier: MIT
// Write without a name, sync, link, rename. Large outputs go to the disk piece by piece while they are
// written.
#ifndef _GNU_SOURCE
#define _GNU_SOURCE // O_TMPFILE, sync_file_range
#endif
#include "format/output.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { NAME_TRIES_MAX = 1000, PIECE = 8 << 20 };

static const int64_t cached_most = 64 << 20; ///< bytes at a file's end that stay in the cache

static enf_status cannot_write(enf_error *error, const char *path, int reason) {
    return enf_fail(
        error, ENF_NO_RESOURCES,
        "%s: can't be written: %s; nothing was written, check the folder, the rights and the disk", path,
        strerror(reason));
}

/// Another free name in the folder, to be tried with O_EXCL or link.
static bool name_temporary(enf_output *output, int number) {
    free(output->temporary);
    int length = asprintf(&output->temporary, "%s.%ld.%d.tmp", output->path, (long)getpid(), number);
    if (length < 0) output->temporary = NULL;
    return length >= 0;
}

/// Forgets a name that is not ours: it must not be removed.
static void forget_temporary(enf_output *output) {
    free(output->temporary);
    output->temporary = NULL;
}

static int open_named(enf_output *output) {
    for (int i = 0; i < NAME_TRIES_MAX; i++) {
        if (!name_temporary(output, i)) return -1;
        int file = open(output->temporary, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file >= 0) return file;
        int reason = errno;
        forget_temporary(output);
        errno = reason;
        if (reason != EEXIST) return -1;
    }
    return -1;
}

/// Gives a file without a name a temporary one.
static bool link_nameless(enf_output *output) {
    char self[64];
    snprintf(self, sizeof self, "/proc/self/fd/%d", fileno(output->file));
    for (int i = 0; i < NAME_TRIES_MAX; i++) {
        if (!name_temporary(output, i)) return false;
        if (linkat(AT_FDCWD, self, AT_FDCWD, output->temporary, AT_SYMLINK_FOLLOW) == 0) return true;
        int reason = errno;
        forget_temporary(output);
        errno = reason;
        if (reason != EEXIST) return false;
    }
    return false;
}

static bool can_be_linked(void) {
    return access("/proc/self/fd", X_OK) == 0;
}

static int open_file(enf_output *output) {
#ifdef O_TMPFILE
    if (can_be_linked()) {
        int file = open(output->folder, O_RDWR | O_TMPFILE | O_CLOEXEC, 0666);
        if (file >= 0) return file;
    }
#endif
    return open_named(output);
}

static enf_status open_whole(enf_output *output, const char *path, enf_error *error) {
    output->path = realpath(path, NULL);
    if (!output->path) output->path = strdup(path);
    char *copy = output->path ? strdup(output->path) : NULL;
    if (copy) output->folder = strdup(dirname(copy));
    free(copy);
    if (!output->folder) return enf_fail_memory(error, "an output path");
    int file = open_file(output);
    if (file < 0) return cannot_write(error, path, errno);
    output->file = fdopen(file, "w");
    if (output->file) return ENF_OK;
    close(file);
    return enf_fail_memory(error, "an output file");
}

enf_status enf_output_open(enf_output *output, const char *path, enf_error *error) {
    *output = (enf_output){0};
    struct stat about;
    enf_status status = ENF_OK;
    if (strcmp(path, "-") == 0) {
        output->direct = true;
        output->file = stdout;
        output->path = strdup("standard output");
    } else if (stat(path, &about) == 0 && S_ISDIR(about.st_mode)) {
        status = cannot_write(error, path, EISDIR);
    } else if (stat(path, &about) == 0 && !S_ISREG(about.st_mode)) {
        output->direct = true;
        output->file = fopen(path, "we");
        output->path = strdup(path);
        if (!output->file) status = cannot_write(error, path, errno);
    } else {
        status = open_whole(output, path, error);
    }
    if (status == ENF_OK && !output->path) status = enf_fail_memory(error, "an output path");
    if (status) enf_output_discard(output);
    return status;
}

void enf_output_discard(enf_output *output) {
    if (output->file && output->file != stdout) fclose(output->file);
    if (output->temporary) unlink(output->temporary);
    free(output->path);
    free(output->folder);
    free(output->temporary);
    *output = (enf_output){0};
}

#ifdef SYNC_FILE_RANGE_WRITE
/// The disk has failed, or takes no such orders. Only the first counts; the file's sync may not tell it
/// again.
static void order(enf_output *output, int64_t from, int64_t to, unsigned flags) {
    if (sync_file_range(fileno(output->file), from, to - from, flags) == 0 || output->failure) return;
    if (errno == EIO || errno == ENOSPC || errno == EDQUOT) output->failure = errno;
}

/// Sends the last piece to the disk, and waits for what lies far behind to be there.
static void send_piece(enf_output *output) {
    if (output->direct || output->written - output->started < PIECE) return;
    order(output, output->started, output->written, SYNC_FILE_RANGE_WRITE);
    output->started = output->written;
    int64_t end = (output->written - cached_most) / PIECE * PIECE;
    if (end <= output->dropped) return;
    order(output, output->dropped, end,
          SYNC_FILE_RANGE_WAIT_BEFORE | SYNC_FILE_RANGE_WRITE | SYNC_FILE_RANGE_WAIT_AFTER);
    posix_fadvise(fileno(output->file), output->dropped, end - output->dropped, POSIX_FADV_DONTNEED);
    output->dropped = end;
}
#else
static void send_piece(enf_output *output) {
    (void)output; // the sync will send it all
}
#endif

void enf_output_write(enf_output *output, const void *bytes, uint64_t size) {
    const char *at = bytes;
    while (size > 0 && !ferror(output->file)) {
        size_t piece = size < PIECE ? (size_t)size : PIECE;
        fwrite(at, 1, piece, output->file);
        at += piece;
        size -= piece;
        output->written += (int64_t)piece;
        send_piece(output);
    }
}

static void sync_folder(const char *folder) {
    int file = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file < 0) return;
    fsync(file); // some file systems can't; the data itself is safe by then
    close(file);
}

static bool publish(enf_output *output) {
    if (fsync(fileno(output->file)) != 0) return false;
    if (!output->temporary && !link_nameless(output)) return false;
    if (rename(output->temporary, output->path) != 0) return false;
    forget_temporary(output);
    sync_folder(output->folder);
    return true;
}

/// Why writing failed. An error that a full buffer met earlier has lost its number: the next write meets it
/// again.
static int find_reason(FILE *file) {
    if (errno) return errno;
    clearerr(file);
    if (fputc(' ', file) == EOF || fflush(file) != 0) return errno ? errno : EIO;
    return EIO;
}

enf_status enf_output_commit(enf_output *output, enf_error *error) {
    enf_status status = ENF_OK;
    errno = 0;
    if (output->failure)
        status = cannot_write(error, output->path, output->failure);
    else if (fflush(output->file) != 0 || ferror(output->file) || (!output->direct && !publish(output)))
        status = cannot_write(error, output->path, find_reason(output->file));
    enf_output_discard(output);
    return status;
}
