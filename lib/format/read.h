// SPDX-License-Identifier: MIT
// From bytes to a checked view. Nothing is copied, and nothing in the bytes is believed before it has been
// checked.
#ifndef ENF_FORMAT_READ_H
#define ENF_FORMAT_READ_H

#include "enfilade/format.h"

/// Fills *view with pointers into `bytes` (aligned to 8) after checking header, table, checksums (unless
/// `skip_checksums`) and every count and index. One pass over the bytes; needs one byte of memory per node
/// for the time of the call. ENF_BAD_INPUT with words if the file is not what it should be.
enf_status enf_file_read(enf_file_view *view, const void *bytes, size_t size, bool skip_checksums,
                         enf_error *error);

/// The second half of it: checks every count and index of a view whose arrays and counts are set. The writer
/// runs it over what it is about to write.
enf_status enf_view_check(const enf_file_view *view, enf_error *error);

#endif
