// SPDX-License-Identifier: MIT
// The rules that the list of sections names: what the numbers of a section may be.
#ifndef ENF_FORMAT_RULES_H
#define ENF_FORMAT_RULES_H

#include "format/sections.h"

/// The number of the first element of a section that breaks the section's rule; -1: none. The view has the
/// section, and all counts.
int64_t enf_find_bad_element(const enf_file_view *view, const enf_section_spec *spec);

/// The first of `count` numbers that is no number or larger in magnitude than `largest`; -1: none.
int64_t enf_find_bad_double(const double *values, int64_t count, double largest);

#endif
