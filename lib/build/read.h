// SPDX-License-Identifier: GPL-3.0-or-later
// What the file readers share: the file in memory and a cursor that takes text apart without the locale's
// say.
#ifndef ENF_BUILD_READ_H
#define ENF_BUILD_READ_H

#include "build/soup.h"

#include <locale.h>

/// A file held in memory, with a cursor. data[size] is a zero byte, so text scanning always stops.
typedef struct enf_source {
    const char *name; ///< for messages
    int32_t file;     ///< index in soup.files
    const char *data;
    size_t size;
    const char *at;  ///< the cursor
    const char *end; ///< data + size
    int64_t line;    ///< 1-based line of the cursor
    bool continues;  ///< a backslash before the line's end joins it with the next line (OBJ)
    bool brackets;   ///< a parenthesis ends a word (PRT)
    locale_t locale; ///< the "C" locale
    char *owned;     ///< data, if the source has to free it
} enf_source;

/// Reads a whole file ("-": standard input), unpacks it if it is gzip, and puts the cursor at its start. The
/// source keeps `path`. ENF_NO_RESOURCES if the file cannot be read, ENF_BAD_INPUT if the gzip data are
/// damaged. Close it in any case.
enf_status enf_source_open(enf_source *source, const char *path, enf_error *error);

/// The same over bytes that stay the caller's; data[size] is a zero byte.
enf_status enf_source_over(enf_source *source, const char *name, const char *data, size_t size,
                           enf_error *error);

void enf_source_close(enf_source *source);

/// Skips blanks; true if something is left on the line.
bool enf_source_more(enf_source *source);

/// Goes to the next line's start; false at the end of the file.
bool enf_source_next_line(enf_source *source);

/// Skips blanks, line ends and `#` comments; true if something is left in the file.
bool enf_source_skip_space(enf_source *source);

/// Skips blanks and takes the word that follows on the line; *length is 0 if there is none.
const char *enf_source_word(enf_source *source, size_t *length);

/// Takes a number (decimal, hexadecimal, nan, inf; correctly rounded) from the line; false, without moving
/// past the blanks, if the next word is not one.
bool enf_source_number(enf_source *source, double *value);

/// Takes a whole number. Saturates instead of overflowing. False if the next word does not begin with one;
/// what follows the digits is left.
bool enf_source_whole(enf_source *source, int64_t *value);

/// Takes the rest of the line, without blanks around it, as a new string; null without memory.
char *enf_source_rest(enf_source *source);

/// True if the cursor is not inside a word.
bool enf_source_word_ends(const enf_source *source);

/// True if the word of that length is `text`.
bool enf_word_is(const char *word, size_t length, const char *text);

/// "file:line: ..." in ENF_BAD_INPUT.
enf_status enf_source_fail(const enf_source *source, enf_error *error, const char *what);

/// Removes the soup's polygons' references (from polygon `first` on) to points, normals and texcoords that do
/// not exist (points become -1 and clean rejects the polygon; the others become -1 and are noted as syntax
/// rejections).
bool enf_read_check_corners(enf_soup *soup, size_t first_polygon);

enf_status enf_read_obj(enf_soup *soup, enf_source *source, enf_error *error);
enf_status enf_read_ply(enf_soup *soup, enf_source *source, enf_error *error);
enf_status enf_read_off(enf_soup *soup, enf_source *source, enf_error *error);
enf_status enf_read_stl(enf_soup *soup, enf_source *source, enf_error *error);

#endif
