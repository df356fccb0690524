// SPDX-License-Identifier: AGPL-3.0-or-later
// Delaunay tetrahedra by TetGen 1.5 (H. Si, "TetGen, a Delaunay-Based Quality Tetrahedral Mesh Generator",
// 2015). TetGen keeps its predicates' constants in global variables, so calls take turns.
//
// TetGen aborts the process when it starts from a tetrahedron that is flat but for rounding, and it finds its
// first four points by an inexact determinant and a tolerance. So the order of insertion is made here: four
// points that span the world well come first, the tolerance is zero, and what is too flat for that is refused
// before TetGen sees it. The result is then verified exactly; TetGen has been seen to give wrong results
// silently.
#include "shim/shim.h"
#include "shim/tetrahedra.hpp"
#include "shim/tiling.hpp"

extern "C" {
#include "base/exact.h"
}

#define TETLIBRARY
#include <tetgen.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <mutex>
#include <new>
#include <numeric>
#include <vector>

namespace {

std::mutex turns;

using Point = std::array<double, 3>;

Point minus(const Point &a, const Point &b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Point cross(const Point &a, const Point &b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot(const Point &a, const Point &b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Into [-1, 1] by a power of two, so exactly.
std::vector<Point> scale(const double *points, size_t point_count) {
    double largest = 0;
    for (size_t i = 0; i < 3 * point_count; ++i) largest = std::max(largest, std::fabs(points[i]));
    int exponent = 0;
    std::frexp(largest, &exponent);
    std::vector<Point> scaled(point_count);
    for (size_t i = 0; i < 3 * point_count; ++i) scaled[i / 3][i % 3] = std::ldexp(points[i], -exponent);
    return scaled;
}

template <typename Measure> size_t find_largest(const std::vector<Point> &points, Measure measure) {
    size_t best = 0;
    for (size_t i = 1; i < points.size(); ++i)
        if (measure(points[i]) > measure(points[best])) best = i;
    return best;
}

// Whether TetGen's inexact determinant has the right sign, and none of 0, for these four points.
bool is_safe_start(const double *given, const std::vector<Point> &points,
                   const std::array<size_t, 4> &start) {
    tetgenmesh mesh; // for the very determinant that TetGen will take
    std::array<Point, 4> corners;
    for (size_t k = 0; k < 4; ++k) corners[k] = points[start[k]];
    const double found =
        mesh.orient3dfast(corners[0].data(), corners[1].data(), corners[2].data(), corners[3].data());
    const int exact = enf_points_orient(given + 3 * start[0], given + 3 * start[1], given + 3 * start[2],
                                        given + 3 * start[3]);
    return exact > 0 ? found < 0 : exact < 0 && found > 0; // TetGen's signs are the opposite of ours
}

// Four points that span a large tetrahedron: the farthest from the first, from their line, from their plane.
// False when TetGen could not tell its orientation.
bool find_start(const double *given, const std::vector<Point> &points, std::array<size_t, 4> &start) {
    const Point origin = points[0];
    start[0] = 0;
    start[1] = find_largest(points, [&](const Point &p) { return dot(minus(p, origin), minus(p, origin)); });
    const Point axis = minus(points[start[1]], origin);
    start[2] = find_largest(points, [&](const Point &p) {
        const Point normal = cross(axis, minus(p, origin));
        return dot(normal, normal);
    });
    const Point normal = cross(axis, minus(points[start[2]], origin));
    start[3] = find_largest(points, [&](const Point &p) { return std::fabs(dot(normal, minus(p, origin))); });
    return is_safe_start(given, points, start);
}

uint64_t mix_bits(uint64_t x) { // splitmix64's output step
    x = (x + 0x9e3779b97f4a7c15U);
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31);
}

// The place of a point with coordinates in [-1, 1] along a Morton curve, 20 bits an axis.
uint64_t curve_place(const Point &point) {
    uint64_t place = 0;
    for (int bit = 19; bit >= 0; --bit)
        for (double x : point) place = place << 1 | (static_cast<uint32_t>((x + 1) * 524287.5) >> bit & 1);
    return place;
}

// Biased randomized insertion order (Amenta, Choi, Rote, 2003): rounds of doubling size, each along a curve.
std::vector<int32_t> order_points(const std::vector<Point> &points, const std::array<size_t, 4> &start) {
    struct Rank {
        int round;
        uint64_t place;
    };
    std::vector<Rank> ranks(points.size());
    for (size_t i = 0; i < points.size(); ++i) {
        const uint64_t bits = mix_bits(i);
        ranks[i] = {bits ? -__builtin_ctzll(bits) : -64, curve_place(points[i])};
    }
    for (int k = 0; k < 4; ++k) ranks[start[k]] = {-100 + k, 0};
    std::vector<int32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int32_t a, int32_t b) {
        if (ranks[a].round != ranks[b].round) return ranks[a].round < ranks[b].round;
        return ranks[a].place != ranks[b].place ? ranks[a].place < ranks[b].place : a < b;
    });
    return order;
}

void tetrahedralize_ordered(const std::vector<Point> &points, const std::vector<int32_t> &order,
                            tetgenio &result) {
    tetgenio input;
    input.numberofpoints = static_cast<int>(points.size());
    input.pointlist = new double[3 * points.size()]; // freed by tetgenio
    for (size_t i = 0; i < order.size(); ++i)
        std::copy(points[order[i]].begin(), points[order[i]].end(), input.pointlist + 3 * i);
    tetgenbehavior behavior;
    behavior.quiet = 1;
    behavior.zeroindex = 1;
    behavior.no_sort = 1; // our order
    behavior.epsilon = 0; // and our first four points
    tetrahedralize(&behavior, &input, &result);
}

enf_status take_cells(const tetgenio &result, const std::vector<int32_t> &order, enf_tetrahedra *out,
                      enf_error *error) {
    const size_t count = static_cast<size_t>(std::max(result.numberoftetrahedra, 0));
    const enf_status status = enf::reserve_tetrahedra(count, out, error);
    if (status != ENF_OK) return status;
    for (size_t i = 0; i < count; ++i) {
        const int *corners = result.tetrahedronlist + static_cast<size_t>(result.numberofcorners) * i;
        for (int k = 0; k < 4; ++k) out->corners[i][k] = order[corners[k]];
    }
    out->count = count;
    return ENF_OK;
}

enf_status run_tetgen(const double *given, size_t point_count, enf_tetrahedra *out, enf_error *error) {
    const std::vector<Point> points = scale(given, point_count);
    std::array<size_t, 4> start;
    if (!find_start(given, points, start))
        return enf_fail(
            error, ENF_BAD_INPUT,
            "all points lie in one plane, or so nearly that TetGen cannot tell; use --tetrahedralizer cgal");
    const std::vector<int32_t> order = order_points(points, start);
    tetgenio result;
    const std::lock_guard<std::mutex> turn(turns);
    tetrahedralize_ordered(points, order, result);
    if (result.numberofpoints != static_cast<int>(points.size()) || result.numberofcorners != 4)
        return enf_fail(error, ENF_NO_RESOURCES, "TetGen gave %d points for %zu; use --tetrahedralizer cgal",
                        result.numberofpoints, points.size());
    const enf_status status = take_cells(result, order, out, error);
    if (status != ENF_OK) return status;
    const char *fault =
        enf::find_tiling_fault(points.size(), *out, [&](int32_t a, int32_t b, int32_t c, int32_t d) {
            return enf_points_orient(given + 3 * a, given + 3 * b, given + 3 * c, given + 3 * d);
        });
    if (fault)
        return enf_fail(error, ENF_NO_RESOURCES, "TetGen's result is wrong: %s; use --tetrahedralizer cgal",
                        fault);
    return ENF_OK;
}

} // namespace

