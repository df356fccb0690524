// SPDX-License-Identifier: GPL-3.0-or-later
// Rays through worlds of cubes (run_worlds.h), followed from cube to cube: what they pass must be listed by a
// view, in a region that has the ray's pixel; with doors, mirrors and portals that lead elsewhere.
#ifndef ENF_TESTS_VIEW_SCENE_H
#define ENF_TESTS_VIEW_SCENE_H

#include "run_worlds.h"

#include "enfilade/view.h"

enum { SCENE_RAYS = 60, SCENE_TRANSFORMS = 2, SCENE_CHAIN = 8 };

typedef struct scene_ray {
    double origin[3], direction[3]; ///< world, as transforms have it
    double x, y;                    ///< of the screen
    int32_t cell;
    int32_t chain[SCENE_CHAIN], chain_count; ///< portals that transform, passed
} scene_ray;

typedef struct scene {
    const enf_world *world;
    const enf_file_view *view;
    const enf_instance *instance;
    const enf_visible *visible;
    int64_t passed, missed;
    bool cut_chains; ///< stop at SCENE_TRANSFORMS of them
    /// Told of a point of a ray in each cell that it comes to; null: nobody is.
    void (*come_to)(void *user, const scene_ray *ray, const double point[3]);
    /// Told where a ray passes a portal that transforms: as it comes to it, after `t`, and as it goes on.
    void (*pass)(void *user, const scene_ray *before, double t, const scene_ray *after);
    void *user;
} scene;

/// Follows a ray to its end; what it passes counts as passed, what the view has not as missed.
void scene_follow(scene *scene, scene_ray ray);

/// Looks from an eye in a cell in a random direction, and follows SCENE_RAYS rays of the camera.
void scene_check(scene *scene, enf_view *view, const double eye[3], int32_t cell, uint64_t *seed);

void scene_point_at(const scene_ray *ray, double t, double point[3]);

/// How far a point is from a plane; the sign tells the side.
double scene_step_off(const double plane[4], const double p[3]);

bool scene_is_inside(const enf_file_view *view, const enf_file_portal_polygon *polygon, const double p[3]);

/// A random direction, of length 1.
void scene_direction(uint64_t *seed, double direction[3]);

enf_camera scene_camera(const double eye[3], uint64_t *seed);

/// The direction of a pixel: what the matrix takes to (x, y, 1).
void scene_aim(const enf_camera *camera, double x, double y, double direction[3]);

/// Is the space the one behind the portals that the ray passed?
bool scene_has_chain(const enf_visible *visible, int32_t space, const scene_ray *ray);

/// A random point in a cell; false if none was found.
bool scene_eye(const run_world *world, uint64_t *seed, double eye[3], enf_place *place);

/// A third of the doors closed, a third ajar.
void scene_set_doors(enf_instance *instance, const enf_file_view *view, uint64_t *seed);

/// A reflection in the plane of a portal that is flat.
void scene_set_mirror(enf_instance *instance, const enf_file_view *view, int32_t portal);

/// Some portals become mirrors, some lead elsewhere.
void scene_set_transforms(enf_instance *instance, const enf_file_view *view, uint64_t *seed);

#endif
