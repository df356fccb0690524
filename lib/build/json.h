// SPDX-License-Identifier: GPL-3.0-or-later
// Writing JSON (RFC 8259) to a stream, for reports and exports.
#ifndef ENF_BUILD_JSON_H
#define ENF_BUILD_JSON_H

#include <stdio.h>

#include "enfilade/base.h"

/// Begin with {.file = stream} and one value; every function takes the value's key, null inside an array and
/// at the top. Write errors stay in the stream (ferror).
typedef struct enf_json {
    FILE *file;
    bool one_line; ///< no line breaks at all
    bool filled;   ///< the innermost object or array has something in it
    int depth;
} enf_json;

void enf_json_begin_object(enf_json *json, const char *key);
void enf_json_end_object(enf_json *json);
void enf_json_begin_array(enf_json *json, const char *key);
void enf_json_end_array(enf_json *json);

/// Bytes that are not UTF-8 become U+FFFD. A null text becomes null.
void enf_json_text(enf_json *json, const char *key, const char *text);
void enf_json_whole(enf_json *json, const char *key, int64_t number);
/// The shortest text that reads back as the same double; null if it is not finite.
void enf_json_number(enf_json *json, const char *key, double number);
void enf_json_bool(enf_json *json, const char *key, bool value);
void enf_json_null(enf_json *json, const char *key);
/// Arrays of numbers, on one line.
void enf_json_numbers(enf_json *json, const char *key, const double *numbers, size_t count);
void enf_json_wholes(enf_json *json, const char *key, const int32_t *numbers, size_t count);
/// Text that is JSON already.
void enf_json_raw(enf_json *json, const char *key, const char *text);
/// The line end after the top value.
void enf_json_finish(enf_json *json);

/// The shortest decimal text that reads back as the same finite double. `text` has room for 32 bytes.
const char *enf_json_print_number(double number, char *text);

#endif
