// SPDX-License-Identifier: GPL-3.0-or-later
// What the tests of the readers share: files made of bytes or text, read into a soup. Failures end the test.
#ifndef ENF_TESTS_READ_FIXTURE_H
#define ENF_TESTS_READ_FIXTURE_H

#include "build/soup.h"

/// What came of reading a file. The owner frees the soup.
typedef struct attempt {
    enf_soup soup;
    enf_error error;
    enf_status status;
} attempt;

/// The name of a temporary file of this process; the test removes it.
void fixture_path(char *path, size_t size, const char *suffix);
void fixture_write(const char *path, const void *bytes, size_t size);

/// Writes a temporary file, reads it, removes it.
attempt fixture_read_bytes(const char *suffix, const void *bytes, size_t size);
attempt fixture_read_text(const char *suffix, const char *text);

/// Reads text that must be turned down with `status` and words that contain `words`.
void fixture_expect_failure(const char *suffix, const char *text, enf_status status, const char *words);

/// The point of a polygon's corner.
const double *fixture_corner(const enf_soup *soup, size_t polygon, int corner);

#endif
