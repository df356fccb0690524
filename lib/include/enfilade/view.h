// SPDX-License-Identifier: MIT
// What a camera sees: the cells that a line of sight from the eye can reach through portals, each with the
// part of the screen through which it is seen.
//
// From the eye's cell on, every portal is clipped to the region through which its cell is seen; what is left
// is the region of the cell behind. A region is a convex polygon of the screen: the intersection of the
// portals' perimeters (D. Luebke and C. Georges, "Portals and mirrors: simple, fast evaluation of potentially
// visible sets", I3D 1995, who take rectangles). Polygons of too many edges lose those that make them grow
// least, their neighbours are prolonged; so they stay tighter than rectangles if the camera is tilted.
//
// Conservative: a cell that the eye sees by a hair is listed. What is compared is rounded; so all regions
// have a hair more, ENF_VIEW_SLACK, and an eye that is on a portal, or nearer to it than the rounding allows
// to tell, looks through the whole of it. What is listed without being seen comes from: regions of convex
// shape, the edges that were removed, walls within a cell (cells are rooms, with pillars in them), and cells
// seen through more than a few regions.
//
// Order: entries come by the least depth at which the eye's rays enter them (depth: distance along the
// camera's axis), so that near cells come before far ones; hence along each ray the cells come in the order
// in which the ray meets them first, and an entry comes after its parent. It is not the order of painters: a
// cell that surrounds others, or that a ray enters twice, is listed once, where it begins. (With
// ENF_VIEW_GROWN, regions that were added late do not change a cell's place.)
//
// Time: each cell is looked at for each of its first `regions_max` regions, and a few times more, when later
// ones join them and in the end it gets the whole screen. So a run looks at the portals of what it lists a
// bounded number of times, whatever the geometry, and at nothing else in the world. Nothing is allocated:
// create takes all memory.
//
// A view belongs to one thread at a time; any number of views may share a world and an instance.
#ifndef ENFILADE_VIEW_H
#define ENFILADE_VIEW_H

#include "enfilade/instance.h"

