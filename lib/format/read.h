// SPDX-License-Identifier: MIT
// From bytes to a checked view. Nothing is copied, and nothing in the bytes is believed before it has been
// checked.
#ifndef ENF_FORMAT_READ_H
#define ENF_FORMAT_READ_H

#include "format/sections.h"

/// Fills *view with pointers into `bytes` (aligned to 8) after checking header, table, checksums (unless
/// `skip_checksums`) and every count and index. One pass over the bytes; needs one byte of memory per node
/// for the time of the call. ENF_BAD_INPUT with words if the file is not what it should be.
enf_status enf_file_read(enf_file_view *view, const void *bytes, size_t size, bool skip_checksums,
                         enf_error *error);

/// The first step of it: header, table and which sections are there. The pointers and counts of *view are
/// set, but nothing has been read through them.
enf_status enf_file_place(enf_file_view *view, const void *bytes, size_t size, enf_error *error);

/// The second step, for some parts (enf_load), and what is always loaded: checksums, counts and indices.
/// `view` is as enf_file_place left it. Parts are checked one by one, in any order: where they point into
/// each other, counts from the table decide.
enf_status enf_file_check(const enf_file_view *view, uint32_t loads, bool skip_checksums, enf_error *error);

/// Some parts (enf_load) with all that their counts and indices refer to.
uint32_t enf_load_with_needs(uint32_t loads);

/// Leaves out of a view what is not in `loads`, which are such a set: its arrays become null, counts 0.
void enf_file_show(enf_file_view *shown, const enf_file_view *view, uint32_t loads);

/// Checks every count and index of a view whose arrays and counts are set. The writer runs it over what it is
/// about to write.
enf_status enf_view_check(const enf_file_view *view, enf_error *error);

/// The same for what is loaded together.
enf_status enf_view_check_load(const enf_file_view *view, enf_loaded load, enf_error *error);

#endif
