// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of an image that are made for the file: point location and what is drawn. Used by write.c only.
#ifndef ENF_BUILD_WRITE_PARTS_H
#define ENF_BUILD_WRITE_PARTS_H

#include "build/write.h"

/// Zeroed memory that the image frees; null without memory.
void *enf_build_image_new(enf_build_image *image, size_t count, size_t size);

/// Takes over memory made elsewhere.
void enf_build_image_own(enf_build_image *image, void *memory);

/// A string for the file. False without memory.
typedef struct enf_build_image_strings {
    char *bytes;
    size_t count, capacity;
} enf_build_image_strings;
bool enf_build_image_add_string(enf_build_image_strings *strings, const char *text, uint32_t *offset);

/// Which tetrahedron lies behind each face. Needs points and tetrahedra.
enf_status enf_build_image_neighbours(enf_build_image *image, enf_error *error);

/// The hierarchy of boxes around the tetrahedra. Needs points, tetrahedra and the frame.
enf_status enf_build_image_boxes(enf_build_image *image, enf_error *error);

/// Where point location starts. Needs the boxes, too, and the fine cells.
enf_status enf_build_image_start(enf_build_image *image, enf_error *error);

/// Render points, triangles, groups, materials, and what each cell sees. Needs everything else.
enf_status enf_build_image_draw(enf_build_image *image, const enf_build *build,
                                enf_build_image_strings *strings, enf_error *error);

/// Barriers and their trees, for lines of sight. Needs everything else.
enf_status enf_build_image_sight(enf_build_image *image, const enf_build *build, enf_error *error);

#endif
