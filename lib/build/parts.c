// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/parts.h"

#include "base/array.h"
#include "base/sets.h"
#include "build/polygon_lines.h"

#include <stdlib.h>
#include <string.h>

/// A part has at least this much to do, if the world has; a unit is about a facet. Smaller parts cost more to
/// begin and to put together than a second thread saves.
enum { PART_WORK = 1 << 15 };

enum { BLOCK = 1 << 14 }; ///< facets a job

/// While the parts are made.
typedef struct divider {
    const enf_arrangement *arrangement;
    const enf_candidates *candidates;
    enf_parts *parts;
    int32_t *group; ///< per tetrahedron: see base/sets.h
    int32_t *work;  ///< per tetrahedron: of the group that it stands for, and of facets that are left to it
    int32_t *at;    ///< per tetrahedron: the part of that work
    int32_t *part;  ///< per tetrahedron: its own part
} divider;

void enf_parts_free(enf_parts *parts) {
    free(parts->cell_of);
    free(parts->tetrahedron_first);
    free(parts->tetrahedra);
    free(parts->facet_first);
    free(parts->facets);
    free(parts->cuts);
    free(parts->marked);
    memset(parts, 0, sizeof *parts);
}

enf_tet_part enf_parts_at(const enf_parts *parts, int32_t part) {
    int32_t t = parts->tetrahedron_first[part], f = parts->facet_first[part];
    return (enf_tet_part){.tetrahedron_count = parts->tetrahedron_first[part + 1] - t,
                          .facet_count = parts->facet_first[part + 1] - f,
                          .tetrahedra = parts->tetrahedra + t,
                          .facets = parts->facets + f,
                          .cell_of = parts->cell_of};
}

static int32_t cuts_of(const divider *d, int32_t t) {
    return t < 0 ? 0 : d->candidates->offset[t + 1] - d->candidates->offset[t];
}

/// A polygon on the facet that may end there, or has so many edges that this is not known.
static bool has_edge(const divider *d, int32_t facet) {
    const enf_arrangement *arrangement = d->arrangement;
    const int64_t *corner = arrangement->mesh->polygon_corner;
    for (int32_t i = arrangement->hit_first[facet]; i < arrangement->hit_first[facet + 1]; i++) {
        const enf_hit *hit = &arrangement->hits[i];
        if (hit->lines || corner[hit->polygon + 1] - corner[hit->polygon] > ENF_LINES_FEW) return true;
    }
    return false;
}

/// The tetrahedron whose group a facet goes with.
static int32_t owner(const divider *d, const int32_t sides[2]) {
    if (cuts_of(d, sides[0])) return sides[0];
    return cuts_of(d, sides[1]) || sides[0] < 0 ? sides[1] : sides[0];
}

/// Marks the facets of a block.
static void mark_block(void *user, int32_t block, int thread) {
    (void)thread;
    const divider *d = user;
    const enf_tet_mesh *tets = &d->arrangement->tets;
    int32_t begin = block * BLOCK, left = tets->facet_count - begin,
            end = begin + (left < BLOCK ? left : BLOCK);
    for (int32_t f = begin; f < end; f++) {
        const int32_t *sides = tets->facet_sides[f];
        d->parts->marked[f] = cuts_of(d, sides[0]) || cuts_of(d, sides[1]) || has_edge(d, f);
    }
}

/// Groups tetrahedra and adds up their work.
static void group_all(const divider *d) {
    const enf_tet_mesh *tets = &d->arrangement->tets;
    enf_sets_start(d->group, tets->count);
    for (int32_t f = 0; f < tets->facet_count; f++) {
        if (!d->parts->marked[f]) continue;
        const int32_t *sides = tets->facet_sides[f];
        if (cuts_of(d, sides[0]) && cuts_of(d, sides[1])) enf_sets_unite(d->group, sides[0], sides[1]);
        d->work[owner(d, sides)]++;
    }
    for (int32_t t = tets->count - 1; t >= 0; t--) { // the one that stands for its group comes last
        d->work[t] += cuts_of(d, t);
        int32_t root = enf_sets_find(d->group, t);
        if (root == t) continue;
        d->work[root] += d->work[t];
        d->work[t] = 0;
    }
}

