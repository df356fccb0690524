// SPDX-License-Identifier: GPL-3.0-or-later
// Options of a command as a table: --name value, --name=value, -n value; "--" ends them, "-" is an operand.
#ifndef ENF_CLI_OPTIONS_H
#define ENF_CLI_OPTIONS_H

#include "enfilade/base.h"

typedef enum cli_option_kind {
    CLI_FLAG,    ///< bool
    CLI_TEXT,    ///< const char *
    CLI_TEXTS,   ///< cli_texts; may be repeated
    CLI_LENGTH,  ///< double, finite, >= 0
    CLI_SECONDS, ///< the same; "90", "90s", "1.5m", "13h"
    CLI_COUNT,   ///< int, 1..1024
    CLI_CHOICE,  ///< int, the position in `choices`
    CLI_BYTES,   ///< uint64_t, above 0; "512M", "16G"
    CLI_POINTS,  ///< cli_points; "X,Y,Z"; may be repeated
} cli_option_kind;

typedef struct cli_texts {
    const char **items; ///< point into argv
    size_t count, capacity;
} cli_texts;

typedef struct cli_points {
    double (*items)[3];
    size_t count, capacity;
} cli_points;

typedef struct cli_option {
    const char *name; ///< "--output"; or "-o" alone
    char letter;      ///< 'o' or 0
    cli_option_kind kind;
    void *target;
    const char *value; ///< how help names the value
    const char *help;
    const char *const *choices; ///< null-terminated
    bool given;
} cli_option;

typedef struct cli_syntax {
    const char *command; ///< "enfilade compile"
    const char *usage;   ///< what follows the command in the usage line
    const char *summary; ///< for --help
    cli_option *options; ///< ends with one whose name is null
    int operands_min, operands_max;
    const char *operand; ///< what is missing when there are too few
} cli_syntax;

/// -1: go on; otherwise the exit status (help was printed, or a message and the usage line). Operands point
/// into argv. Lists are the caller's to free, whatever the outcome.
int cli_parse(const cli_syntax *syntax, int argc, char **argv, cli_texts *operands);

/// Prints "command: message" and the usage line; returns ENF_BAD_USAGE.
int cli_misuse(const cli_syntax *syntax, const char *format, ...) ENF_PRINTF(2, 3);

/// A finite decimal number that fills the text between `text` and `*end` (set by the call); no blanks.
bool cli_read_number(const char *text, const char **end, double *number);

bool cli_texts_add(cli_texts *texts, const char *text);

#endif
