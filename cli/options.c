// SPDX-License-Identifier: GPL-3.0-or-later
// Strict: a number fills its whole word, an option that is not a list comes once.
#include "cli/options.h"

#include "base/array.h"
#include "build/memory_estimate.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT_MAX = 1024, HELP_COLUMN = 34 };

int cli_misuse(const cli_syntax *syntax, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "%s: ", syntax->command);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fprintf(stderr, "\nusage: %s %s\n", syntax->command, syntax->usage);
    return ENF_BAD_USAGE;
}

bool cli_texts_add(cli_texts *texts, const char *text) {
    if (!enf_array_reserve(texts->items, texts->capacity, texts->count + 1)) return false;
    texts->items[texts->count++] = text;
    return true;
}

bool cli_read_number(const char *text, const char **end, double *number) {
    size_t length = strspn(text, "0123456789+-.eE");
    char *stop;
    *number = length ? strtod(text, &stop) : 0;
    if (length == 0 || stop != text + length || !isfinite(*number)) return false;
    *end = stop;
    return true;
}

static bool read_point(const char *text, double point[3]) {
    for (int a = 0; a < 3; a++) {
        if (!cli_read_number(text, &text, &point[a])) return false;
        if (*text++ != (a < 2 ? ',' : 0)) return false;
    }
    return true;
}

static int read_choice(const cli_syntax *syntax, cli_option *option, const char *value) {
    char names[256] = "";
    for (int i = 0; option->choices[i]; i++) {
        if (strcmp(option->choices[i], value) == 0) {
            *(int *)option->target = i;
            return -1;
        }
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "%s%s", i ? ", " : "", option->choices[i]);
    }
    return cli_misuse(syntax, "%s: there is no '%.100s'; choose one of %s", option->name, value, names);
}

/// Seconds, minutes or hours.
static bool read_seconds(const char *value, double *seconds) {
    static const char units[] = "smh";
    static const double lengths[] = {1, 60, 3600};
    const char *end;
    double number;
    if (!cli_read_number(value, &end, &number) || !(number >= 0)) return false;
    const char *unit = *end ? strchr(units, *end) : units;
    if (!unit || (*end && end[1])) return false;
    *seconds = number * lengths[unit - units];
    return true;
}

static int read_count(const cli_syntax *syntax, cli_option *option, const char *value) {
    char *end;
    errno = 0;
    long number = strtol(value, &end, 10);
    if (*value < '0' || *value > '9' || *end || errno || number < 1 || number > COUNT_MAX)
        return cli_misuse(syntax, "%s: '%.100s' is no whole number from 1 to %d", option->name, value,
                          COUNT_MAX);
    *(int *)option->target = (int)number;
    return -1;
}

static int out_of_memory(void) {
    fputs("out of memory for the options\n", stderr);
    return ENF_NO_RESOURCES;
}

static int add_point(const cli_syntax *syntax, cli_option *option, const char *value) {
    cli_points *points = option->target;
    double point[3];
    if (!read_point(value, point))
        return cli_misuse(syntax, "%s: '%.100s' is no point; write three numbers X,Y,Z without blanks",
                          option->name, value);
    if (!enf_array_reserve(points->items, points->capacity, points->count + 1)) return out_of_memory();
    memcpy(points->items[points->count++], point, sizeof point);
    return -1;
}

