// SPDX-License-Identifier: GPL-3.0-or-later
// Commas, indentation and escapes.
#include "build/json.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

static void new_line(enf_json *json) {
    if (json->one_line) return;
    fputc('\n', json->file);
    for (int i = 0; i < json->depth; i++) fputs("  ", json->file);
}

/// Length of the UTF-8 sequence at `at` (1..4), or 0 if it is none.
static int sequence_length(const unsigned char *at) {
    if (at[0] < 0x80) return 1;
    int length = at[0] >= 0xf0 ? 4 : at[0] >= 0xe0 ? 3 : 2;
    if (at[0] < 0xc2 || at[0] > 0xf4) return 0;
    for (int i = 1; i < length; i++)
        if ((at[i] & 0xc0) != 0x80) return 0;
    if (at[0] == 0xe0 && at[1] < 0xa0) return 0;
    if (at[0] == 0xed && at[1] > 0x9f) return 0; // surrogates
    if (at[0] == 0xf0 && at[1] < 0x90) return 0;
    if (at[0] == 0xf4 && at[1] > 0x8f) return 0;
    return length;
}

static void put_text(FILE *file, const char *text) {
    const unsigned char *at = (const unsigned char *)text;
    fputc('"', file);
    while (*at) {
        int length = sequence_length(at);
        if (length == 0) {
            fputs("\\ufffd", file);
            at++;
            continue;
        }
        if (*at == '"' || *at == '\\')
            fprintf(file, "\\%c", *at);
        else if (*at < 0x20 || *at == 0x7f)
            fprintf(file, "\\u%04x", *at);
        else
            fwrite(at, 1, (size_t)length, file);
        at += length;
    }
    fputc('"', file);
}

static void begin_value(enf_json *json, const char *key) {
    if (json->filled) fputs(json->one_line ? ", " : ",", json->file);
    if (json->depth > 0) new_line(json);
    json->filled = true;
    if (!key) return;
    put_text(json->file, key);
    fputs(": ", json->file);
}

static void begin(enf_json *json, const char *key, char bracket) {
    begin_value(json, key);
    fputc(bracket, json->file);
    json->depth++;
    json->filled = false;
}

static void end(enf_json *json, char bracket) {
    json->depth--;
    if (json->filled) new_line(json);
    fputc(bracket, json->file);
    json->filled = true;
}

void enf_json_begin_object(enf_json *json, const char *key) {
    begin(json, key, '{');
}
void enf_json_end_object(enf_json *json) {
    end(json, '}');
}
void enf_json_begin_array(enf_json *json, const char *key) {
    begin(json, key, '[');
}
void enf_json_end_array(enf_json *json) {
    end(json, ']');
}

void enf_json_text(enf_json *json, const char *key, const char *text) {
    begin_value(json, key);
    if (text)
        put_text(json->file, text);
    else
        fputs("null", json->file);
}

void enf_json_whole(enf_json *json, const char *key, int64_t number) {
    begin_value(json, key);
    fprintf(json->file, "%" PRId64, number);
}

const char *enf_json_print_number(double number, char *text) {
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, 32, "%.*g", digits, number);
        if (strtod(text, NULL) == number) break;
    }
    return text;
}

static void put_number(FILE *file, double number) {
    char text[32];
    fputs(isfinite(number) ? enf_json_print_number(number, text) : "null", file);
}

void enf_json_number(enf_json *json, const char *key, double number) {
    begin_value(json, key);
    put_number(json->file, number);
}

void enf_json_bool(enf_json *json, const char *key, bool value) {
    enf_json_raw(json, key, value ? "true" : "false");
}

void enf_json_null(enf_json *json, const char *key) {
    enf_json_raw(json, key, "null");
}

void enf_json_numbers(enf_json *json, const char *key, const double *numbers, size_t count) {
    begin_value(json, key);
    fputc('[', json->file);
    for (size_t i = 0; i < count; i++) {
        if (i) fputs(", ", json->file);
        put_number(json->file, numbers[i]);
    }
    fputc(']', json->file);
}

void enf_json_wholes(enf_json *json, const char *key, const int32_t *numbers, size_t count) {
    begin_value(json, key);
    fputc('[', json->file);
    for (size_t i = 0; i < count; i++) fprintf(json->file, "%s%" PRId32, i ? ", " : "", numbers[i]);
    fputc(']', json->file);
}

void enf_json_raw(enf_json *json, const char *key, const char *text) {
    begin_value(json, key);
    fputs(text, json->file);
}

void enf_json_finish(enf_json *json) {
    fputc('\n', json->file);
}
