// SPDX-License-Identifier: MIT
// From a view to a file.
#ifndef ENF_FORMAT_SAVE_H
#define ENF_FORMAT_SAVE_H

#include "enfilade/format.h"

/// Writes the arrays that *view points to (null ones are left out; bytes, header and sections are not looked
/// at) to `path`, "-" for standard output. A regular file appears whole or not at all: the bytes go to a file
/// without a name in the same folder (or one with a temporary name where the file system knows no such
/// thing), are synced, and only then get the name. Devices and pipes are written to directly. The view must
/// have passed enf_view_check. ENF_NO_RESOURCES, with nothing left behind, if the folder or disk doesn't
/// allow it.
enf_status enf_view_save(const enf_file_view *view, const char *path, enf_error *error);

#endif
