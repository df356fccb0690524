// SPDX-License-Identifier: GPL-3.0-or-later
// Which cell can see which: a ladder of methods from cheap to exact.
#ifndef ENF_VISIBILITY_VISIBILITY_H
#define ENF_VISIBILITY_VISIBILITY_H

#include "visibility/air_order.h"
#include "visibility/bits.h"
#include "visibility/bodies.h"
#include "visibility/line.h"
#include "visibility/portal_graph.h"
#include "visibility/pvs.h"
#include "visibility/stab.h"
#include "visibility/team.h"

/// Each is applied on top of the ones before it, so each set contains the next. A cell is seen if
typedef enum enf_method {
    ENF_METHOD_REACH,     ///< it is connected through portals
    ENF_METHOD_FACING,    ///< reached through portals that lie in front of the first and have it behind them
    ENF_METHOD_HOURGLASS, ///< the separating planes of some portal sequence leave something of every portal
    ENF_METHOD_LP,        ///< and the stabbing LP over the sequence's edges is feasible
    ENF_METHOD_EXACT,     ///< and a real line goes through all its portals, in order along the line
    ENF_METHOD_COUNT
} enf_method;

/// "reach" and so on, as on the command line.
const char *enf_method_name(enf_method method);

/// The method of that name; false if there is none.
bool enf_method_find(const char *name, enf_method *method);

enum { ENF_SEQUENCE_LENGTHS = 64 };

typedef struct enf_visibility_options {
    enf_method method;
    int threads; ///< at least 1; the result is the same for any number
    bool want_witnesses;
    const enf_bodies *bodies;   ///< may be null: bodies in the cells, which are asked for, too
    const enf_air_order *order; ///< may be null: of the cells, if they are leafs; saves time with bodies

    /// May be null; false cancels. Called by the caller's own thread only.
    bool (*progress)(void *user, const char *stage, double fraction);
    void *progress_user;

    double budget_seconds; ///< for the dear methods; what is not decided by then counts as seen; 0: none

    /// May be null: a file that keeps what is done. If it is there, the run goes on from it; it is the
    /// caller's to remove (checkpoint.h).
    const char *checkpoint;
    const enf_team *team; ///< may be null; all processes run the same with it, and get the same
} enf_visibility_options;

typedef struct enf_visibility {
    enf_method method;
    enf_pvs pvs; ///< symmetric; with bodies, by `facing` and `hourglass` just that cells see themselves

    /// With bodies, from the rung facing on: bit j of row i: bodies of owners i and j may see each other;
    /// symmetric. As a set it is no rung: what `hourglass` finds of it, lp and exact do not look at again.
    enf_bits met;

    // If wanted: one for each unordered pair of cells that was proved visible.
    enf_line *witnesses;         ///< witness_count; from the first cell of the pair to the second
    char **long_witnesses;       ///< witness_count; not null: the line in more digits (stab.h) instead
    int32_t (*witness_cells)[2]; ///< witness_count; i < j
    int64_t witness_count;

    // How much was looked at, by rung.
    int64_t portal_pairs;   ///< hourglass: directed portals that may see each other
    int64_t visits;         ///< hourglass: how often a beam came to a portal
    int64_t body_visits;    ///< the same of beams from bodies
    int64_t lines;          ///< hourglass: sight lines that were tried
    int64_t pairs_open;     ///< lp and exact: pairs of cells that neither beams nor lines had decided
    int64_t nodes;          ///< lp and exact: portals that sequences came to
    enf_stab_counts stabs;  ///< lp and exact: what it took to decide sequences
    int64_t jobs_stored;    ///< what the checkpoint had already: results for a cell
    int64_t cells_budgeted; ///< cells, or owners of bodies, whose beams were too late for the budget
    int64_t pairs_budgeted; ///< pairs that were, and count as seen

    // Of pairs that were proved visible: how many portals the line passes that proved it.
    int32_t sequence_longest;
    int64_t sequence_lengths[ENF_SEQUENCE_LENGTHS]; ///< the last: so many or more
    double seconds, cpu_seconds;
} enf_visibility;

/// Finds what every cell of a finished graph sees, into *visibility, which is overwritten. ENF_NO_RESOURCES
/// without memory or when cancelled. Free it in any case.
enf_status enf_visibility_run(enf_visibility *visibility, const enf_portal_graph *graph,
                              const enf_visibility_options *options, enf_error *error);

void enf_visibility_free(enf_visibility *visibility);

#endif
