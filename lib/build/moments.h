// SPDX-License-Identifier: GPL-3.0-or-later
// Volume, centre and second moments of a body, and what they tell of its silhouettes.
//
// A line in direction n meets the body in a length l; the integral of l over the silhouette is the volume V.
// Around any centre the second moment of a length l along its line is at least l^3 / 12. So for any centres
// that depend linearly on the line, V s^2 >= integral of l^3 / 12, where s^2 is the variance of the body
// along n that no linear function of the place across n explains: s^2 = 1 / (n . S^-1 n) for the covariance
// S. With Hoelder's inequality the silhouette has at least the area V / (s sqrt 12): exact for a
// parallelepiped seen along its edges, 0.86 of the truth for an ellipsoid seen from anywhere.
#ifndef ENF_BUILD_MOMENTS_H
#define ENF_BUILD_MOMENTS_H

#include "enfilade/base.h"

typedef struct enf_moments {
    double volume;
    double center[3];
    double spread[6]; ///< integrals of xx, yy, zz, yz, zx, xy, measured from the centre
} enf_moments;

/// Adds the signed cone from `origin` over the outline of a face, counter-clockwise seen from outside if
/// `sign` is 1, clockwise if it is -1, to sums that start from {0} and are measured from the origin.
void enf_moments_add_cone(enf_moments *sums, const double origin[3], const double *const corners[3],
                          double sign);

/// Makes moments of sums over all faces of a body.
void enf_moments_finish(enf_moments *sums, const double origin[3]);

/// The moments of two bodies together.
void enf_moments_join(enf_moments *moments, const enf_moments *other);

/// A lower bound of the silhouette seen along the unit vector `direction`, or 0.
double enf_moments_silhouette_bound(const enf_moments *moments, const double direction[3]);

#endif
