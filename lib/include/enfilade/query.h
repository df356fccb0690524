// SPDX-License-Identifier: MIT
// What a sphere or a box touches: the cells that it reaches through portals, and the triangles of these cells
// that it meets. These are the candidates of a collision test.
//
// A query begins in the cell that holds the centre and goes on through every portal that the shape meets
// (a flood over the graph of cells: the thesis, 3.3.4). What lies near but behind a wall is not found,
// which is the point: nothing of the next room bothers a body that cannot get there. The answer may hold more
// than a body can touch, because a cell may be concave: a portal counts when the shape meets it, also where a
// wall of the same cell stands between it and the centre. It never holds less: a shape that touches a portal
// within rounding meets it.
//
// Threads: a query object holds the scratch memory of one thread; every thread makes its own, once. No call
// but enf_query_create takes memory. Doors may be set meanwhile (see instance.h).
#ifndef ENFILADE_QUERY_H
#define ENFILADE_QUERY_H

#include "enfilade/instance.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum enf_shape_kind { ENF_SHAPE_SPHERE = 0, ENF_SHAPE_BOX } enf_shape_kind;

/// A sphere, or a box with edges parallel to the axes of the world. World units. A radius and halves may be
/// 0: a point, a stick or a plate.
typedef struct enf_shape {
    enf_shape_kind kind;
    double centre[3];
    double radius;  ///< of a sphere, >= 0
    double half[3]; ///< of a box: half its length along each axis, >= 0
} enf_shape;

/// Options of a query object; null or all zero but `size` is the default.
typedef struct enf_query_options {
    size_t size;         ///< sizeof(enf_query_options)
    int32_t cells_max;   ///< cells of one answer, images counted apart; 0: those of the world and 1024 more
    int32_t images_max;  ///< images of the shape through transforming portals; 0: 64
    bool skip_triangles; ///< takes no memory for enf_query_triangles, which then finds none
} enf_query_options;

typedef struct enf_query enf_query;

/// The world must stay open as long as the object lives. Takes 20 bytes for each cell and 4 for each
/// triangle. ENF_BAD_USAGE for options out of range, ENF_NO_RESOURCES without memory.
ENF_API enf_status enf_query_create(enf_query **query, const enf_world *world,
                                    const enf_query_options *options, enf_error *error);

/// Null is fine.
ENF_API void enf_query_free(enf_query *query);

/// A cell that the shape reaches.
typedef struct enf_reached {
    int32_t cell;
    int32_t portal; ///< through which it was reached first; -1: it is where the query began
    int32_t image;  ///< of the shape that reaches it: enf_query_image. 0: the shape itself
} enf_reached;

/// What an answer is like.
typedef struct enf_reach {
    int32_t count;  ///< cells reached, also those beyond the caller's capacity
    int32_t images; ///< at least 1 unless count is 0
    bool complete;  ///< false: the object's cells_max or images_max ended the search
} enf_reach;

/// Lists the cells that a shape reaches, nearest first by the number of portals; cells equally far come in
/// the order of the portals. `start` is the cell that holds the centre, or -1: it is searched for. The answer
/// is empty if the centre lies in no cell. Without an instance all portals are open; a door that is partly
/// open is passed where the shape meets its open part.
///
/// Behind a transforming portal the shape goes on as its image: a sphere as the sphere around its image, a
/// box as the box around its image. The same cell may be reached by several images and is then listed once
/// for each, unless the new image lies within one that is listed already.
///
/// At most `capacity` cells are written to `out`, which may be null if that is 0. ENF_BAD_USAGE for a shape
/// that is not finite or has a negative size, and for a `start` that the world does not have; *reach is then
/// empty.
ENF_API enf_status enf_query_cells(enf_query *query, const enf_instance *instance, int32_t start,
                                   const enf_shape *shape, enf_reached *out, int32_t capacity,
                                   enf_reach *reach, enf_error *error);

/// The shape behind transforming portals.
typedef struct enf_image {
    double matrix[12]; ///< 3 x 4, row by row: from where the query began to where the image is
    enf_shape shape;
} enf_image;

/// An image of the latest answer; all zero if there is no such image.
ENF_API enf_image enf_query_image(const enf_query *query, int32_t image);

/// A triangle that the shape meets.
typedef struct enf_touched {
    int32_t triangle;
    int32_t image; ///< that meets it
} enf_touched;

/// The triangles of the latest answer's cells that the shape meets, also of those cells that did not fit into
/// the caller's list. These are the triangles that the cells list: whose front they see, and detail near
/// them. Each is listed once for each image; images in order, then cells as they were reached, then as the
/// cell lists them. Writes at most `capacity` to `out`, which may be null if that is 0, and returns how many
/// there are.
ENF_API int64_t enf_query_triangles(enf_query *query, enf_touched *out, int64_t capacity);

#ifdef __cplusplus
}
#endif
#endif
