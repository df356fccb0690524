// SPDX-License-Identifier: MIT
#include "enfilade/base.h"

#include <stdarg.h>
#include <stdio.h>

enf_status enf_fail(enf_error *error, enf_status status, const char *format, ...) {
    if (error) {
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(error->text, sizeof error->text, format, arguments);
        va_end(arguments);
        error->status = status;
    }
    return status;
}

enf_status enf_fail_memory(enf_error *error, const char *what) {
    return enf_fail(error, ENF_NO_RESOURCES, "out of memory for %s; free some memory or split the world",
                    what);
}
