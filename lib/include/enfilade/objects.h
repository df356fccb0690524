// SPDX-License-Identifier: MIT
// Moving objects: which of them are in a cell, and in which cells one is. Every cell has a list of the
// objects that touch it, so that what a traversal finds visible is drawn, and nothing else is looked at (the
// thesis, 3.3.4): enf_objects_in_view. An object is a sphere or a box; it is in all cells that
// enf_query_cells finds for that shape in the world as it was compiled. Doors and transforms do not matter
// here: an object that stands in a doorway is in both rooms, and the door decides what is seen of them. So
// the lists never grow stale when a door moves.
//
// Two lists belong to no cell. ENF_LIST_NOWHERE holds the objects whose centre lies in no cell;
// ENF_LIST_EVERYWHERE those that touch more cells than there were links left for. The latter are part of
// every answer of enf_objects_in_cells: nothing is lost, it only becomes slower.
//
// Threads: calls that take a const enf_objects may run on any number of threads. Those that change objects
// need them alone: no other call on the same objects at the same time (a caller's lock for readers and
// writers does it). Doors of an instance may move meanwhile. No call but enf_objects_create takes memory.
#ifndef ENFILADE_OBJECTS_H
#define ENFILADE_OBJECTS_H

#include "enfilade/query.h"
#include "enfilade/view.h"

