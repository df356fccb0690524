// SPDX-License-Identifier: GPL-3.0-or-later
// Sides that are no edges of portals, in whole numbers.
//
// A line with direction d through p rises through the planes <n, x> = a and <m, x> = b, <n, d> and <m, d>
// above 0. It comes to the first one first if (a - <n, p>) / <n, d> < (b - <m, p>) / <m, d>, which is
// 0 < <d, b n - a m> + <p x d, n x m>: linear in (d, p x d). It is the side on which it passes the hinge, the
// line that both planes have in common.
#include "visibility/exact_double.h"
#include "visibility/stab_parts.h"

typedef struct plane {
    mpz_t normal[3], height;
} plane;

static void plane_init(plane *plane) {
    for (int i = 0; i < 3; i++) mpz_init(plane->normal[i]);
    mpz_init(plane->height);
}

static void plane_clear(plane *plane) {
    for (int i = 0; i < 3; i++) mpz_clear(plane->normal[i]);
    mpz_clear(plane->height);
}

/// A corner as seen from the stabber's origin, in units.
static void set_corner(const enf_stabber *stabber, const double corner[3], mpz_t out[3]) {
    mpz_t origin;
    mpz_init(origin);
    for (int i = 0; i < 3; i++) {
        enf_double_to_whole(out[i], corner[i], stabber->unit);
        enf_double_to_whole(origin, stabber->origin[i], stabber->unit);
        mpz_sub(out[i], out[i], origin);
    }
    mpz_clear(origin);
}

/// out = a x b
static void set_cross(mpz_t out[3], mpz_t a[3], mpz_t b[3]) {
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        mpz_mul(out[i], a[j], b[k]);
        mpz_submul(out[i], a[k], b[j]);
    }
}

static void set_plane(const enf_stabber *stabber, const double *const corner[3], plane *plane) {
    mpz_t at[3][3];
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++) mpz_init(at[k][i]);
        set_corner(stabber, corner[k], at[k]);
    }
    for (int k = 1; k < 3; k++) {
        for (int i = 0; i < 3; i++) mpz_sub(at[k][i], at[k][i], at[0][i]);
    }
    set_cross(plane->normal, at[1], at[2]);
    mpz_set_ui(plane->height, 0);
    for (int i = 0; i < 3; i++) mpz_addmul(plane->height, plane->normal[i], at[0][i]);
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++) mpz_clear(at[k][i]);
    }
}

static void set_hinge(const enf_stabber *stabber, const enf_stab_side *side, mpz_t *vector) {
    plane one, two;
    plane_init(&one);
    plane_init(&two);
    set_plane(stabber, side->corner, &one);
    set_plane(stabber, side->corner + 3, &two);
    for (int i = 0; i < 3; i++) {
        mpz_mul(vector[i], two.height, one.normal[i]);
        mpz_submul(vector[i], one.height, two.normal[i]);
    }
    set_cross(vector + 3, one.normal, two.normal);
    enf_whole_shorten(vector);
    plane_clear(&one);
    plane_clear(&two);
}

static void set_edge(const enf_stabber *stabber, const enf_stab_side *side, mpz_t *vector) {
    mpz_t from[3], to[3];
    for (int i = 0; i < 3; i++) mpz_inits(from[i], to[i], NULL);
    set_corner(stabber, side->corner[0], from);
    set_corner(stabber, side->corner[1], to);
    set_cross(vector, from, to);
    for (int i = 0; i < 3; i++) {
        mpz_sub(vector[3 + i], to[i], from[i]);
        mpz_clears(from[i], to[i], NULL);
    }
}

void enf_stabber_whole_side(const enf_stabber *stabber, const enf_stab_side *side, mpz_t *vector) {
    if (side->count == 6)
        set_hinge(stabber, side, vector);
    else
        set_edge(stabber, side, vector);
}
