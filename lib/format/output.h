// SPDX-License-Identifier: MIT
// Files that appear whole or not at all.
#ifndef ENF_FORMAT_OUTPUT_H
#define ENF_FORMAT_OUTPUT_H

#include <stdio.h>

#include "enfilade/base.h"

/// An output being written: write to `file`, then commit or discard.
typedef struct enf_output {
    FILE *file;
    char *path; ///< the final name, links followed
    char *folder;
    char *temporary; ///< null: the file has no name yet
    bool direct;     ///< standard output, a device or a pipe: bytes go there at once

    // Of enf_output_write: bytes written, of these on their way to the disk, and no longer in the cache.
    int64_t written, started, dropped;
    int failure; ///< errno of the disk, or 0
} enf_output;

/// Begins writing to `path`, "-" for standard output. What is at `path` stays until the commit. The bytes go
/// to a file without a name in the same folder (or one with a temporary name where the file system knows no
/// such thing), so that a killed program leaves nothing that looks like a result. ENF_NO_RESOURCES if the
/// folder doesn't allow it.
enf_status enf_output_open(enf_output *output, const char *path, enf_error *error);

/// Writes many bytes to an output that takes no others but through this call. What is large goes to the disk
/// while it is being written, and leaves the cache: the sync has little left to wait for, and a file of
/// gigabytes does not fill the memory. A failure waits for the commit.
void enf_output_write(enf_output *output, const void *bytes, uint64_t size);

/// Flushes, syncs and gives the file its name. On failure nothing is left behind. The output is closed then.
enf_status enf_output_commit(enf_output *output, enf_error *error);

/// Gives up. Fine on an output that is zeroed, closed or failed to open.
void enf_output_discard(enf_output *output);

#endif
