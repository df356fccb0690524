// SPDX-License-Identifier: GPL-3.0-or-later
// Finite doubles as whole numbers of GMP: multiples of a power of two that all of them share.
#ifndef ENF_VISIBILITY_CHECK_WHOLE_NUMBER_H
#define ENF_VISIBILITY_CHECK_WHOLE_NUMBER_H

#include "visibility/portal_graph.h"

#include <gmp.h>

/// A power of two of which the number is a multiple; a large one for 0.
int enf_last_bit(double value);

/// One of which all coordinates of the graph are multiples, at most 0.
int enf_last_bit_of_graph(const enf_portal_graph *graph);

/// out = value / 2^unit; a whole number if unit is at most the value's last bit.
void enf_set_whole(mpz_t out, double value, int unit);

#endif
