// SPDX-License-Identifier: GPL-3.0-or-later
// From the builder's form to a world file.
#ifndef ENF_BUILD_WRITE_H
#define ENF_BUILD_WRITE_H

#include "build/build.h"
#include "enfilade/format.h"

#define ENF_BUILD_IMAGE_OWNED_MAX 48

/// A world as it will be in the file: the view's arrays are the build's own or belong to the image. It lives
/// no longer than the build.
typedef struct enf_build_image {
    enf_file_view view; ///< bytes, header and sections are null
    void *owned[ENF_BUILD_IMAGE_OWNED_MAX];
    int owned_count;
} enf_build_image;

void enf_build_image_free(enf_build_image *image);

/// `options`: the options as JSON text (may be null), without what does not shape the result (threads,
/// paths). ENF_CHECK_FAILED if the build does not hold together, ENF_NO_RESOURCES without memory; the image
/// is empty then.
enf_status enf_build_image_make(enf_build_image *image, const enf_build *build, const char *options,
                                enf_error *error);

/// Makes the image and writes it to `path` ("-": standard output). The file appears whole or not at all.
enf_status enf_build_write(const enf_build *build, const char *options, const char *path, enf_error *error);

#endif
