// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/air_plane.h"

#include "base/array.h"
#include "base/parallel.h"
#include "visibility/window.h"

#include <math.h>
#include <stdlib.h>

/// How planes are chosen: of so many walls, the one whose plane costs least. (Found by trying, on levels: of
/// 15 come more openings, and more visits of beams; of 25 to 400 about the same.)
enum { CANDIDATES = 25 };
static const double cost_of_cut = 16, cost_of_imbalance = 0.2, worth_of_taken = 1;

/// Below this depth (where no building comes to) a part whose walls' planes would only peel it is halved.
enum { DEPTH_PEELED = 100, PEELED_MOST = 64 };
static const double peeled_share = 0.95;

/// Parts of fewer walls are not worth a second thread; nor are more than so many for the largest.
enum { SHARED_LEAST = 300, THREADS_MOST = 16 };

/// The walls of a part, by their sides of a plane.
typedef struct census {
    int32_t counts[4];
} census;

/// The best of some candidates.
typedef struct choice {
    enf_air_plane plane;
    census census;
    double cost; ///< infinity: there is none
    int32_t candidate;
} choice;

enf_air_side enf_air_plane_side(const enf_air_plane *plane, const enf_walls *walls, int32_t number,
                                double tolerance) {
    const enf_wall *wall = &walls->walls[number];
    const double height = enf_dot(wall->middle, plane->normal) - plane->offset;
    int sides = ENF_AIR_ON;
    if (fabs(height) > wall->radius + tolerance) return height > 0 ? ENF_AIR_FRONT : ENF_AIR_BACK;
    for (int32_t i = 0; i < wall->count && sides != ENF_AIR_BOTH; i++) {
        const double *corner = walls->corners[wall->first + i];
        sides |= (int)enf_air_side_of(enf_dot(corner, plane->normal) - plane->offset, tolerance);
    }
    return (enf_air_side)sides;
}

static enf_air_plane plane_of(const enf_wall *wall) {
    return (enf_air_plane){{wall->normal[0], wall->normal[1], wall->normal[2]}, wall->offset};
}

static census count_sides(const enf_air_part *part, const enf_air_plane *plane) {
    census census = {{0}};
    for (int32_t i = 0; i < part->count; i++)
        census.counts[enf_air_plane_side(plane, part->walls, part->items[i], part->tolerance)]++;
    return census;
}

// ---------------------------------------------------------------------------------------------- candidates

/// Is the plane one of some walls'?
static bool is_known(const enf_walls *walls, const enf_air_plane *plane, const int32_t *some, int32_t count) {
    for (int32_t k = 0; k < count; k++) {
        const enf_wall *wall = &walls->walls[some[k]];
        if (wall->offset == plane->offset && wall->normal[0] == plane->normal[0] &&
            wall->normal[1] == plane->normal[1] && wall->normal[2] == plane->normal[2])
            return true;
    }
    return false;
}

static double cost_of(const census *census) {
    return cost_of_cut * census->counts[ENF_AIR_BOTH] +
           cost_of_imbalance * abs(census->counts[ENF_AIR_FRONT] - census->counts[ENF_AIR_BACK]) -
           worth_of_taken * census->counts[ENF_AIR_ON];
}

/// Counts the sides of a plane, and finds its cost, if that is below `least`; false as soon as it can't be.
static bool find_cost(const enf_air_part *part, const enf_air_plane *plane, double least, census *census,
                      double *cost) {
    *census = (struct census){{0}};
    for (int32_t i = 0; i < part->count; i++) {
        const enf_air_side side = enf_air_plane_side(plane, part->walls, part->items[i], part->tolerance);
        census->counts[side]++;
        if (side == ENF_AIR_BOTH &&
            cost_of_cut * census->counts[ENF_AIR_BOTH] -
                    worth_of_taken * (census->counts[ENF_AIR_ON] + part->count - i - 1) >=
                least)
            return false;
    }
    *cost = cost_of(census);
    return *cost < least;
}

