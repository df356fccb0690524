// SPDX-License-Identifier: GPL-3.0-or-later
// Exact proofs that no line passes a set of edges: weights w >= 0, not all 0, whose combination of the edges'
// Pluecker vectors is 0 (Gordan's theorem). The simplex method names the edges; the weights are found and
// verified here, with whole numbers.
#ifndef ENF_VISIBILITY_CHECK_HIDDEN_PROOF_H
#define ENF_VISIBILITY_CHECK_HIDDEN_PROOF_H

#include "visibility/portal_graph.h"

enum { ENF_PROOF_EDGES = 7 };

/// What was proved, or could not be, is kept: the same few edges come up again and again.
typedef struct enf_hidden_proof {
    const enf_portal_graph *graph;
    void *numbers;
    int32_t *corner_next; ///< of each corner: the next one around its winding
    struct enf_proof_slot *slots;
    size_t slot_count, used; ///< slots: a power of two
    uint64_t asked, computed, failed;
} enf_hidden_proof;

/// The graph must outlive it. False without memory.
bool enf_hidden_proof_make(enf_hidden_proof *proof, const enf_portal_graph *graph);
void enf_hidden_proof_free(enf_hidden_proof *proof);

/// Edges are 2 c, from corner c of the graph to the next one of its winding, and 2 c + 1, back. True: it is
/// certain that no line passes all of them on their inner side, strictly.
bool enf_hidden_proof_ask(enf_hidden_proof *proof, const int32_t *edges, int count);

/// The place to keep what was found about two directed portals, by whatever means: 0 (at first), 1 or -1.
/// Good until the next call.
int8_t *enf_hidden_proof_of_portals(enf_hidden_proof *proof, int32_t first, int32_t second);

#endif
