// SPDX-License-Identifier: GPL-3.0-or-later
// The files that a command reads and writes.
#ifndef ENF_CLI_PATHS_H
#define ENF_CLI_PATHS_H

#include "cli/options.h"

/// No output may replace an input or another output: the first of the outputs (null: not wanted) that would,
/// or null. "-" is no file as an input, but can be only one output.
const char *cli_find_clash(const cli_texts *inputs, const char *const *outputs, int count);

#endif
