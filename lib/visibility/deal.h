// SPDX-License-Identifier: GPL-3.0-or-later
// A stage among the processes of a team: rank 0 deals cells out to who asks for some, its own threads
// included.
//
// Messages are numbers (bytes.h). To rank 0: 1 if more cells are wanted, else 0; then for each cell that is
// finished its number, its outcome, the length of the result and the result. From rank 0: the numbers of
// cells; none: there are no more.
#ifndef ENF_VISIBILITY_DEAL_H
#define ENF_VISIBILITY_DEAL_H

#include "visibility/shop.h"

/// Rank 0: works until all cells of its queue have an outcome, wherever they went. Failures are the shop's.
void enf_deal_out(enf_shop *shop);

/// Another rank: gets cells and sends results until there are no more.
void enf_deal_in(enf_shop *shop);

/// All results to all processes.
void enf_deal_share(enf_shop *shop);

#endif
