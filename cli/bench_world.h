// SPDX-License-Identifier: GPL-3.0-or-later
// Worlds of `enfilade gen` as files that go away again.
#ifndef ENF_CLI_BENCH_WORLD_H
#define ENF_CLI_BENCH_WORLD_H

#include "enfilade/base.h"

/// Writes the world to a temporary file; its path is the caller's to unlink and free, whatever the outcome
/// (null: there is none).
enf_status cli_world_make(const char *name, const char *const *settings, size_t count, char **path,
                          enf_error *error);

/// Unlinks and frees it; nothing if null.
void cli_world_remove(char *path);

#endif