#ifdef __cplusplus
extern "C" {
#endif

#define ENF_LIST_NOWHERE (-1)
#define ENF_LIST_EVERYWHERE (-2)

typedef struct enf_objects enf_objects;

/// Names an object. All zero is none. A handle of an object that was removed is refused, also when its place
/// is taken by another one (until that place has been used 2^32 times).
typedef struct enf_object {
    uint32_t slot;       ///< 1 and up
    uint32_t generation; ///< how often the slot has been given up
} enf_object;

typedef struct enf_objects_options {
    size_t size;         ///< sizeof(enf_objects_options)
    int32_t objects_max; ///< at once; 0: 1024
    int32_t links_max; ///< how many cells beyond its first all objects together may touch; 0: 3 * objects_max
} enf_objects_options;

/// An empty set of objects. The world must stay open as long as it lives. Takes 144 bytes for each object, 24
/// for each link and 32 for each cell. ENF_BAD_USAGE for options out of range, ENF_NO_RESOURCES without
/// memory.
ENF_API enf_status enf_objects_create(enf_objects **objects, const enf_world *world,
                                      const enf_objects_options *options, enf_error *error);

/// Null is fine.
ENF_API void enf_objects_free(enf_objects *objects);

/// Adds an object; `user` is the caller's own number for it. ENF_BAD_USAGE for a shape that is not finite or
/// has a negative size, ENF_NO_RESOURCES if there are objects_max already; *object is then all zero. Searches
/// for the cell of the centre unless `near`, which may be null or stale, names an object close by.
ENF_API enf_status enf_objects_add(enf_objects *objects, const enf_shape *shape, uint64_t user,
                                   const enf_object *near, enf_object *object, enf_error *error);

/// Gives an object a new place or shape. Follows it from where it was, without a search: O(1) across a
/// portal, and no list is touched as long as it stays in the same cells. ENF_BAD_USAGE for a handle of no
/// object or a shape as above; nothing has changed then.
ENF_API enf_status enf_objects_move(enf_objects *objects, enf_object object, const enf_shape *shape,
                                    enf_error *error);

/// ENF_BAD_USAGE for a handle of no object.
ENF_API enf_status enf_objects_remove(enf_objects *objects, enf_object object, enf_error *error);

/// What is known about an object.
typedef struct enf_object_info {
    enf_shape shape;
    uint64_t user;
    int32_t cell;       ///< that holds the centre, or -1
    int32_t cell_count; ///< that it is listed in; 0 for one in ENF_LIST_NOWHERE or ENF_LIST_EVERYWHERE
    bool everywhere;    ///< it is in ENF_LIST_EVERYWHERE
} enf_object_info;

/// False, and *info all zero, for a handle of no object.
ENF_API bool enf_objects_get(const enf_objects *objects, enf_object object, enf_object_info *info);

/// The cells that an object is listed in, as far as they fit. Returns how many there are, 0 for a handle of
/// no object. They come in the order in which the object came to touch them.
ENF_API int32_t enf_objects_cells(const enf_objects *objects, enf_object object, int32_t *out,
                                  int32_t capacity);

/// The objects of one cell, or of one of the two other lists, as far as they fit. Returns how many there are,
/// 0 for a cell that the world does not have. They come in the order in which they came into the cell.
/// Objects of ENF_LIST_EVERYWHERE are listed only there.
ENF_API int32_t enf_objects_of_cell(const enf_objects *objects, int32_t cell, enf_object *out,
                                    int32_t capacity);

/// The objects of many cells, each once, then those of ENF_LIST_EVERYWHERE, as far as they fit. Returns how
/// many there are. `cells` may hold a cell more than once, cells that the world does not have (ignored), and
/// ENF_LIST_NOWHERE. Objects come in the order of the cells, within a cell as above. `query`, of the same
/// world, lends its scratch memory; its latest answer is gone then.
ENF_API int32_t enf_objects_in_cells(const enf_objects *objects, enf_query *query, const int32_t *cells,
                                     int32_t cell_count, enf_object *out, int32_t capacity);

/// An object in a cell that a view lists.
typedef struct enf_object_seen {
    enf_object object;
    int32_t entry;  ///< the first one, in the view's list, whose cell the object is in; -1: everywhere
    int32_t space;  ///< in which it is seen: visible->spaces[space].to_camera carries it to where the camera
                    ///< shows it, and .plane cuts off what lies before the portal
    int32_t portal; ///< -1: the object itself. Otherwise its image: it reaches into this portal, which
                    ///< transforms, and what lies beyond the portal's plane comes out here: to be drawn with
                    ///< the portal's matrix (enf_instance_get_transform) before the space's
} enf_object_seen;

/// The objects of the cells that a view has listed, as far as they fit: once for each space in which one of
/// their cells is listed. So an object that stands before a mirror comes twice, in the world itself and in
/// the mirror's space, if the view lists its cell in both; and one in the room to which a portal leads comes
/// in the space behind that portal. Returns how many there are. Spaces come in their order; in each, objects
/// in the order of the entries, then, if there was an entry, those of ENF_LIST_EVERYWHERE.
///
/// Then come images. An object on its way through a portal that transforms has its centre before it, in the
/// cell that the portal leads from, and a part beyond: that part is in the cells that the object, carried by
/// the portal's matrix, touches from the cell where the portal leads. Its image is listed once for each space
/// in which one of these is, portal by portal, also where the object itself is not seen. When its centre has
/// passed, put the object there (enf_objects_move); if the way back is set, too, its image is what is left
/// behind. A mirror, a reflection that leads back to its own cell, lets nothing through; nor does a closed
/// door. An image that reaches into another such portal has no further one.
///
/// `instance`, which may be null, and `visible`: of the view's run, of the same world. `query` is lent as
/// above.
ENF_API int32_t enf_objects_in_view(const enf_objects *objects, enf_query *query,
                                    const enf_instance *instance, const enf_visible *visible,
                                    enf_object_seen *out, int32_t capacity);

/// False if the object lies wholly behind one of the planes (a, b, c, d: in front where a x + b y + c z + d
/// >= 0; of any length), so it is not in the convex region that they bound; also for a handle of no object.
/// May say true for an object near an edge of the region.
ENF_API bool enf_objects_meets(const enf_objects *objects, enf_object object, const double (*planes)[4],
                               int32_t plane_count);

/// How full it is.
typedef struct enf_objects_use {
    int32_t objects, objects_max, links, links_max;
    int32_t nowhere, everywhere; ///< objects in these lists
} enf_objects_use;

ENF_API enf_objects_use enf_objects_get_use(const enf_objects *objects);

#ifdef __cplusplus
}
#endif
#endif
