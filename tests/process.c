// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include "process.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { WORDS_MAX = 64 };

static char folder[] = P_tmpdir "/enfilade-test-XXXXXX";

bool enter_test_folder(void) {
    return mkdtemp(folder) && chdir(folder) == 0;
}

void leave_test_folder(void) {
    DIR *here = opendir(folder);
    struct dirent *entry;
    while (here && (entry = readdir(here))) {
        char path[512];
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        if (unlink(path) != 0) rmdir(path); // "." and ".." stay
    }
    if (here) closedir(here);
    if (chdir("/") == 0) rmdir(folder);
}

/// The words of `text` (which is cut up), after the program's name.
static void split_words(char *text, char *words[WORDS_MAX]) {
    int count = 0;
    char *rest = NULL;
    words[count++] = (char[]){"enfilade"};
    for (char *word = strtok_r(text, " ", &rest); word && count < WORDS_MAX - 1;
         word = strtok_r(NULL, " ", &rest))
        words[count++] = word;
    words[count] = NULL;
}

static void redirect(const char *path, int flags, int to) {
    int file = open(path, flags, 0600);
    if (file < 0 || dup2(file, to) < 0) _exit(125);
    close(file);
}

static pid_t start(const char *line, const char *in, const char *out, const char *err) {
    fflush(NULL);
    pid_t child = fork();
    if (child != 0) return child;
    char *text = strdup(line), *words[WORDS_MAX];
    split_words(text, words);
    redirect(in, O_RDONLY, STDIN_FILENO);
    redirect(out, O_WRONLY | O_CREAT | O_TRUNC, STDOUT_FILENO);
    redirect(err, O_WRONLY | O_CREAT | O_TRUNC, STDERR_FILENO);
    execv(ENFILADE_CLI, words);
    _exit(126);
}

pid_t start_enfilade(const char *line) {
    return start(line, "/dev/null", "/dev/null", "/dev/null");
}

process run_enfilade(const char *input, const char *line) {
    process result = {0};
    int outcome = 0;
    if (input) write_text(".in", input);
    pid_t child = start(line, input ? ".in" : "/dev/null", ".out", ".err");
    if (child < 0 || waitpid(child, &outcome, 0) != child) abort();
    result.status = WIFEXITED(outcome) ? WEXITSTATUS(outcome) : 128 + WTERMSIG(outcome);
    size_t err_size;
    result.out = read_file(".out", &result.out_size);
    result.err = read_file(".err", &err_size);
    if (!result.out || !result.err) abort();
    return result;
}

void process_free(process *process) {
    free(process->out);
    free(process->err);
    process->out = process->err = NULL;
}

void write_file(const char *path, const void *bytes, size_t size) {
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, size, file) != size || fclose(file) != 0) abort();
}

void write_text(const char *path, const char *text) {
    write_file(path, text, strlen(text));
}

char *read_file(const char *path, size_t *size) {
    *size = 0;
    FILE *file = fopen(path, "rb");
    if (!file) return NULL;
    size_t capacity = 1 << 16;
    char *bytes = malloc(capacity + 1);
    for (size_t got; bytes && (got = fread(bytes + *size, 1, capacity - *size, file)) > 0;) {
        *size += got;
        if (*size < capacity) continue;
        capacity *= 2;
        char *more = realloc(bytes, capacity + 1);
        if (!more) free(bytes);
        bytes = more;
    }
    fclose(file);
    if (bytes) bytes[*size] = 0;
    return bytes;
}

bool file_exists(const char *path) {
    return access(path, F_OK) == 0;
}
