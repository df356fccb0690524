// SPDX-License-Identifier: GPL-3.0-or-later
// Exact proof that tetrahedra tile the convex hull of their points, given an exact orientation predicate:
// every point is used, every tetrahedron is positive, every inner face has one tetrahedron on each side, and
// the hull turns outwards at none of its edges.
#ifndef ENF_SHIM_TILING_HPP
#define ENF_SHIM_TILING_HPP

#include "shim/shim.h"

#include <algorithm>
#include <array>
#include <vector>

namespace enf {

// A face seen from outside its tetrahedron (counter-clockwise), and its sorted corners to find the twin by.
struct Face {
    std::array<int32_t, 3> key;
    std::array<int32_t, 3> corners;
    bool odd; ///< the corners are an odd permutation of the key

    explicit Face(const std::array<int32_t, 3> &c) : key(c), corners(c) {
        std::sort(key.begin(), key.end());
        const auto at = std::find(c.begin(), c.end(), key[0]) - c.begin();
        odd = c[(at + 1) % 3] != key[1];
    }
};

inline std::vector<Face> list_faces(const enf_tetrahedra &tetrahedra) {
    std::vector<Face> faces;
    faces.reserve(4 * tetrahedra.count);
    for (size_t i = 0; i < tetrahedra.count; ++i) {
        const int32_t *c = tetrahedra.corners[i];
        faces.push_back(Face({c[1], c[2], c[3]}));
        faces.push_back(Face({c[0], c[3], c[2]}));
        faces.push_back(Face({c[0], c[1], c[3]}));
        faces.push_back(Face({c[0], c[2], c[1]}));
    }
    std::sort(faces.begin(), faces.end(), [](const Face &a, const Face &b) { return a.key < b.key; });
    return faces;
}

// Takes the inner faces out, which must be pairs of opposite faces. False when a face is there a wrong number
// of times.
inline bool pair_faces(std::vector<Face> &faces) {
    size_t kept = 0;
    for (size_t i = 0; i < faces.size();) {
        size_t end = i + 1;
        while (end < faces.size() && faces[end].key == faces[i].key) ++end;
        if (end - i > 2 || (end - i == 2 && faces[i].odd == faces[i + 1].odd)) return false;
        if (end - i == 1) faces[kept++] = faces[i];
        i = end;
    }
    faces.erase(faces.begin() + static_cast<std::ptrdiff_t>(kept), faces.end());
    return true;
}

template <typename Orientation>
const char *find_hull_fault(const std::vector<Face> &hull, const Orientation &orientation) {
    struct Edge {
        std::array<int32_t, 2> ends;
        int32_t face, apex;
        bool forward;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * hull.size());
    for (size_t i = 0; i < hull.size(); ++i)
        for (int k = 0; k < 3; ++k) {
            const int32_t from = hull[i].corners[k], to = hull[i].corners[(k + 1) % 3];
            edges.push_back({{std::min(from, to), std::max(from, to)},
                             static_cast<int32_t>(i),
                             hull[i].corners[(k + 2) % 3],
                             from < to});
        }
    std::sort(edges.begin(), edges.end(), [](const Edge &a, const Edge &b) { return a.ends < b.ends; });
    for (size_t i = 0; i < edges.size(); i += 2) {
        if (i + 1 == edges.size() || edges[i].ends != edges[i + 1].ends ||
            edges[i].forward == edges[i + 1].forward ||
            (i + 2 < edges.size() && edges[i + 2].ends == edges[i].ends))
            return "its hull is not closed";
        const Face &face = hull[static_cast<size_t>(edges[i].face)];
        if (orientation(face.corners[0], face.corners[1], face.corners[2], edges[i + 1].apex) > 0)
            return "its hull is not convex";
    }
    return nullptr;
}

/// Null, or what is wrong. `orientation(a, b, c, d)` is the exact sign of the determinant of (b-a, c-a, d-a).
template <typename Orientation>
const char *find_tiling_fault(size_t point_count, const enf_tetrahedra &tetrahedra,
                              const Orientation &orientation) {
    std::vector<bool> used(point_count);
    for (size_t i = 0; i < tetrahedra.count; ++i) {
        const int32_t *c = tetrahedra.corners[i];
        for (int k = 0; k < 4; ++k) used[static_cast<size_t>(c[k])] = true;
        if (orientation(c[0], c[1], c[2], c[3]) <= 0) return "a tetrahedron is flat or turned inside out";
    }
    if (std::find(used.begin(), used.end(), false) != used.end()) return "a point is missing";
    std::vector<Face> faces = list_faces(tetrahedra);
    if (!pair_faces(faces)) return "a face has more than two tetrahedra, or two on the same side";
    return find_hull_fault(faces, orientation);
}

} // namespace enf
#endif
