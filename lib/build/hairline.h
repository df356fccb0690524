// SPDX-License-Identifier: GPL-3.0-or-later
// Hairline cells: fine cells thinner than the weld distance, the debris of rounded coordinates (a floor that
// was flat before a rotation). They are no places; each goes with a neighbour before decimation looks at any
// portal.
#ifndef ENF_BUILD_HAIRLINE_H
#define ENF_BUILD_HAIRLINE_H

#include "build/complex.h"

/// Numbers the kept fine cells 0..*node_count-1 in node_of (-1: not kept), giving a cell whose volume is less
/// than `thin` (grid steps; 0: none) times half its surface the number of the neighbour with which it shares
/// the largest open area. Numbers rise with the smallest fine cell of each node. *joined counts such cells.
/// False without memory.
bool enf_complex_number_nodes(const enf_complex *complex, const bool *cell_kept, double thin,
                              int32_t *node_of, int32_t *node_count, int32_t *joined);

#endif