extern "C" bool enf_shim_has_tetgen(void) {
    return true;
}

extern "C" enf_status enf_shim_delaunay_tetgen(const double *points, size_t point_count, enf_tetrahedra *out,
                                               enf_error *error) {
    enf_status status = ENF_NO_RESOURCES;
    *out = enf_tetrahedra{nullptr, 0};
    try {
        if (point_count > static_cast<size_t>(std::numeric_limits<int32_t>::max() / 4))
            return enf_fail(error, ENF_NO_RESOURCES, "%zu points are too many for TetGen; split the world",
                            point_count);
        if (point_count < 4)
            return enf_fail(error, ENF_BAD_INPUT, "all points lie in one plane; a world needs some volume");
        status = run_tetgen(points, point_count, out, error);
    } catch (const std::bad_alloc &) {
        status = enf_fail_memory(error, "the Delaunay tetrahedra (TetGen)");
    } catch (const std::exception &exception) {
        status = enf_fail(error, ENF_NO_RESOURCES, "TetGen failed: %s; use --tetrahedralizer cgal",
                          exception.what());
    } catch (int code) { // what TetGen throws
        status = enf_fail(error, ENF_NO_RESOURCES, "TetGen gave up with code %d; use --tetrahedralizer cgal",
                          code);
    } catch (...) {
        status = enf_fail(error, ENF_NO_RESOURCES, "TetGen failed; use --tetrahedralizer cgal");
    }
    if (status != ENF_OK) {
        std::free(out->corners);
        *out = enf_tetrahedra{nullptr, 0};
    }
    return status;
}
