// SPDX-License-Identifier: MIT
// How much memory this process has, has had, and may have.
#ifndef ENF_BASE_MEMORY_H
#define ENF_BASE_MEMORY_H

#include <stdint.h>

/// The most memory that the process has had so far, bytes; 0 if the system can't tell.
uint64_t enf_memory_peak(void);

/// What it has now, bytes; 0 if the system can't tell.
uint64_t enf_memory_resident(void);

/// What the whole process may have at most: the machine's memory, or less if a control group or the limit of
/// the address space (ulimit -v) says so. *limiter receives which of them it is, in words. UINT64_MAX if
/// nothing is known.
uint64_t enf_memory_limit(const char **limiter);

#endif