/// Of candidates `first`, `first + step` and so on the one that costs least, the first of several.
static choice try_some(const enf_air_part *part, int32_t first, int32_t step) {
    const int32_t tries = part->count < CANDIDATES ? part->count : CANDIDATES;
    int32_t tried[CANDIDATES], tried_count = 0;
    choice best = {.cost = INFINITY};
    for (int32_t k = first; k < tries; k += step) {
        const int32_t wall = part->items[(int64_t)k * part->count / tries];
        const enf_air_plane next = plane_of(&part->walls->walls[wall]);
        if (is_known(part->walls, &next, tried, tried_count)) continue;
        tried[tried_count++] = wall;
        census census;
        double cost;
        if (!find_cost(part, &next, best.cost, &census, &cost)) continue;
        best = (choice){next, census, cost, k};
    }
    return best;
}

typedef struct trial {
    const enf_air_part *part;
    int32_t count;
    choice choices[THREADS_MOST];
} trial;

static void try_share(void *user, int32_t share, int thread) {
    trial *trial = user;
    (void)thread;
    trial->choices[share] = try_some(trial->part, share, trial->count);
}

/// Of all candidates. Each thread has some of them; of equal ones the first wins, whoever had it.
static choice try_all(const enf_air_part *part, int threads) {
    trial trial = {.part = part, .count = threads < THREADS_MOST ? threads : THREADS_MOST};
    if (part->count < SHARED_LEAST || trial.count <= 1) return try_some(part, 0, 1);
    enf_parallel_for(&(enf_crew){.threads = trial.count}, trial.count, try_share, &trial);
    choice best = trial.choices[0];
    for (int32_t i = 1; i < trial.count; i++) {
        const choice *next = &trial.choices[i];
        if (next->cost < best.cost || (next->cost == best.cost && next->candidate < best.candidate))
            best = *next;
    }
    return best;
}

// ---------------------------------------------------------------------------------------------- halving

static int compare_doubles(const void *a, const void *b) {
    double one = *(const double *)a, other = *(const double *)b;
    return one < other ? -1 : one > other;
}

static const double *first_corner(const enf_air_part *part, int32_t i) {
    return part->walls->corners[part->walls->walls[part->items[i]].first];
}

static int find_longest_axis(const enf_air_part *part) {
    double least[3] = {INFINITY, INFINITY, INFINITY}, most[3] = {-INFINITY, -INFINITY, -INFINITY};
    int longest = 0;
    for (int32_t i = 0; i < part->count; i++)
        for (int axis = 0; axis < 3; axis++) {
            least[axis] = fmin(least[axis], first_corner(part, i)[axis]);
            most[axis] = fmax(most[axis], first_corner(part, i)[axis]);
        }
    for (int axis = 1; axis < 3; axis++)
        if (most[axis] - least[axis] > most[longest] - least[longest]) longest = axis;
    return longest;
}

/// A plane across the longest side of a part, through the median of the walls' first corners. False without
/// memory.
static bool halve(const enf_air_part *part, enf_air_plane *plane) {
    const int longest = find_longest_axis(part);
    double *along = enf_array_new((size_t)part->count, sizeof *along);
    if (!along) return false;
    for (int32_t i = 0; i < part->count; i++) along[i] = first_corner(part, i)[longest];
    qsort(along, (size_t)part->count, sizeof *along, compare_doubles);
    *plane = (enf_air_plane){.offset = along[part->count / 2]};
    plane->normal[longest] = 1;
    free(along);
    return true;
}

bool enf_air_plane_choose(const enf_air_part *part, int threads, enf_air_plane *plane) {
    const choice best = try_all(part, threads);
    const int32_t front = best.census.counts[ENF_AIR_FRONT], back = best.census.counts[ENF_AIR_BACK];
    *plane = best.plane;
    if (part->depth < DEPTH_PEELED || part->count <= PEELED_MOST ||
        (front > back ? front : back) <= peeled_share * part->count)
        return true;
    enf_air_plane middle;
    if (!halve(part, &middle)) return false;
    const census census = count_sides(part, &middle);
    if (census.counts[ENF_AIR_FRONT] > part->count / 4 && census.counts[ENF_AIR_BACK] > part->count / 4)
        *plane = middle; // it takes walls out of the way
    return true;
}
