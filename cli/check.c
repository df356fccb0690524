// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/cli.h"

#include <stdio.h>

int cli_check(int argc, char **argv) {
    (void)argc;
    (void)argv;
    fputs("enfilade check: not built yet\n", stderr);
    return ENF_BAD_USAGE;
}
