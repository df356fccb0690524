// SPDX-License-Identifier: MIT
#ifndef ENF_TESTS_FUZZ_QUERIES_H
#define ENF_TESTS_FUZZ_QUERIES_H

#include "enfilade/run.h"

/// Reads all of what is loaded of a world, and asks every query of it that there is. What the answers are
/// does not matter, but they come, and what they name exists.
void fuzz_queries(const enf_world *world);

#endif
