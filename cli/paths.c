// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/paths.h"

#include <string.h>
#include <sys/stat.h>

/// True if two paths name the same file, or would.
static bool is_same_file(const char *a, const char *b) {
    struct stat at_a, at_b;
    if (!a || !b) return false;
    if (strcmp(a, b) == 0) return true;
    if (stat(a, &at_a) != 0 || stat(b, &at_b) != 0) return false;
    return S_ISREG(at_a.st_mode) && at_a.st_dev == at_b.st_dev && at_a.st_ino == at_b.st_ino;
}

const char *cli_find_clash(const cli_texts *inputs, const char *const *outputs, int count) {
    for (int i = 0; i < count; i++) {
        for (int k = i + 1; k < count; k++)
            if (is_same_file(outputs[i], outputs[k])) return outputs[i];
        for (size_t k = 0; k < inputs->count; k++)
            if (strcmp(inputs->items[k], "-") != 0 && is_same_file(outputs[i], inputs->items[k]))
                return outputs[i];
    }
    return NULL;
}
