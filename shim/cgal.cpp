// SPDX-License-Identifier: GPL-3.0-or-later
// Delaunay tetrahedra by CGAL. Predicates are exact; cospherical points are broken by the symbolic
// perturbation of Devillers and Teillaud, "Perturbations for Delaunay and weighted Delaunay 3D
// triangulations" (2011), which orders points lexicographically and leaves no flat tetrahedra: the result
// depends on the set of points only. The only file that includes CGAL (heavy to compile).
#include "shim/cgal_traits.hpp"
#include "shim/shim.h"
#include "shim/tetrahedra.hpp"

extern "C" {
#include "base/timer.h"
}

#include <CGAL/Delaunay_triangulation_3.h>

#include <cfenv>
#include <cstdlib>
#include <exception>
#include <new>
#include <vector>

namespace {

using enf::Kernel;
using enf::NumberedPoint;
using Delaunay = CGAL::Delaunay_triangulation_3<enf::Traits>;

// CGAL's interval arithmetic rounds upwards while it works; whatever happens inside, the caller's mode comes
// back.
class RoundingMode {
  public:
    RoundingMode() : mode(std::fegetround()) { std::fesetround(FE_TONEAREST); }
    ~RoundingMode() { std::fesetround(mode); }
    RoundingMode(const RoundingMode &) = delete;
    RoundingMode &operator=(const RoundingMode &) = delete;

  private:
    int mode;
};

Delaunay triangulate(const double *points, size_t point_count) {
    std::vector<NumberedPoint> input;
    input.reserve(point_count);
    for (size_t i = 0; i < point_count; ++i) input.emplace_back(points + 3 * i, static_cast<int32_t>(i));
    return Delaunay(input.begin(), input.end());
}

enf_status take_cells(const Delaunay &delaunay, enf_tetrahedra *out, enf_error *error) {
    const enf_status status = enf::reserve_tetrahedra(delaunay.number_of_finite_cells(), out, error);
    if (status != ENF_OK) return status;
    for (auto cell : delaunay.finite_cell_handles()) {
        int32_t *corners = out->corners[out->count++];
        for (int k = 0; k < 4; ++k) corners[k] = cell->vertex(k)->point().number;
    }
    return ENF_OK;
}

enf_status run_cgal(const double *points, size_t point_count, enf_tetrahedra *out, enf_error *error) {
    if (point_count > INT32_MAX)
        return enf_fail(error, ENF_NO_RESOURCES,
                        "%zu points are more than CGAL's tetrahedralizer is given (%d); split the world",
                        point_count, INT32_MAX);
    const Delaunay delaunay = triangulate(points, point_count);
    if (delaunay.number_of_vertices() != point_count)
        return enf_fail(error, ENF_BAD_INPUT, "%zu of %zu points are equal to others; weld them first",
                        point_count - delaunay.number_of_vertices(), point_count);
    if (delaunay.dimension() < 3)
        return enf_fail(error, ENF_BAD_INPUT, "all points lie in one plane; a world needs some volume");
    return take_cells(delaunay, out, error);
}

} // namespace

extern "C" enf_status enf_shim_delaunay_time(const double *points, size_t point_count, double *seconds,
                                             size_t *tetrahedra, enf_error *error) {
    using Plain = CGAL::Delaunay_triangulation_3<Kernel>;
    const RoundingMode restore;
    try {
        std::vector<Kernel::Point_3> input;
        input.reserve(point_count);
        for (size_t i = 0; i < point_count; ++i)
            input.emplace_back(points[3 * i], points[3 * i + 1], points[3 * i + 2]);
        const double start = enf_timer_cpu();
        const Plain delaunay(input.begin(), input.end());
        *seconds = enf_timer_cpu() - start;
        *tetrahedra = delaunay.number_of_finite_cells();
        return ENF_OK;
    } catch (...) {
        return enf_fail(error, ENF_NO_RESOURCES, "CGAL's Delaunay failed");
    }
}

extern "C" enf_status enf_shim_delaunay_cgal(const double *points, size_t point_count, enf_tetrahedra *out,
                                             enf_error *error) {
    enf_status status = ENF_NO_RESOURCES;
    *out = enf_tetrahedra{nullptr, 0};
    const RoundingMode restore;
    try {
        status = run_cgal(points, point_count, out, error);
    } catch (const std::bad_alloc &) {
        status = enf_fail_memory(error, "the Delaunay tetrahedra (CGAL)");
    } catch (const std::exception &exception) {
        status = enf_fail(error, ENF_NO_RESOURCES, "CGAL's Delaunay failed: %s; try --tetrahedralizer tetgen",
                          exception.what());
    } catch (...) {
        status = enf_fail(error, ENF_NO_RESOURCES, "CGAL's Delaunay failed; try --tetrahedralizer tetgen");
    }
    if (status != ENF_OK) {
        std::free(out->corners);
        *out = enf_tetrahedra{nullptr, 0};
    }
    return status;
}
