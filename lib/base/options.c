// SPDX-License-Identifier: MIT
#include "base/options.h"

#include <string.h>

enum { SIZE_MOST = 65536 }; // more than any struct will ever have: not a size

enf_status enf_options_take(void *to, size_t size, const void *from, const char *what, enf_error *error) {
    size_t given = size;
    memset(to, 0, size);
    if (from) memcpy(&given, from, sizeof given);
    if (given < sizeof given || given > SIZE_MOST)
        return enf_fail(error, ENF_BAD_USAGE, "%s: size is %zu; set it to sizeof(%s)", what, given, what);
    const unsigned char *bytes = from;
    for (size_t i = size; from && i < given; i++) {
        if (bytes[i])
            return enf_fail(error, ENF_BAD_USAGE,
                            "%s: something is set that this version of the library does not know", what);
    }
    if (from) memcpy(to, from, given < size ? given : size);
    memcpy(to, &size, sizeof size);
    return ENF_OK;
}
