// SPDX-License-Identifier: GPL-3.0-or-later
// What the commands that take one world file share.
#ifndef ENF_CLI_WORLD_H
#define ENF_CLI_WORLD_H

#include "enfilade/run.h"

/// Opens the world at `path`; prints what is wrong and returns the exit status if it can't be.
int cli_open_world(enf_world **world, const char *path);

#endif
