// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef _GNU_SOURCE
#define _GNU_SOURCE // asprintf, mkstemps
#endif
#include "cli/bench_world.h"

#include "build/gen.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enf_status cli_world_make(const char *name, const char *const *settings, size_t count, char **path,
                          enf_error *error) {
    const char *folder = getenv("TMPDIR");
    if (asprintf(path, "%s/enfilade-XXXXXX.obj", folder ? folder : P_tmpdir) < 0) {
        *path = NULL;
        return enf_fail_memory(error, "a path");
    }
    int descriptor = mkstemps(*path, 4);
    FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "w");
    if (!file) {
        if (descriptor >= 0) close(descriptor);
        return enf_fail(error, ENF_NO_RESOURCES, "%s: can't be written; set TMPDIR to a folder that can",
                        *path);
    }
    enf_status status = enf_gen_write(name, settings, count, file, error);
    if (fclose(file) != 0 && !status)
        status = enf_fail(error, ENF_NO_RESOURCES, "%s: can't be written", *path);
    return status;
}

void cli_world_remove(char *path) {
    if (path) unlink(path);
    free(path);
}
