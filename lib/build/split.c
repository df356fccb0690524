// SPDX-License-Identifier: GPL-3.0-or-later
// Tetrahedra are independent of each other here, so blocks of them are cut on several threads and put
// together in order afterwards: the result does not depend on the threads.
#include "build/split.h"

#include "base/array.h"
#include "base/parallel.h"
#include "build/split_tetrahedron.h"

#include <stdlib.h>
#include <string.h>

enum { BLOCK = 128 }; ///< tetrahedra a job

typedef struct split_all {
    const enf_arrangement *arrangement;
    enf_split_block *blocks;
    enf_splitter **splitters;
    bool *failed; ///< per block
} split_all;

static void split_job(void *user, int32_t index, int thread) {
    split_all *all = user;
    int32_t count = all->arrangement->tets.count,
            end = (index + 1) * BLOCK < count ? (index + 1) * BLOCK : count;
    for (int32_t t = index * BLOCK; t < end; t++) {
        if (!enf_splitter_cut(all->splitters[thread], &all->blocks[index], t)) {
            all->failed[index] = true;
            return;
        }
    }
}

/// Where a block's local numbers start in the whole.
typedef struct base {
    int32_t vertex, node, cell;
    size_t corner;
} base;

static bool allocate(enf_complex *complex, const enf_arrangement *arrangement, const enf_split_block *blocks,
                     int32_t block_count, size_t *crossing_count) {
    size_t nodes = 0, cells = 0, faces = 0, face_corners = 0, covers = 0, cover_corners = 0;
    *crossing_count = 0;
    for (int32_t b = 0; b < block_count; b++) {
        *crossing_count += blocks[b].crossing_count;
        nodes += blocks[b].node_count;
        cells += blocks[b].cell_count;
        faces += (size_t)blocks[b].faces.count;
        face_corners += blocks[b].faces.corner_count;
        covers += (size_t)blocks[b].covers.count;
        cover_corners += blocks[b].covers.corner_count;
    }
    size_t tets = (size_t)arrangement->tets.count, facets = (size_t)arrangement->tets.facet_count + nodes;
    if (faces > INT32_MAX || facets > INT32_MAX || *crossing_count > INT32_MAX / 2) return false;
    complex->tetrahedra = enf_array_new(tets, sizeof *complex->tetrahedra);
    complex->tetrahedron_root = enf_array_new(tets, sizeof *complex->tetrahedron_root);
    complex->node_plane = enf_array_new(nodes, sizeof *complex->node_plane);
    complex->node_child = enf_array_new(nodes, sizeof *complex->node_child);
    complex->node_facet = enf_array_new(nodes, sizeof *complex->node_facet);
    complex->cell_tetrahedron = enf_array_new(cells, sizeof *complex->cell_tetrahedron);
    complex->cell_face = enf_array_new(cells + 1, sizeof *complex->cell_face);
    complex->face_facet = enf_array_new(faces, sizeof *complex->face_facet);
    complex->face_side = enf_array_new(faces, sizeof *complex->face_side);
    complex->faces.offset = enf_array_new(faces + 1, sizeof *complex->faces.offset);
    complex->faces.corners = enf_array_new(face_corners, sizeof *complex->faces.corners);
    complex->facet_plane = enf_array_new(facets, sizeof *complex->facet_plane);
    complex->facet_hull = enf_array_zeroed(facets, sizeof *complex->facet_hull);
    complex->facet_cover = enf_array_zeroed(facets + 2, sizeof *complex->facet_cover);
    complex->covers.offset = enf_array_new(covers + 1, sizeof *complex->covers.offset);
    complex->covers.corners = enf_array_new(cover_corners, sizeof *complex->covers.corners);
    complex->cover_polygon = enf_array_new(covers, sizeof *complex->cover_polygon);
    complex->cover_side = enf_array_new(covers, sizeof *complex->cover_side);
    return complex->tetrahedra && complex->tetrahedron_root && complex->node_plane && complex->node_child &&
           complex->node_facet && complex->cell_tetrahedron && complex->cell_face && complex->face_facet &&
           complex->face_side && complex->faces.offset && complex->faces.corners && complex->facet_plane &&
           complex->facet_hull && complex->facet_cover && complex->covers.offset && complex->covers.corners &&
           complex->cover_polygon && complex->cover_side;
}