#ifdef __cplusplus
extern "C" {
#endif

/// How much farther than its polygon a clip region may reach, in units of the screen, which is 2 wide and 2
/// high: a five-hundredth of a pixel of 4000. It stands for the rounding of a portal's corners, which is a
/// thousand times less at the distance at which portals are no longer looked through whole.
#define ENF_VIEW_SLACK 1e-6

/// Edges of clip regions are at least this long, but for the shortest of a region thinner than that: so the
/// direction of each is right, and clipping with its line is.
#define ENF_VIEW_SHORTEST 1e-5

#define ENF_VIEW_EDGES_MAX 32 ///< of a region, also if its edges are unlimited

/// A perspective camera, in the convention of columns: clip = matrix * (x, y, z, 1), row after row. A point
/// is on the screen if -w <= x <= w and -w <= y <= w, and x / w, y / w (to the right and up, or as the caller
/// likes) is where.
typedef struct enf_camera {
    size_t size;        ///< sizeof(enf_camera)
    double eye[3];      ///< world
    double matrix[16];  ///< world to clip; of the rows x, y and w the first three numbers are read, for the
                        ///< eye says where it is; w must grow into the view (OpenGL, Vulkan, Direct3D do so)
    double viewport[2]; ///< pixels, wide and high; only for areas. 0: areas are those of 2 x 2 pixels
    const enf_place *place; ///< where the eye is, if that is known; null: it is located, with the run before
                            ///< as a hint. Only the cell is read
} enf_camera;

/// A camera at `eye` that looks along `forward`; `up` is any direction not along it. `fov` is the angle
/// between the upper and the lower side of the screen, radians, `aspect` is width / height. Not finite or
/// flat input gives a matrix that is not finite, of which enf_view_run says ENF_VIEW_NO_CAMERA.
ENF_API enf_camera enf_camera_look(const double eye[3], const double forward[3], const double up[3],
                                   double fov, double aspect);

/// The tests that may spare a portal. They are asked in this order: set, sphere, facing, rectangle, polygon.
/// The sphere comes before the facing, since it needs nothing of the polygons: the other way round a
/// traversal takes 2 to 8 % more time with all of it in the cache, and up to a quarter more where the eye has
/// just come to (tests/bench/README.md).
typedef enum enf_view_test {
    ENF_VIEW_PVS = 1,    ///< the cell behind is not in the visible set of the eye's cell. Not asked behind a
                         ///< portal that transforms: the set says nothing about what is seen through it
    ENF_VIEW_FACING = 2, ///< the polygon's back is towards the eye
    ENF_VIEW_SPHERE = 4, ///< the portal's bounding sphere is outside the region
    ENF_VIEW_RECTANGLE = 8, ///< the polygon is outside the region's rectangle
    ENF_VIEW_POLYGON = 16   ///< the polygon clipped to the region is empty. Without this one regions are not
                            ///< narrowed at all
} enf_view_test;

/// What is known about a portal before it is passed.
typedef struct enf_view_step {
    int32_t portal, from, to; ///< cells
    int32_t depth;            ///< portals passed, with this one
    int32_t transforms;       ///< of them, those that transform
    double pixels;            ///< area of the region behind it
    double nearest;           ///< the least depth of what is seen of it, world units if w is
} enf_view_step;

/// What to do if the eye is in no cell.
typedef enum enf_view_outside { ENF_VIEW_OUTSIDE_NOTHING = 0, ENF_VIEW_OUTSIDE_ALL } enf_view_outside;

/// Options of a view; null or all zero but `size` is the default.
typedef struct enf_view_options {
    size_t size;              ///< sizeof(enf_view_options)
    int32_t edges_max;        ///< of a region, 4 to ENF_VIEW_EDGES_MAX, more counts as that; 0: 8
    bool rectangles;          ///< regions are rectangles of the screen: cheaper, and less tight
    bool every_region;        ///< list a cell once for each region through which it is seen, at most
                              ///< `regions_max` times; false: once, with one region around all of them
    uint32_t without;         ///< enf_view_test that are left out, to measure them
    int32_t regions_max;      ///< apart for each cell; what comes later joins them. 0: 8
    int32_t transforms_max;   ///< portals that transform on a way; 0: 4; < 0: none
    int32_t visit_capacity;   ///< cells and regions altogether; 0: by the world, at most 16384
    double pixels_min;        ///< portals whose region has a smaller area are not passed; 0: all are
    enf_view_outside outside; ///< if the eye is in no cell
    bool (*decide)(void *user, const enf_view_step *step); ///< false: don't pass; null: do. May be asked
                                                           ///< several times about a portal
    void *user;
} enf_view_options;

/// A cell that is seen.
typedef struct enf_view_entry {
    int32_t cell;
    int32_t parent;              ///< entry through which it was first seen; -1: the eye is in it
    int32_t portal;              ///< by which it was first entered; -1: none
    int32_t depth;               ///< portals passed, on the way first found
    int32_t space;               ///< of `spaces`
    int32_t vertex_count;        ///< of the clip region, counter-clockwise
    const double (*vertices)[2]; ///< x / w, y / w. What is seen of the cell is in the polygon, up to
                                 ///< ENF_VIEW_SHORTEST
    double rectangle[4];         ///< least x, least y, largest x, largest y of what is seen, with the slack.
                                 ///< Of polygons that lost edges it may cut off what was added
    double nearest;              ///< the least depth at which it is entered
} enf_view_entry;

/// The world as it is seen behind portals that transform. Number 0 is the world itself.
typedef struct enf_view_space {
    int32_t parent, portal; ///< the space before and the portal passed; -1: none
    int32_t transforms;     ///< portals that transform, passed
    bool mirrored;          ///< left and right are changed: turn over what is culled as a back
    double to_camera[12];   ///< from here to where the camera shows it: 3 x 4, to be applied before the
                            ///< camera's matrix
    double from_camera[12]; ///< the inverse
    bool has_plane;  ///< what lies on the positive side of `plane` is not seen: it is before the portal
    double plane[4]; ///< in this space; not of length 1
} enf_view_space;

enum {
    ENF_VIEW_OUTSIDE = 1,   ///< the eye is in no cell
    ENF_VIEW_NO_CAMERA = 2, ///< the camera is not finite, or the view is of another world than the instance
    ENF_VIEW_DEPTH = 4,     ///< portals were not passed because of transforms_max
    ENF_VIEW_GROWN = 8,     ///< a cell was seen through more regions than are kept apart
    ENF_VIEW_OVERFLOW = 16, ///< capacity ran out: the list is the visible set of the eye's cell, or all cells
                            ///< if there is none, with the whole screen; in the world itself (space 0)
    ENF_VIEW_INCOMPLETE = 32 ///< capacity ran out and cells are missing; without ENF_VIEW_OVERFLOW: such as
                             ///< are seen behind portals that transform
};

/// Counts of one run. Portals are counted as often as they are looked at.
typedef struct enf_view_stats {
    int64_t visits;  ///< cells and regions looked at
    int64_t portals; ///< of them
    int64_t closed;  ///< doors
    int64_t by_pvs;  ///< portals spared by each test
    int64_t by_sphere;
    int64_t polygons;  ///< of the portals that are left
    int64_t by_facing; ///< polygons spared by each test
    int64_t by_rectangle;
    int64_t by_polygon;
    int64_t near;        ///< polygons looked through whole, since the eye is on them
    int64_t by_area;     ///< portals spared by pixels_min
    int64_t by_decision; ///< by `decide`
    int64_t passed;      ///< regions passed on
    int64_t contained;   ///< of them, those already seen
    int64_t joined;      ///< of them, those that joined one that waited
    int64_t grown;       ///< of them, those that had to
    int64_t edges_removed;
} enf_view_stats;

/// What a run found. Lives until the view's next run.
typedef struct enf_visible {
    uint32_t flags;
    int32_t cell; ///< the eye's; -1: none
    int32_t entry_count, space_count;
    const enf_view_entry *entries;
    const enf_view_space *spaces;
    enf_view_stats stats;
} enf_visible;

typedef struct enf_view enf_view;

/// Takes all memory that runs need. The world must stay open as long as the view lives. ENF_BAD_USAGE for
/// options that make no sense; ENF_NO_RESOURCES without memory.
ENF_API enf_status enf_view_create(enf_view **view, const enf_world *world, const enf_view_options *options,
                                   enf_error *error);

/// Null is fine.
ENF_API void enf_view_free(enf_view *view);

/// Looks around. With an instance its doors and transforms count; null: all portals are open. Never fails:
/// what could not be done is in the flags.
ENF_API const enf_visible *enf_view_run(enf_view *view, const enf_instance *instance,
                                        const enf_camera *camera);

#ifdef __cplusplus
}
#endif
#endif
