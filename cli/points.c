// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/points.h"

#include "cli/options.h"
#include "enfilade/base.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NUMBERS_MAX = 6 };

static const char blanks[] = " \t\r\n\v\f";

/// So many finite numbers and nothing else.
static bool read_line(const char *line, size_t length, double *numbers, int count) {
    if (strlen(line) != length) return false; // a zero byte
    for (int i = 0; i < count; i++) {
        line += strspn(line, blanks);
        if (!cli_read_number(line, &line, &numbers[i])) return false;
        if (*line && !strchr(blanks, *line)) return false;
    }
    return line[strspn(line, blanks)] == 0;
}

int cli_read_numbers(int count, const char *wanted, int (*answer)(const double *numbers, void *user),
                     void *user) {
    char *line = NULL;
    size_t capacity = 0;
    ssize_t length;
    int64_t number = 0;
    int status = ENF_OK;
    while (!status && (length = getline(&line, &capacity, stdin)) >= 0) {
        double numbers[NUMBERS_MAX];
        number++;
        if (!read_line(line, (size_t)length, numbers, count)) {
            fflush(stdout);
            line[strcspn(line, "\r\n")] = 0;
            fprintf(stderr, "stdin:%" PRId64 ": '%.60s' is no %s on each line\n", number, line, wanted);
            status = ENF_BAD_INPUT;
        } else {
            status = answer(numbers, user);
        }
    }
    if (!status && ferror(stdin)) {
        fprintf(stderr, "stdin:%" PRId64 ": can't be read on; check where it comes from\n", number + 1);
        status = ENF_NO_RESOURCES;
    }
    free(line);
    return status;
}