static int32_t whole_facet(const enf_arrangement *arrangement, const base *base, int32_t local) {
    return local >= 0 ? local : arrangement->tets.facet_count + base->node + (-1 - local);
}

static void copy_corners(enf_corner *to, const enf_loops *from, int32_t point_count, int32_t vertex_base) {
    for (size_t i = 0; i < from->corner_count; i++) {
        to[i] = from->corners[i];
        if (to[i].vertex >= point_count) to[i].vertex += vertex_base;
    }
}

/// Nodes, cells and faces of one block.
static void join_block(enf_complex *complex, const enf_arrangement *arrangement, const enf_split_block *block,
                       int32_t first_tetrahedron, base *base) {
    for (size_t i = 0; i < block->root_count; i++) {
        int32_t root = block->root[i];
        complex->tetrahedron_root[first_tetrahedron + (int32_t)i] =
            root >= 0 ? root + base->node : root - base->cell;
    }
    for (size_t i = 0; i < block->node_count; i++) {
        int32_t node = base->node + (int32_t)i;
        complex->node_plane[node] = block->node_plane[i];
        complex->node_facet[node] = arrangement->tets.facet_count + node;
        complex->facet_plane[complex->node_facet[node]] = block->node_plane[i];
        for (int k = 0; k < 2; k++) {
            int32_t child = block->node_child[i][k];
            complex->node_child[node][k] = child >= 0 ? child + base->node : child - base->cell;
        }
    }
    for (size_t i = 0; i < block->cell_count; i++) {
        complex->cell_tetrahedron[(size_t)base->cell + i] = block->cell_tetrahedron[i];
        complex->cell_face[(size_t)base->cell + i] = complex->faces.count + block->cell_face[i];
    }
    copy_corners(complex->faces.corners + complex->faces.corner_count, &block->faces,
                 arrangement->geometry.point_count, base->vertex);
    for (int32_t i = 0; i < block->faces.count; i++) {
        int32_t face = complex->faces.count + i;
        complex->faces.offset[face] = (int64_t)complex->faces.corner_count + block->faces.offset[i];
        complex->face_facet[face] = whole_facet(arrangement, base, block->face_facet[i]);
        complex->face_side[face] = block->face_side[i];
    }
    complex->faces.count += block->faces.count;
    complex->faces.corner_count += block->faces.corner_count;
    base->vertex += (int32_t)block->crossing_count;
    base->node += (int32_t)block->node_count;
    base->cell += (int32_t)block->cell_count;
}

/// Sorts the blocks' covers by facet; on one facet they stay in the order of tetrahedra and polygons.
static bool join_covers(enf_complex *complex, const enf_arrangement *arrangement,
                        const enf_split_block *blocks, int32_t block_count) {
    int32_t facets = complex->facet_count, point_count = arrangement->geometry.point_count;
    int32_t total = 0;
    for (int32_t b = 0; b < block_count; b++) total += blocks[b].covers.count;
    typedef struct where {
        int32_t block, cover, vertex_base;
    } where;
    where *order = enf_array_new((size_t)total, sizeof *order);
    int32_t *next = enf_array_zeroed((size_t)facets + 2, sizeof *next);
    if (!order || !next) {
        free(order);
        free(next);
        return false;
    }
    for (int pass = 0; pass < 2; pass++) {
        base base = {0};
        for (int32_t b = 0; b < block_count; b++) {
            for (int32_t i = 0; i < blocks[b].covers.count; i++) {
                int32_t facet = whole_facet(arrangement, &base, blocks[b].cover_facet[i]);
                if (pass == 0) {
                    next[facet + 2]++;
                } else {
                    order[next[facet + 1]++] = (where){b, i, base.vertex};
                }
            }
            base.node += (int32_t)blocks[b].node_count;
            base.vertex += (int32_t)blocks[b].crossing_count;
        }
        for (int32_t f = 0; pass == 0 && f < facets; f++) next[f + 2] += next[f + 1];
    }
    memcpy(complex->facet_cover, next, ((size_t)facets + 1) * sizeof *next);
    for (int32_t i = 0; i < total; i++) {
        const enf_split_block *block = &blocks[order[i].block];
        int64_t begin = block->covers.offset[order[i].cover], end = block->covers.offset[order[i].cover + 1];
        complex->covers.offset[i] = (int64_t)complex->covers.corner_count;
        enf_loops one = {.corners = block->covers.corners + begin, .corner_count = (size_t)(end - begin)};
        copy_corners(complex->covers.corners + complex->covers.corner_count, &one, point_count,
                     order[i].vertex_base);
        complex->covers.corner_count += one.corner_count;
        complex->cover_polygon[i] = block->cover_polygon[order[i].cover];
        complex->cover_side[i] = block->cover_side[order[i].cover];
    }
    complex->covers.count = total;
    complex->covers.offset[total] = (int64_t)complex->covers.corner_count;
    free(order);
    free(next);
    return true;
}

