// SPDX-License-Identifier: GPL-3.0-or-later
// What both tetrahedralizers do with their result: memory from malloc, and one canonical order.
#ifndef ENF_SHIM_TETRAHEDRA_HPP
#define ENF_SHIM_TETRAHEDRA_HPP

#include "shim/shim.h"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace enf {

/// Room for `count` tetrahedra; out->count stays 0.
inline enf_status reserve_tetrahedra(size_t count, enf_tetrahedra *out, enf_error *error) {
    out->count = 0;
    out->corners = static_cast<int32_t(*)[4]>(std::calloc(count ? count : 1, sizeof *out->corners));
    return out->corners ? ENF_OK : enf_fail_memory(error, "the tetrahedra");
}

/// Turns the corners without changing the orientation: the smallest index first, the second smallest of the
/// rest next. (The even permutations of four corners include the rotations of three, so this form is unique.)
inline void rotate_corners(int32_t corners[4]) {
    int32_t *smallest = std::min_element(corners, corners + 4);
    if (smallest != corners) {
        // Two exchanges keep the orientation: the smallest with the first, and two of the others.
        std::swap(*smallest, corners[0]);
        std::swap(corners[2], corners[3]);
    }
    std::rotate(corners + 1, std::min_element(corners + 1, corners + 4), corners + 4);
}

/// Canonical corners and lexicographic order: the same set of tetrahedra always becomes the same array.
inline void sort_tetrahedra(enf_tetrahedra &tetrahedra) {
    using Corners = std::array<int32_t, 4>;
    static_assert(sizeof(Corners) == sizeof *tetrahedra.corners, "corners are four plain integers");
    for (size_t i = 0; i < tetrahedra.count; ++i) rotate_corners(tetrahedra.corners[i]);
    Corners *first = reinterpret_cast<Corners *>(tetrahedra.corners);
    std::sort(first, first + tetrahedra.count);
}

} // namespace enf
#endif
