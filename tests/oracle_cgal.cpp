// SPDX-License-Identifier: GPL-3.0-or-later
#include "oracle.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Gmpq.h>
#include <CGAL/Gmpz.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/determinant.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace {

using integer = CGAL::Gmpz;
using rational = CGAL::Gmpq;
using kernel = CGAL::Simple_cartesian<rational>;
using vector = std::array<integer, 3>;

struct coefficients {
    vector normal;
    integer offset;
};

struct homogeneous {
    vector at;
    integer weight;
};

vector whole(const double p[3]) {
    return {integer(p[0]), integer(p[1]), integer(p[2])};
}

vector minus(const vector &a, const vector &b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

integer dot(const vector &a, const vector &b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

vector cross(const vector &a, const vector &b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

coefficients plane_of(const oracle_plane *plane) {
    vector p = whole(plane->p), v{integer(0), integer(0), integer(0)};
    if (plane->axis < 0)
        v = minus(whole(plane->r), p);
    else
        v[static_cast<size_t>(plane->axis)] = integer(1);
    vector normal = cross(minus(whole(plane->q), p), v);
    return {normal, -dot(normal, p)};
}

// Cramer's rule.
homogeneous corner_of(const oracle_corner *corner) {
    if (corner->is_point) return {whole(corner->point), integer(1)};
    std::array<coefficients, 3> plane;
    for (size_t i = 0; i < 3; i++) plane[i] = plane_of(&corner->planes[i]);
    homogeneous out;
    for (size_t column = 0; column < 4; column++) {
        auto entry = [&](size_t row, size_t k) {
            return k == column ? -plane[row].offset : plane[row].normal[k];
        };
        integer value = CGAL::determinant(entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 0), entry(1, 1),
                                          entry(1, 2), entry(2, 0), entry(2, 1), entry(2, 2));
        (column < 3 ? out.at[column] : out.weight) = value;
    }
    return out;
}

int sign_of(const integer &value) {
    return static_cast<int>(CGAL::sign(value));
}

kernel::Point_3 kernel_point(const double p[3]) {
    return {rational(p[0]), rational(p[1]), rational(p[2])};
}

kernel::Plane_3 kernel_plane(const oracle_plane *plane) {
    kernel::Point_3 p = kernel_point(plane->p), q = kernel_point(plane->q);
    if (plane->axis < 0) return {p, q, kernel_point(plane->r)};
    return {p, q, p + kernel::Vector_3(plane->axis == 0, plane->axis == 1, plane->axis == 2)};
}

using flat_point = std::pair<rational, rational>;

rational area_of(int axis, const oracle_corner *corners, int count) {
    rational sum(0);
    const size_t u = static_cast<size_t>(axis + 1) % 3, v = static_cast<size_t>(axis + 2) % 3;
    auto project = [&](int i) {
        homogeneous h = corner_of(&corners[i]);
        return flat_point(rational(h.at[u], h.weight), rational(h.at[v], h.weight));
    };
    flat_point before = count > 0 ? project(count - 1) : flat_point();
    for (int i = 0; i < count; i++) {
        flat_point here = project(i);
        sum += before.first * here.second - here.first * before.second;
        before = here;
    }
    return sum;
}

} // namespace

int oracle_orient(const double a[3], const double b[3], const double c[3], const double d[3]) {
    vector origin = whole(a);
    return sign_of(dot(cross(minus(whole(b), origin), minus(whole(c), origin)), minus(whole(d), origin)));
}

int oracle_side_of_sphere(const double a[3], const double b[3], const double c[3], const double d[3],
                          const double point[3]) {
    using exact = CGAL::Exact_predicates_inexact_constructions_kernel;
    auto at = [](const double p[3]) { return exact::Point_3(p[0], p[1], p[2]); };
    return static_cast<int>(CGAL::side_of_oriented_sphere(at(a), at(b), at(c), at(d), at(point)));
}

bool oracle_spans(const oracle_plane *plane) {
    vector normal = plane_of(plane).normal;
    return sign_of(normal[0]) != 0 || sign_of(normal[1]) != 0 || sign_of(normal[2]) != 0;
}

bool oracle_crosses(const oracle_plane planes[3]) {
    return sign_of(dot(plane_of(&planes[0]).normal,
                       cross(plane_of(&planes[1]).normal, plane_of(&planes[2]).normal))) != 0;
}

void oracle_sides(const oracle_corner *corner, const oracle_plane *planes, int count, int *sides) {
    homogeneous at = corner_of(corner);
    for (int i = 0; i < count; i++) {
        coefficients of = plane_of(&planes[i]);
        sides[i] = sign_of(dot(of.normal, at.at) + of.offset * at.weight) * sign_of(at.weight);
    }
}

int oracle_side_by_kernel(const oracle_corner *corner, const oracle_plane *plane) {
    kernel::Point_3 point = corner->is_point ? kernel_point(corner->point) : kernel::Point_3();
    if (!corner->is_point) {
        auto found = CGAL::intersection(kernel_plane(&corner->planes[0]), kernel_plane(&corner->planes[1]),
                                        kernel_plane(&corner->planes[2]));
        point = boost::get<kernel::Point_3>(*found);
    }
    return static_cast<int>(kernel_plane(plane).oriented_side(point));
}

int oracle_dominant_axis(const oracle_plane *plane, int *sign) {
    vector normal = plane_of(plane).normal;
    size_t best = 0;
    for (size_t i = 1; i < 3; i++)
        if (CGAL::abs(normal[i]) > CGAL::abs(normal[best])) best = i;
    *sign = sign_of(normal[best]);
    return static_cast<int>(best);
}

bool oracle_same_way(const oracle_plane *a, const oracle_plane *b) {
    return sign_of(dot(plane_of(a).normal, plane_of(b).normal)) > 0;
}

bool oracle_position_error(const oracle_corner *corner, const double position[3], double reach,
                           double *error) {
    homogeneous h = corner_of(corner);
    *error = 0;
    for (size_t i = 0; i < 3; i++) {
        rational at(h.at[i], h.weight);
        if (CGAL::abs(at) > rational(reach)) return false;
        double upper = CGAL::to_interval(CGAL::abs(at - rational(position[i]))).second;
        *error = std::max(*error, upper);
    }
    return true;
}

int oracle_compare_areas(int axis, const oracle_corner *a, int a_count, const oracle_corner *b, int b_count,
                         const oracle_corner *c, int c_count, int *sign_of_a) {
    rational whole_area = area_of(axis, a, a_count);
    *sign_of_a = static_cast<int>(CGAL::sign(whole_area));
    return static_cast<int>(CGAL::sign(whole_area - area_of(axis, b, b_count) - area_of(axis, c, c_count)));
}
