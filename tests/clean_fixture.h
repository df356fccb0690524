// SPDX-License-Identifier: GPL-3.0-or-later
// What the tests of clean share: soups made by hand, and the judge of what comes out. Failures end the test.
#ifndef ENF_TESTS_CLEAN_FIXTURE_H
#define ENF_TESTS_CLEAN_FIXTURE_H

#include "build/clean.h"

/// No welding, no plane tolerance.
extern const enf_clean_options fixture_exact_options;

/// The next number of the splitmix64 sequence.
uint64_t fixture_random(uint64_t *seed);

/// Adds a polygon of at most 64 corners with points of its own.
void fixture_add_polygon(enf_soup *soup, size_t count, const double (*at)[3], const char *group);

/// Adds the six sides of a box, which faces outwards.
void fixture_add_box(enf_soup *soup, const double low[3], const double high[3], const char *group);

size_t fixture_count_rejected(const enf_soup *soup, enf_reject reason);

/// Points whole and in order; polygons planar, strictly convex, beginning with their smallest corner.
void fixture_check_mesh(const enf_mesh *mesh);

/// Every soup polygon is the source of a kept one, or detail, or rejected; never two of these, never twice.
void fixture_check_accounts(const enf_soup *soup, const enf_mesh *mesh);

#endif
