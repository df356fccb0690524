// SPDX-License-Identifier: GPL-3.0-or-later
// What CGAL's Delaunay triangulation computes with: CGAL's kernel, but the predicates on which its time goes
// are ours (base/exact.h). They know that coordinates are whole numbers, so they decide by a few integers of
// fixed width where CGAL, which does not know, needs intervals and then numbers of any length.
#ifndef ENF_SHIM_CGAL_TRAITS_HPP
#define ENF_SHIM_CGAL_TRAITS_HPP

extern "C" {
#include "base/exact.h"
}

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <cstdint>

namespace enf {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// A point that knows its place in the input.
struct NumberedPoint : Kernel::Point_3 {
    int32_t number;

    NumberedPoint() : number(-1) {}
    NumberedPoint(const double *xyz, int32_t number_)
        : Kernel::Point_3(xyz[0], xyz[1], xyz[2]), number(number_) {}

    /// x, y and z, one after the other.
    const double *coordinates() const { return &x(); }
};

struct Orient {
    using result_type = CGAL::Orientation;

    result_type operator()(const NumberedPoint &a, const NumberedPoint &b, const NumberedPoint &c,
                           const NumberedPoint &d) const {
        return static_cast<result_type>(
            enf_points_orient(a.coordinates(), b.coordinates(), c.coordinates(), d.coordinates()));
    }
};

struct SideOfSphere {
    using result_type = CGAL::Oriented_side;

    result_type operator()(const NumberedPoint &a, const NumberedPoint &b, const NumberedPoint &c,
                           const NumberedPoint &d, const NumberedPoint &point) const {
        return static_cast<result_type>(enf_points_side_of_sphere(
            a.coordinates(), b.coordinates(), c.coordinates(), d.coordinates(), point.coordinates()));
    }
};

struct ConstructPoint {
    const NumberedPoint &operator()(const NumberedPoint &point) const { return point; }
};

struct Traits : Kernel {
    using Point_3 = NumberedPoint;
    using Construct_point_3 = ConstructPoint;
    using Orientation_3 = Orient;
    using Side_of_oriented_sphere_3 = SideOfSphere;

    Construct_point_3 construct_point_3_object() const { return {}; }
    Orientation_3 orientation_3_object() const { return {}; }
    Side_of_oriented_sphere_3 side_of_oriented_sphere_3_object() const { return {}; }
};

} // namespace enf
#endif
