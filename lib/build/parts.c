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

/// While the parts are made. Most tetrahedra and facets of a finely drawn world are in none: those that are
/// get numbers of their own, in the same order.
typedef struct divider {
    const enf_arrangement *arrangement;
    const enf_candidates *candidates;
    enf_parts *parts;
    int32_t *entered; ///< the tetrahedra that polygons enter
    int32_t entered_count;
    bool have_long; ///< there are polygons with many edges; mostly there are none, and none need be looked up
    int32_t *facets; ///< the marked facets
    int32_t facet_count;
    int32_t *block_first; ///< per block of facets, and one more: the number of its first marked facet
    int32_t *group;       ///< per tetrahedron that is entered: see base/sets.h
    int32_t *work;        ///< per tetrahedron that is entered: of the group that it stands for
    int32_t *group_part; ///< per tetrahedron that is entered: the part of the group that it stands for, or -1
    int32_t *facet_part; ///< per marked facet
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

/// Polygons that may cut a tetrahedron.
static int32_t cuts_of(const divider *d, int32_t t) {
    return t < 0 ? 0 : d->candidates->offset[t + 1] - d->candidates->offset[t];
}

/// Offsets from numbers per part or block, which are at offset[index + 1].
static void add_up(int32_t *offset, int32_t count) {
    for (int32_t i = 0; i < count; i++) offset[i + 1] += offset[i];
}

// ---------------------------------------------------------------------------------------------- contents

/// Numbers the tetrahedra that polygons enter. False without memory.
static bool number_entered(divider *d) {
    int32_t tets = d->arrangement->tets.count;
    int32_t *number = d->parts->cell_of = enf_array_new((size_t)tets, sizeof *number);
    if (!number) return false;
    for (int32_t t = 0; t < tets; t++) number[t] = cuts_of(d, t) ? d->entered_count++ : -1;
    return true;
}

/// Does the polygon have so many edges that it is not known which are near?
static bool is_long(const divider *d, size_t polygon) {
    const int64_t *corner = d->arrangement->mesh->polygon_corner;
    return corner[polygon + 1] - corner[polygon] > ENF_LINES_FEW;
}

static bool have_long(const divider *d) {
    for (size_t p = 0; p < d->arrangement->mesh->polygon_count; p++) {
        if (is_long(d, p)) return true;
    }
    return false;
}

/// A polygon on the facet that may end there, or has so many edges that this is not known.
static bool has_edge(const divider *d, int32_t facet) {
    const enf_arrangement *arrangement = d->arrangement;
    for (int32_t i = arrangement->hit_first[facet]; i < arrangement->hit_first[facet + 1]; i++) {
        const enf_hit *hit = &arrangement->hits[i];
        if (hit->lines || (d->have_long && is_long(d, (size_t)hit->polygon))) return true;
    }
    return false;
}

static int32_t block_end(const divider *d, int32_t block) {
    int32_t begin = block * BLOCK, left = d->arrangement->tets.facet_count - begin;
    return begin + (left < BLOCK ? left : BLOCK);
}

/// Marks the facets of a block, and counts them.
static void mark_block(void *user, int32_t block, int thread) {
    (void)thread;
    const divider *d = user;
    int32_t count = 0; // here: threads that write close to each other wait for each other
    for (int32_t f = block * BLOCK; f < block_end(d, block); f++) {
        const int32_t *sides = d->arrangement->tets.facet_sides[f];
        bool marked = cuts_of(d, sides[0]) || cuts_of(d, sides[1]) || has_edge(d, f);
        d->parts->marked[f] = marked;
        count += marked;
    }
    d->block_first[block + 1] = count;
}

/// Marks facets and counts them. False without memory.
static bool mark_facets(divider *d, const enf_crew *crew) {
    int32_t facets = d->arrangement->tets.facet_count, blocks = facets / BLOCK + 1;
    d->parts->marked = enf_array_new((size_t)facets, sizeof *d->parts->marked);
    d->block_first = enf_array_zeroed((size_t)blocks + 1, sizeof *d->block_first);
    if (!d->parts->marked || !d->block_first) return false;
    d->have_long = have_long(d);
    enf_parallel_for(crew, blocks, mark_block, d);
    add_up(d->block_first, blocks);
    d->facet_count = d->block_first[blocks];
    return true;
}

/// What stays comes before what does not, so that the latter leaves no gaps in memory. False without any.
static bool make_room(divider *d) {
    size_t tetrahedra = (size_t)d->entered_count, facets = (size_t)d->facet_count;
    return (d->parts->tetrahedra = enf_array_new(tetrahedra, sizeof *d->parts->tetrahedra)) &&
           (d->parts->facets = enf_array_new(facets, sizeof *d->parts->facets)) &&
           (d->entered = enf_array_new(tetrahedra, sizeof *d->entered)) &&
           (d->facets = enf_array_new(facets, sizeof *d->facets)) &&
           (d->group = enf_array_new(tetrahedra, sizeof *d->group)) &&
           (d->work = enf_array_zeroed(tetrahedra, sizeof *d->work)) &&
           (d->group_part = enf_array_new(tetrahedra, sizeof *d->group_part)) &&
           (d->facet_part = enf_array_new(facets, sizeof *d->facet_part));
}

static void list_block(void *user, int32_t block, int thread) {
    (void)thread;
    const divider *d = user;
    int32_t at = d->block_first[block];
    for (int32_t f = block * BLOCK; f < block_end(d, block); f++) {
        if (d->parts->marked[f]) d->facets[at++] = f;
    }
}

/// What has been numbered and counted, in order.
static void list_all(divider *d, const enf_crew *crew) {
    const int32_t *number = d->parts->cell_of;
    for (int32_t t = 0; t < d->arrangement->tets.count; t++) {
        if (number[t] >= 0) d->entered[number[t]] = t;
    }
    enf_parallel_for(crew, d->arrangement->tets.facet_count / BLOCK + 1, list_block, d);
}

// ---------------------------------------------------------------------------------------------- which part

/// The tetrahedron whose group a marked facet goes with, as a number among those that are entered, or -1: it
/// goes alone.
static int32_t owner(const divider *d, int32_t facet) {
    const int32_t *sides = d->arrangement->tets.facet_sides[facet], *number = d->parts->cell_of;
    int32_t first = sides[0] < 0 ? -1 : number[sides[0]];
    return first >= 0 || sides[1] < 0 ? first : number[sides[1]];
}

/// Groups tetrahedra and adds up their work.
static void group_all(const divider *d) {
    int32_t count = d->entered_count, *group = d->group, *work = d->work;
    enf_sets_start(group, count);
    for (int32_t i = 0; i < d->facet_count; i++) {
        const int32_t *sides = d->arrangement->tets.facet_sides[d->facets[i]], *number = d->parts->cell_of;
        int32_t one = owner(d, d->facets[i]);
        if (one < 0) continue;
        work[one]++;
        if (cuts_of(d, sides[0]) && cuts_of(d, sides[1]))
            enf_sets_unite(group, number[sides[0]], number[sides[1]]);
    }
    for (int32_t i = count - 1; i >= 0; i--) { // the one that stands for its group comes last
        work[i] += cuts_of(d, d->entered[i]);
        int32_t root = enf_sets_find(group, i);
        if (root != i) work[root] += work[i];
    }
}

/// Exchanges the numbers of a part and of the first.
static void put_first(int32_t *parts, int32_t count, int32_t part) {
    for (int32_t i = 0; i < count; i++) parts[i] = parts[i] == part ? 0 : parts[i] == 0 ? part : parts[i];
}

/// Puts groups, and facets that go alone, into parts: those that follow each other into the same. The part
/// with the most work comes first.
static void fill_parts(const divider *d) {
    int32_t *group_part = d->group_part, *facet_part = d->facet_part;
    int64_t work = 0, most = -1;
    int32_t part = 0, heaviest = 0;
    memset(group_part, 0xff, (size_t)d->entered_count * sizeof *group_part); // -1
    for (int32_t i = 0; i < d->facet_count; i++) {
        int32_t one = owner(d, d->facets[i]), root = one < 0 ? -1 : enf_sets_find(d->group, one);
        if (root >= 0 && group_part[root] >= 0) {
            facet_part[i] = group_part[root];
            continue;
        }
        if (work >= PART_WORK) {
            part++;
            work = 0;
        }
        facet_part[i] = part;
        if (root >= 0) group_part[root] = part;
        work += root < 0 ? 1 : d->work[root];
        if (work > most) {
            most = work;
            heaviest = part;
        }
    }
    d->parts->count = part + 1;
    put_first(group_part, d->entered_count, heaviest);
    put_first(facet_part, d->facet_count, heaviest);
}

// ---------------------------------------------------------------------------------------------- lists

/// The part's tetrahedra, each with its number there. False without memory.
static bool list_tetrahedra(const divider *d) {
    enf_parts *parts = d->parts;
    int32_t *first = parts->tetrahedron_first = enf_array_zeroed((size_t)parts->count + 2, sizeof *first);
    parts->cuts = enf_array_zeroed((size_t)parts->count, sizeof *parts->cuts);
    if (!first || !parts->cuts) return false;
    for (int32_t i = 0; i < d->entered_count; i++) first[d->group_part[enf_sets_find(d->group, i)] + 2]++;
    add_up(first + 1, parts->count);
    for (int32_t i = 0; i < d->entered_count; i++) {
        int32_t t = d->entered[i], part = d->group_part[enf_sets_find(d->group, i)];
        parts->tetrahedra[first[part + 1]++] = t;
        parts->cuts[part] += (size_t)cuts_of(d, t);
    }
    for (int32_t part = 0; part < parts->count; part++) {
        for (int32_t i = first[part]; i < first[part + 1]; i++)
            parts->cell_of[parts->tetrahedra[i]] = i - first[part];
    }
    return true;
}

static bool list_facets(const divider *d) {
    enf_parts *parts = d->parts;
    int32_t *first = parts->facet_first = enf_array_zeroed((size_t)parts->count + 2, sizeof *first);
    if (!first) return false;
    for (int32_t i = 0; i < d->facet_count; i++) first[d->facet_part[i] + 2]++;
    add_up(first + 1, parts->count);
    for (int32_t i = 0; i < d->facet_count; i++) parts->facets[first[d->facet_part[i] + 1]++] = d->facets[i];
    return true;
}

bool enf_parts_make(enf_parts *parts, const enf_arrangement *arrangement, const enf_candidates *candidates,
                    int threads) {
    const enf_crew crew = {.threads = threads};
    memset(parts, 0, sizeof *parts);
    divider d = {.arrangement = arrangement, .candidates = candidates, .parts = parts};
    bool good = number_entered(&d) && mark_facets(&d, &crew) && make_room(&d);
    if (good) {
        list_all(&d, &crew);
        group_all(&d);
        fill_parts(&d);
        good = list_facets(&d) && list_tetrahedra(&d); // the last: it numbers tetrahedra anew
    }
    free(d.entered);
    free(d.facets);
    free(d.block_first);
    free(d.group);
    free(d.work);
    free(d.group_part);
    free(d.facet_part);
    return good;
}
