// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the program under test as a process and keeps what it says.
#ifndef ENF_TESTS_PROCESS_H
#define ENF_TESTS_PROCESS_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

typedef struct process {
    int status;      ///< exit status; 128 + the signal that killed it
    char *out, *err; ///< zero-terminated
    size_t out_size;
} process;

/// Makes a folder for the tests' files and goes there. False if it can't.
bool enter_test_folder(void);

/// Removes it with everything in it.
void leave_test_folder(void);

/// Runs `enfilade` with the words of `line` (split at blanks; no quoting), `input` (may be null) as its
/// standard input. Free with process_free.
process run_enfilade(const char *input, const char *line);

void process_free(process *process);

/// Starts it and returns at once: its process id.
pid_t start_enfilade(const char *line);

/// Whole files. Reading returns null (and a size of 0) if there is none.
void write_file(const char *path, const void *bytes, size_t size);
void write_text(const char *path, const char *text);
char *read_file(const char *path, size_t *size);
bool file_exists(const char *path);

#endif
