// SPDX-License-Identifier: GPL-3.0-or-later
// The text cursor. Numbers: up to 2^53 and 10^22 one multiplication or division is correctly rounded
// (Clinger, "How to read floating point numbers accurately", 1990); everything else goes to strtod under the
// C locale.
#define _GNU_SOURCE // strtod_l
#include "build/read.h"

#include <stdlib.h>
#include <string.h>

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
static bool is_line_end(char c) {
    return c == '\n' || c == '\r';
}
static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// Length of the line end at `at`: "\n", "\r\n" or "\r"; 0 if there is none.
static size_t line_end_length(const enf_source *source, const char *at) {
    if (at >= source->end || !is_line_end(*at)) return 0;
    return *at == '\r' && at + 1 < source->end && at[1] == '\n' ? 2 : 1;
}

/// True (and steps over it) if a joined line end is at the cursor.
static bool skip_joint(enf_source *source) {
    if (!source->continues || source->at >= source->end || *source->at != '\\') return false;
    size_t length = line_end_length(source, source->at + 1);
    if (!length) return false;
    source->at += 1 + length;
    source->line++;
    return true;
}

/// True if a word ends here.
static bool word_ends(const enf_source *source, const char *at) {
    if (at >= source->end || is_blank(*at) || is_line_end(*at)) return true;
    if (source->brackets && (*at == '(' || *at == ')')) return true;
    return source->continues && *at == '\\' && line_end_length(source, at + 1);
}

char *enf_source_rest(enf_source *source) {
    enf_source_more(source);
    const char *from = source->at, *end = from;
    while (end < source->end && !is_line_end(*end)) end++;
    source->at = end;
    while (end > from && is_blank(end[-1])) end--;
    return strndup(from, (size_t)(end - from));
}

bool enf_source_word_ends(const enf_source *source) {
    return word_ends(source, source->at);
}

bool enf_source_more(enf_source *source) {
    for (;;) {
        while (source->at < source->end && is_blank(*source->at)) source->at++;
        if (skip_joint(source)) continue;
        return source->at < source->end && !is_line_end(*source->at);
    }
}

bool enf_source_next_line(enf_source *source) {
    for (;;) {
        while (source->at < source->end && !is_line_end(*source->at) && *source->at != '\\') source->at++;
        if (source->at >= source->end) return false;
        if (skip_joint(source)) continue;
        size_t length = line_end_length(source, source->at);
        source->at += length ? length : 1;
        if (!length) continue;
        source->line++;
        return source->at < source->end;
    }
}

bool enf_source_skip_space(enf_source *source) {
    while (!enf_source_more(source) || *source->at == '#')
        if (!enf_source_next_line(source)) return false;
    return true;
}

const char *enf_source_word(enf_source *source, size_t *length) {
    *length = 0;
    if (!enf_source_more(source)) return source->at;
    const char *word = source->at;
    while (!word_ends(source, source->at)) source->at++;
    *length = (size_t)(source->at - word);
    return word;
}

/// The common case: at most 19 digits, a product or quotient of two exact doubles. Null if it is not that
/// case.
static const char *fast_number(const char *at, double *value) {
    static const double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    bool negative = *at == '-';
    if (*at == '-' || *at == '+') at++;
    uint64_t mantissa = 0;
    int digits = 0, exponent = 0;
    for (; is_digit(*at) && digits < 19; at++, digits++) mantissa = mantissa * 10 + (uint64_t)(*at - '0');
    if (*at == '.')
        for (at++; is_digit(*at) && digits < 19; at++, digits++, exponent--)
            mantissa = mantissa * 10 + (uint64_t)(*at - '0');
    if (digits == 0 || is_digit(*at) || mantissa > UINT64_C(1) << 53) return NULL;
    if (*at == 'e' || *at == 'E') {
        at++;
        bool down = *at == '-';
        if (*at == '-' || *at == '+') at++;
        if (!is_digit(*at)) return NULL;
        int power = 0;
        for (; is_digit(*at) && power < 1000; at++) power = power * 10 + (*at - '0');
        exponent += down ? -power : power;
    }
    if (exponent < -22 || exponent > 22) return NULL;
    double magnitude =
        exponent < 0 ? (double)mantissa / powers[-exponent] : (double)mantissa * powers[exponent];
    *value = negative ? -magnitude : magnitude;
    return at;
}

bool enf_source_number(enf_source *source, double *value) {
    if (!enf_source_more(source)) return false;
    const char *stop = fast_number(source->at, value);
    if (!stop || !word_ends(source, stop)) {
        char *slow_stop = NULL;
        *value = strtod_l(source->at, &slow_stop, source->locale);
        stop = slow_stop;
        if (stop == source->at || !word_ends(source, stop)) return false;
    }
    source->at = stop;
    return true;
}

bool enf_source_whole(enf_source *source, int64_t *value) {
    const char *at = source->at;
    bool negative = *at == '-';
    if (*at == '-' || *at == '+') at++;
    if (!is_digit(*at)) return false;
    int64_t sum = 0;
    for (; is_digit(*at); at++)
        if (sum < INT64_MAX / 16) sum = sum * 10 + (*at - '0');
    *value = negative ? -sum : sum;
    source->at = at;
    return true;
}

bool enf_word_is(const char *word, size_t length, const char *text) {
    return strlen(text) == length && memcmp(word, text, length) == 0;
}

enf_status enf_source_fail(const enf_source *source, enf_error *error, const char *what) {
    return enf_fail(error, ENF_BAD_INPUT, "%s:%lld: %s", source->name, (long long)source->line, what);
}
