// SPDX-License-Identifier: MIT
// What every Enfilade library shares: status codes, the error a call leaves behind, the export macro.
#ifndef ENFILADE_BASE_H
#define ENFILADE_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define ENF_VERSION_MAJOR 0
#define ENF_VERSION_MINOR 1
#define ENF_VERSION_PATCH 0
#define ENF_VERSION_TEXT "0.1.0"

#if defined(__GNUC__)
#define ENF_API __attribute__((visibility("default")))
#define ENF_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define ENF_API
#define ENF_PRINTF(text, first)
#endif

#ifdef __cplusplus
extern "C" {
#endif

/// The outcome of a call. The values are the command line's exit statuses.
typedef enum enf_status {
    ENF_OK = 0,
    ENF_CHECK_FAILED = 1, ///< an invariant does not hold
    ENF_BAD_USAGE = 2,    ///< the caller's options make no sense
    ENF_BAD_INPUT = 3,    ///< a file or scene is wrong; the text says where, what, and what to do
    ENF_NO_RESOURCES = 4, ///< out of memory, disk or time; an unreadable or unwritable file
} enf_status;

/// What went wrong, in words for the user ("file:line: what is wrong; what to do").
/// Every call that can fail takes a pointer to one, which may be null.
typedef struct enf_error {
    enf_status status;
    char text[1024];
} enf_error;

/// Fills *error (if not null) and returns `status`, so that failing reads `return enf_fail(error, ...)`.
ENF_API enf_status enf_fail(enf_error *error, enf_status status, const char *format, ...) ENF_PRINTF(3, 4);

/// ENF_NO_RESOURCES with the usual words for a failed allocation.
ENF_API enf_status enf_fail_memory(enf_error *error, const char *what);

#ifdef __cplusplus
}
#endif
#endif