/// Puts what follows each other into parts. Returns the part with the most work.
static int32_t fill_parts(const divider *d) {
    int64_t work = 0, most = -1;
    int32_t part = 0, heaviest = 0;
    for (int32_t t = 0; t < d->arrangement->tets.count; t++) {
        if (work >= PART_WORK) {
            part++;
            work = 0;
        }
        d->at[t] = part;
        work += d->work[t];
        if (work > most) {
            most = work;
            heaviest = part;
        }
    }
    d->parts->count = part + 1;
    return heaviest;
}

/// Every tetrahedron's own part; the heaviest comes first, in exchange for the first.
static void settle_parts(const divider *d, int32_t heaviest) {
    for (int32_t t = 0; t < d->arrangement->tets.count; t++) {
        int32_t part = d->at[enf_sets_find(d->group, t)];
        d->part[t] = part == heaviest ? 0 : part == 0 ? heaviest : part;
    }
}

/// Offsets from numbers per part, which are at offset[part + 1].
static void add_up(int32_t *offset, int32_t count) {
    for (int32_t i = 0; i < count; i++) offset[i + 1] += offset[i];
}

static bool list_tetrahedra(const divider *d) {
    enf_parts *parts = d->parts;
    int32_t tets = d->arrangement->tets.count, count = parts->count;
    int32_t *first = parts->tetrahedron_first = enf_array_zeroed((size_t)count + 2, sizeof *first);
    parts->cuts = enf_array_zeroed((size_t)count, sizeof *parts->cuts);
    if (!first || !parts->cuts) return false;
    for (int32_t t = 0; t < tets; t++) {
        if (cuts_of(d, t)) first[d->part[t] + 2]++;
    }
    add_up(first + 1, count);
    parts->tetrahedra = enf_array_new((size_t)first[count + 1], sizeof *parts->tetrahedra);
    if (!parts->tetrahedra) return false;
    for (int32_t t = 0; t < tets; t++) {
        parts->cell_of[t] = -1;
        if (!cuts_of(d, t)) continue;
        parts->tetrahedra[first[d->part[t] + 1]++] = t;
        parts->cuts[d->part[t]] += (size_t)cuts_of(d, t);
    }
    for (int32_t part = 0; part < count; part++) {
        for (int32_t i = first[part]; i < first[part + 1]; i++)
            parts->cell_of[parts->tetrahedra[i]] = i - first[part];
    }
    return true;
}

static bool list_facets(const divider *d) {
    enf_parts *parts = d->parts;
    const enf_tet_mesh *tets = &d->arrangement->tets;
    int32_t *first = parts->facet_first = enf_array_zeroed((size_t)parts->count + 2, sizeof *first);
    if (!first) return false;
    for (int32_t f = 0; f < tets->facet_count; f++) {
        if (parts->marked[f]) first[d->part[owner(d, tets->facet_sides[f])] + 2]++;
    }
    add_up(first + 1, parts->count);
    parts->facets = enf_array_new((size_t)first[parts->count + 1], sizeof *parts->facets);
    if (!parts->facets) return false;
    for (int32_t f = 0; f < tets->facet_count; f++) {
        if (parts->marked[f]) parts->facets[first[d->part[owner(d, tets->facet_sides[f])] + 1]++] = f;
    }
    return true;
}

bool enf_parts_make(enf_parts *parts, const enf_arrangement *arrangement, const enf_candidates *candidates,
                    int threads) {
    const enf_crew crew = {.threads = threads};
    size_t count = (size_t)arrangement->tets.count;
    memset(parts, 0, sizeof *parts);
    divider d = {.arrangement = arrangement, .candidates = candidates, .parts = parts};
    d.group = enf_array_new(count, sizeof *d.group);
    d.work = enf_array_zeroed(count, sizeof *d.work);
    d.at = enf_array_new(count, sizeof *d.at);
    d.part = enf_array_new(count, sizeof *d.part);
    parts->cell_of = enf_array_new(count, sizeof *parts->cell_of);
    parts->marked = enf_array_new((size_t)arrangement->tets.facet_count, sizeof *parts->marked);
    bool good = d.group && d.work && d.at && d.part && parts->cell_of && parts->marked;
    if (good) {
        enf_parallel_for(&crew, arrangement->tets.facet_count / BLOCK + 1, mark_block, &d);
        group_all(&d);
        settle_parts(&d, fill_parts(&d));
        good = list_tetrahedra(&d) && list_facets(&d);
    }
    free(d.group);
    free(d.work);
    free(d.at);
    free(d.part);
    return good;
}
