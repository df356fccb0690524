// SPDX-License-Identifier: GPL-3.0-or-later
// What the sampler's files share.
#ifndef ENF_VISIBILITY_CHECK_SAMPLER_PARTS_H
#define ENF_VISIBILITY_CHECK_SAMPLER_PARTS_H

#include "visibility_check/sampler.h"

/// Walks the line from its cell, in its direction and against it; the walk stays in the sampler until the
/// next one. Returns the place of the line's cell, -1 without memory.
int32_t enf_sampler_walk(enf_sampler *sampler, const enf_sampler_line *line);

/// The same, and notes all pairs of cells on the way.
void enf_sampler_throw(enf_sampler *sampler, const enf_sampler_line *line);

/// The next random number, at least 0, less than 1.
double enf_sampler_random(enf_sampler *sampler);

/// One that is less than `count`.
int32_t enf_sampler_choose(enf_sampler *sampler, int32_t count);

/// Leads a line on that goes through both cells: from the first through the second into the cells behind that
/// the first is not yet known to see. For each of these portal sequences a linear program, and from its point
/// to a line. `again`: even if it was tried before, along some other line.
void enf_sampler_lead_on(enf_sampler *sampler, const enf_sampler_line *line, int32_t from, int32_t to,
                         bool again);

#endif
