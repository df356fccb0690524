// SPDX-License-Identifier: GPL-3.0-or-later
// What both tetrahedralizers do with their result: memory from malloc, and one canonical order.
#ifndef ENF_SHIM_TETRAHEDRA_HPP
#define ENF_SHIM_TETRAHEDRA_HPP

#include "shim/shim.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <vector>

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

/// Canonical corners and lexicographic order: the same set of tetrahedra always becomes the same array. They
/// are dealt out by their first corner (always the smallest: a handful each), then sorted hand by hand.
/// Corners are below `point_count`.
inline void sort_tetrahedra(size_t point_count, enf_tetrahedra &tetrahedra) {
    using Corners = std::array<int32_t, 4>;
    static_assert(sizeof(Corners) == sizeof *tetrahedra.corners, "corners are four plain integers");
    Corners *first = reinterpret_cast<Corners *>(tetrahedra.corners);
    std::vector<size_t> begin(point_count + 2);
    for (size_t i = 0; i < tetrahedra.count; ++i) {
        rotate_corners(tetrahedra.corners[i]);
        ++begin[static_cast<size_t>(first[i][0]) + 2];
    }
    for (size_t p = 2; p < begin.size(); ++p) begin[p] += begin[p - 1];
    const std::vector<Corners> dealt(first, first + tetrahedra.count);
    for (const Corners &corners : dealt) first[begin[static_cast<size_t>(corners[0]) + 1]++] = corners;
    for (size_t p = 0; p < point_count; ++p) std::sort(first + begin[p], first + begin[p + 1]);
}

} // namespace enf
#endif
