// SPDX-License-Identifier: GPL-3.0-or-later
// What the tests of the whole recipe share: soups moved about in ways that must not matter, and what must
// then agree.
#ifndef ENF_TESTS_PIPELINE_FIXTURE_H
#define ENF_TESTS_PIPELINE_FIXTURE_H

#include "build/build.h"

/// Options with every default: CGAL, aspect, auto, keep auto, one thread.
enf_build_options pipeline_options(void);

/// Reads models/NAME.obj, or fails the test.
void pipeline_read_model(enf_soup *soup, const char *name);

/// Reads what `enfilade gen NAME settings...` prints, or fails the test.
void pipeline_generate(enf_soup *soup, const char *name, const char *const *settings, size_t count);

/// Path of a file below the shared data, or null (with a message) if that is absent. Holds until the next
/// call.
const char *pipeline_shared(const char *name);

/// Calls visit(path, file name) for every shared Quake level, in order of names. Skips the test if they are
/// absent.
void pipeline_visit_levels(void (*visit)(const char *path, const char *name));

/// The same soup in another order: points, polygons and each polygon's first corner shuffled. Groups, normals
/// and texture coordinates are dropped.
void pipeline_shuffle(const enf_soup *from, enf_soup *to, uint64_t seed);

/// new[k] = sign[k] * scale * old[axis[k]], for points and spawns; polygons are turned over where that is a
/// mirror.
void pipeline_move(enf_soup *soup, const int axis[3], const int sign[3], double scale);

/// Builds, or fails the test with the builder's words.
void pipeline_build(enf_build *build, const enf_build_options *options);

/// Runs every check on the build as it would be in the file, or fails the test with what is broken.
void pipeline_check(const enf_build *build);

/// A hash of the whole result but for what names the input: complex, regions, cells, portals.
uint64_t pipeline_fingerprint(const enf_build *build);

/// Volumes (world units cubed) of the regions that are thicker than the weld distance, ascending. free() it.
double *pipeline_region_volumes(const enf_build *build, size_t *count);

#endif