static bool join(enf_complex *complex, enf_arrangement *arrangement, const enf_split_block *blocks,
                 int32_t block_count, enf_crossing **crossings) {
    const enf_tet_mesh *tets = &arrangement->tets;
    size_t crossing_count;
    if (!allocate(complex, arrangement, blocks, block_count, &crossing_count)) return false;
    *crossings = enf_array_new(crossing_count, sizeof **crossings);
    if (!*crossings) return false;
    memcpy(complex->tetrahedra, tets->corners, (size_t)tets->count * sizeof *complex->tetrahedra);
    complex->tetrahedron_count = tets->count;
    for (int32_t f = 0; f < tets->facet_count; f++) {
        complex->facet_plane[f] = f;
        complex->facet_hull[f] = tets->facet_sides[f][0] < 0 || tets->facet_sides[f][1] < 0;
    }
    base base = {0};
    for (int32_t b = 0; b < block_count; b++) {
        const enf_split_block *block = &blocks[b];
        if (block->crossing_count) {
            memcpy(*crossings + base.vertex, block->crossings, block->crossing_count * sizeof **crossings);
        }
        complex->tetrahedra_cut += block->tetrahedra_cut;
        join_block(complex, arrangement, block, b * BLOCK, &base);
    }
    complex->node_count = base.node;
    complex->cell_count = base.cell;
    complex->cell_face[base.cell] = complex->faces.count;
    complex->faces.offset[complex->faces.count] = (int64_t)complex->faces.corner_count;
    complex->facet_count = tets->facet_count + base.node;
    complex->vertex_count = arrangement->geometry.point_count + base.vertex;
    return join_covers(complex, arrangement, blocks, block_count);
}

enf_status enf_complex_split(enf_complex *complex, enf_arrangement *arrangement, const enf_crew *crew,
                             enf_crossing **crossings, enf_error *error) {
    memset(complex, 0, sizeof *complex);
    *crossings = NULL;
    complex->points = arrangement->geometry.points;
    complex->point_count = arrangement->geometry.point_count;
    int threads = crew->threads;
    bool stopped = false;
    int32_t block_count = (arrangement->tets.count + BLOCK - 1) / BLOCK;
    split_all all = {.arrangement = arrangement,
                     .blocks = enf_array_zeroed((size_t)block_count, sizeof *all.blocks),
                     .splitters = enf_array_zeroed((size_t)threads, sizeof(enf_splitter *)),
                     .failed = enf_array_zeroed((size_t)block_count, sizeof *all.failed)};
    bool good = all.blocks && all.splitters && all.failed;
    for (int i = 0; good && i < threads; i++)
        good = (all.splitters[i] = enf_splitter_new(arrangement)) != NULL;
    if (good) {
        stopped = !enf_parallel_for(crew, block_count, split_job, &all);
        good = !stopped;
        for (int32_t b = 0; b < block_count; b++) good = good && !all.failed[b];
        good = good && join(complex, arrangement, all.blocks, block_count, crossings);
    }
    for (int i = 0; all.splitters && i < threads; i++) {
        if (all.splitters[i]) {
            enf_splitter_counts(all.splitters[i], &arrangement->geometry.decided_by_filter,
                                &arrangement->geometry.decided_exactly);
        }
        enf_splitter_free(all.splitters[i]);
    }
    for (int32_t b = 0; all.blocks && b < block_count; b++) enf_split_block_free(&all.blocks[b]);
    free(all.blocks);
    free(all.splitters);
    free(all.failed);
    if (good) return ENF_OK;
    free(*crossings);
    *crossings = NULL;
    enf_complex_free(complex);
    return stopped ? enf_fail(error, ENF_NO_RESOURCES, "cancelled")
                   : enf_fail_memory(error, "the fine cells");
}