static int set(const cli_syntax *syntax, cli_option *option, const char *value) {
    bool is_list = option->kind == CLI_TEXTS || option->kind == CLI_POINTS || option->kind == CLI_FLAG;
    if (option->given && !is_list)
        return cli_misuse(syntax, "%s is given twice; leave one out", option->name);
    option->given = true;
    switch (option->kind) {
    case CLI_FLAG:
        *(bool *)option->target = true;
        return -1;
    case CLI_TEXT:
        if (!*value)
            return cli_misuse(syntax, "%s: the value is empty; write %s", option->name, option->value);
        *(const char **)option->target = value;
        return -1;
    case CLI_TEXTS:
        return cli_texts_add(option->target, value) ? -1 : out_of_memory();
    case CLI_LENGTH: {
        const char *end;
        if (cli_read_number(value, &end, option->target) && !*end && *(double *)option->target >= 0)
            return -1;
        return cli_misuse(syntax, "%s: '%.100s' is no number; write one that is 0 or more", option->name,
                          value);
    }
    case CLI_SECONDS:
        if (read_seconds(value, option->target)) return -1;
        return cli_misuse(syntax, "%s: '%.100s' is no time; write a number of seconds, or 60s, 5m, 2h",
                          option->name, value);
    case CLI_BYTES:
        if (enf_memory_parse(value, option->target)) return -1;
        return cli_misuse(syntax,
                          "%s: '%.100s' is no size; write a whole number with K, M, G or T, as in 16G",
                          option->name, value);
    case CLI_COUNT:
        return read_count(syntax, option, value);
    case CLI_CHOICE:
        return read_choice(syntax, option, value);
    case CLI_POINTS:
        return add_point(syntax, option, value);
    }
    return -1;
}

/// The option that a word names, and the value in it ("--name=value") or null.
static cli_option *find(const cli_syntax *syntax, const char *word, const char **value) {
    *value = NULL;
    for (cli_option *option = syntax->options; option->name; option++) {
        size_t length = strlen(option->name);
        if (word[0] == '-' && option->letter && word[1] == option->letter && !word[2]) return option;
        if (strncmp(word, option->name, length) != 0) continue;
        if (!word[length]) return option;
        if (word[length] == '=' && word[1] == '-') {
            *value = word + length + 1;
            return option;
        }
    }
    return NULL;
}

static void print_help(const cli_syntax *syntax) {
    printf("usage: %s %s\n\n%s\n", syntax->command, syntax->usage, syntax->summary);
    if (syntax->options->name) puts("\noptions:");
    for (const cli_option *option = syntax->options; option->name; option++) {
        char left[128], short_form[8] = "";
        if (option->letter) snprintf(short_form, sizeof short_form, "-%c, ", option->letter);
        snprintf(left, sizeof left, "  %s%s%s%s", short_form, option->name, option->value ? " " : "",
                 option->value ? option->value : "");
        printf("%-*s %s\n", HELP_COLUMN, left, option->help);
    }
    printf("%-*s %s\n", HELP_COLUMN, "  -h, --help", "this text");
}

/// Takes the option at argv[*at], and its value.
static int take(const cli_syntax *syntax, int argc, char **argv, int *at) {
    const char *word = argv[*at], *value;
    cli_option *option = find(syntax, word, &value);
    if (!option) return cli_misuse(syntax, "unknown option '%.100s'", word);
    if (option->kind == CLI_FLAG) {
        if (value) return cli_misuse(syntax, "%s takes no value", option->name);
        return set(syntax, option, "");
    }
    if (!value) {
        if (*at + 1 >= argc || strncmp(argv[*at + 1], "--", 2) == 0)
            return cli_misuse(syntax, "%s needs a value: %s", option->name, option->value);
        value = argv[++*at];
    }
    return set(syntax, option, value);
}

int cli_parse(const cli_syntax *syntax, int argc, char **argv, cli_texts *operands) {
    bool options_end = false;
    for (int i = 0; i < argc; i++) {
        const char *word = argv[i];
        if (options_end || word[0] != '-' || !word[1]) {
            if (!*word) return cli_misuse(syntax, "an empty word stands where %s should", syntax->operand);
            if (!cli_texts_add(operands, word)) return out_of_memory();
        } else if (strcmp(word, "--") == 0) {
            options_end = true;
        } else if (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0) {
            print_help(syntax);
            return ENF_OK;
        } else {
            int status = take(syntax, argc, argv, &i);
            if (status >= 0) return status;
        }
    }
    if ((int)operands->count < syntax->operands_min)
        return cli_misuse(syntax, "%s is missing", syntax->operand);
    if ((int)operands->count > syntax->operands_max)
        return cli_misuse(syntax, "'%.100s' is one word too many", operands->items[syntax->operands_max]);
    return -1;
}
