// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef _GNU_SOURCE
#define _GNU_SOURCE // asprintf
#endif
#include "cli/bench_folder.h"

#include "base/array.h"

#include <dirent.h>
#include <errno.h>
#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static const char *const polygon_endings[] = {".obj",    ".obj.gz", ".ply",    ".ply.gz", ".off",
                                              ".off.gz", ".stl",    ".stl.gz", NULL};

/// Length of the name without its ending, or 0 if it is no level's.
static size_t stem_length(const cli_folder *folder, const char *name) {
    const char *const *endings = folder->endings ? folder->endings : polygon_endings;
    size_t length = strlen(name);
    for (; *endings; endings++) {
        size_t tail = strlen(*endings);
        if (length > tail && strcmp(name + length - tail, *endings) == 0) return length - tail;
    }
    return 0;
}

static bool is_asked_for(const cli_folder *folder, const char *name) {
    size_t length = stem_length(folder, name);
    if (length == 0 || !folder->pattern) return length > 0;
    char *stem = strndup(name, length);
    bool match = stem && fnmatch(folder->pattern, stem, 0) == 0;
    free(stem);
    return match;
}

static bool write_all(int descriptor, const void *data, size_t size) {
    for (size_t done = 0; done < size;) {
        ssize_t put = write(descriptor, (const char *)data + done, size - done);
        if (put < 0 && errno != EINTR) return false;
        if (put > 0) done += (size_t)put;
    }
    return true;
}

static bool read_all(int descriptor, void *data, size_t size) {
    for (size_t done = 0; done < size;) {
        ssize_t got = read(descriptor, (char *)data + done, size - done);
        if (got == 0 || (got < 0 && errno != EINTR)) return false;
        if (got > 0) done += (size_t)got;
    }
    return true;
}

/// Works on one level. Never comes back.
static void be_child(const cli_folder *folder, const char *name, int out) {
    char *path = NULL;
    void *row = enf_array_zeroed(folder->row_size, 1);
    int status = ENF_NO_RESOURCES;
    if (row && asprintf(&path, "%s/%s", folder->path, name) >= 0)
        status = folder->work(folder->user, path, name, row);
    if (fflush(stdout) != 0 || !row || !write_all(out, row, folder->row_size)) status = ENF_NO_RESOURCES;
    _exit(status);
}

static int visit_level(const cli_folder *folder, const char *name, void *row) {
    int ends[2], outcome = 0;
    fflush(stdout);
    pid_t child = pipe(ends) == 0 ? fork() : -1;
    if (child == 0) be_child(folder, name, ends[1]);
    bool filled = false;
    if (child > 0) {
        close(ends[1]);
        filled = read_all(ends[0], row, folder->row_size);
        close(ends[0]);
    }
    if (child < 0 || waitpid(child, &outcome, 0) < 0) {
        fputs("enfilade bench: can't start a process\n", stderr);
        return ENF_NO_RESOURCES;
    }
    if (!WIFEXITED(outcome)) {
        printf("%-20s killed by signal %d\n", name, WTERMSIG(outcome));
        return ENF_NO_RESOURCES;
    }
    if (WEXITSTATUS(outcome) == ENF_OK && filled && folder->print) folder->print(folder->user, name, row);
    return WEXITSTATUS(outcome);
}

int cli_folder_visit(const cli_folder *folder) {
    struct dirent **entries = NULL;
    int count = scandir(folder->path, &entries, NULL, alphasort), worst = ENF_OK, visited = 0;
    void *row = enf_array_zeroed(folder->row_size, 1);
    for (int i = 0; i < count; i++) {
        if (row && is_asked_for(folder, entries[i]->d_name)) {
            if (visited++ == 0 && folder->print_head) folder->print_head(folder->user);
            int status = visit_level(folder, entries[i]->d_name, row);
            if (status > worst) worst = status;
        }
        free(entries[i]);
    }
    free(entries);
    free(row);
    if (visited > 0) return worst;
    fprintf(stderr, "%s: %s; name a folder with %s files, gzipped or not\n", folder->path,
            count < 0         ? "can't be read"
            : folder->pattern ? "holds no levels that match"
                              : "holds no levels",
            folder->endings ? *folder->endings : ".obj, .ply, .off or .stl");
    return count < 0 ? ENF_NO_RESOURCES : ENF_BAD_INPUT;
}

int cli_folder_fail(const char *path, const enf_error *error) {
    bool named = strncmp(error->text, path, strlen(path)) == 0;
    fprintf(stderr, "%s%s%s\n", named ? "" : path, named ? "" : ": ", error->text);
    return error->status;
}

static int compare_doubles(const void *left, const void *right) {
    double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

double cli_median(double *values, size_t count) {
    if (count == 0) return 0;
    qsort(values, count, sizeof *values, compare_doubles);
    return values[(count - 1) / 2];
}
