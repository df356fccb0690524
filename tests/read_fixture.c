// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/read_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

void fixture_path(char *path, size_t size, const char *suffix) {
    const char *folder = getenv("TMPDIR");
    snprintf(path, size, "%s/enfilade-test-%ld%s", folder ? folder : P_tmpdir, (long)getpid(), suffix);
}

void fixture_write(const char *path, const void *bytes, size_t size) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

attempt fixture_read_bytes(const char *suffix, const void *bytes, size_t size) {
    char path[512];
    fixture_path(path, sizeof path, suffix);
    fixture_write(path, bytes, size);
    attempt made = {0};
    made.status = enf_soup_read(&made.soup, path, &made.error);
    remove(path);
    return made;
}

attempt fixture_read_text(const char *suffix, const char *text) {
    return fixture_read_bytes(suffix, text, strlen(text));
}

/// Reads text that must be turned down with `status` and words that contain `words`.
void fixture_expect_failure(const char *suffix, const char *text, enf_status status, const char *words) {
    attempt made = fixture_read_text(suffix, text);
    assert_int_equal(made.status, status);
    assert_int_equal(made.error.status, status);
    if (!strstr(made.error.text, words)) fail_msg("\"%s\" does not say \"%s\"", made.error.text, words);
    enf_soup_free(&made.soup);
}

const double *fixture_corner(const enf_soup *soup, size_t polygon, int corner) {
    return &soup->points[3 * (size_t)soup->corner_point[soup->polygon_corner[polygon] + corner]];
}
