// SPDX-License-Identifier: GPL-3.0-or-later
// Nearly all memory goes to the fine cells: as many as there are tetrahedra, and more where polygons cut
// them. Cuts show as soon as there are tetrahedra: polygons whose triangles are missing among the faces. Some
// are missing without harm, because the other diagonal of flat quadrangles was taken. So the estimate has a
// term for each, and the constants are measured: `enfilade bench memory DIR` prints estimates beside the
// truth, and the two constants that fit best.
#include "build/memory_estimate.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/// Fitted over 25 Quake levels and offices of 50 thousand to 10 million polygons; the fourth leans upwards.
static const double program_bytes = 6e6;         ///< the program itself, and small things
static const double tetrahedra_per_point = 5.9;  ///< of points on surfaces; 4.8 to 6.3 were seen
static const double bytes_per_tetrahedron = 530; ///< with all that is kept of points and polygons
static const double bytes_per_cut = 3500;  ///< per triangle missing: the cells and facets that come of it
static const double harmless_share = 0.14; ///< missing triangles per tetrahedron where nothing is cut
/// Gaps between arrays, and ends of arrays that nothing is written to, as a share of the heap; and what lies
/// in the heap at most: large arrays beyond that are maps of their own (cli/heap.h).
static const double heap_share = 0.12, heap_bytes = 0x1p31;

enf_memory_counts enf_memory_count(const enf_soup *soup, const enf_mesh *mesh) {
    return (enf_memory_counts){
        .soup_points = soup->point_count,
        .soup_polygons = soup->polygon_count,
        .soup_corners = soup->polygon_corner ? (uint64_t)soup->polygon_corner[soup->polygon_count] : 0,
        .points = mesh->point_count,
        .polygons = mesh->polygon_count,
        .corners = mesh->polygon_corner ? (uint64_t)mesh->polygon_corner[mesh->polygon_count] : 0,
    };
}

/// Triangles of the fan from corner `apex` that are no faces of tetrahedra.
static uint64_t count_missing(const enf_tet_mesh *tets, const int32_t *corners, int64_t count, int64_t apex) {
    uint64_t missing = 0;
    for (int64_t k = 1; k + 1 < count; k++)
        missing += enf_tet_mesh_facet(tets, corners[apex], corners[(apex + k) % count],
                                      corners[(apex + k + 1) % count]) < 0;
    return missing;
}

void enf_memory_count_tetrahedra(enf_memory_counts *counts, const enf_mesh *mesh, const enf_tet_mesh *tets) {
    counts->tetrahedra = (uint64_t)tets->count;
    counts->missing = 0;
    for (size_t p = 0; p < mesh->polygon_count; p++) {
        const int32_t *corners = mesh->corners + mesh->polygon_corner[p];
        int64_t count = mesh->polygon_corner[p + 1] - mesh->polygon_corner[p];
        uint64_t fewest = count_missing(tets, corners, count, 0);
        if (fewest > 0 && count == 4) { // the other diagonal
            uint64_t other = count_missing(tets, corners, count, 1);
            if (other < fewest) fewest = other;
        }
        counts->missing += fewest;
    }
}

double enf_memory_cuts(const enf_memory_counts *counts) {
    return fmax(0, (double)counts->missing - harmless_share * (double)counts->tetrahedra);
}

uint64_t enf_memory_estimate(const enf_memory_counts *counts) {
    double tetrahedra = (double)counts->tetrahedra;
    if (counts->tetrahedra == 0) tetrahedra = tetrahedra_per_point * (double)counts->points;
    double arrays = bytes_per_tetrahedron * tetrahedra + bytes_per_cut * enf_memory_cuts(counts);
    return (uint64_t)(program_bytes + arrays + heap_share * fmin(arrays, heap_bytes));
}

/// Planes are numbered with 32 bits: one per face of the tetrahedra, polygon and corner.
static bool can_be_numbered(const enf_memory_counts *counts) {
    double tetrahedra = (double)counts->tetrahedra;
    if (counts->tetrahedra == 0) tetrahedra = tetrahedra_per_point * (double)counts->points;
    double planes = 2 * tetrahedra + (double)counts->polygons + (double)counts->corners;
    return counts->soup_points < INT32_MAX && counts->soup_polygons < INT32_MAX &&
           counts->points < INT32_MAX && counts->polygons < INT32_MAX && tetrahedra < INT32_MAX / 8 &&
           planes < INT32_MAX;
}

/// "16.4 GiB"
static void print_bytes(uint64_t bytes, char text[32]) {
    static const char *const units[] = {"bytes", "KiB", "MiB", "GiB", "TiB"};
    double value = (double)bytes;
    int unit = 0;
    while (value >= 1024 && unit < 4) value /= 1024, unit++;
    snprintf(text, 32, "%.3g %s", value, units[unit]);
}

enf_memory_allowance enf_memory_allow(uint64_t bytes) {
    enf_memory_allowance allowed = {bytes, "--memory"};
    if (bytes == 0) allowed.bytes = enf_memory_limit(&allowed.limiter);
    return allowed;
}

enf_status enf_memory_admit(const enf_memory_counts *counts, enf_memory_allowance allowed, enf_error *error) {
    if (!can_be_numbered(counts))
        return enf_fail(error, ENF_NO_RESOURCES,
                        "%llu polygons with %llu points are more than this build can number; cut the world "
                        "into parts",
                        (unsigned long long)counts->polygons, (unsigned long long)counts->points);
    uint64_t needed = enf_memory_estimate(counts);
    if (needed <= allowed.bytes) return ENF_OK;
    char need[32], have[32];
    print_bytes(needed, need);
    print_bytes(allowed.bytes, have);
    return enf_fail(
        error, ENF_NO_RESOURCES,
        "this world of %llu polygons will need about %s of memory, and %s allows %s; use a larger "
        "machine, allow more (--memory SIZE), leave parts of the world out (--exclude) or make "
        "small things detail (--detail)",
        (unsigned long long)counts->polygons, need, allowed.limiter, have);
}

bool enf_memory_parse(const char *text, uint64_t *bytes) {
    uint64_t value = 0;
    const char *at = text;
    for (; *at >= '0' && *at <= '9'; at++) {
        uint64_t digit = (uint64_t)(*at - '0');
        if (value > (UINT64_MAX - digit) / 10) return false;
        value = 10 * value + digit;
    }
    if (at == text || value == 0) return false;
    static const char letters[] = "KMGT";
    int shift = 0;
    for (int i = 0; letters[i]; i++)
        if (*at == letters[i]) shift = 10 * (i + 1);
    if (shift > 0) at++;
    if (*at || value > UINT64_MAX >> shift) return false;
    *bytes = value << shift;
    return true;
}
