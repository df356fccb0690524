// SPDX-License-Identifier: GPL-3.0-or-later
// A stage as independent jobs, one for each cell, whose results can be written down as bytes: by the threads
// of this process, by other processes, or by an earlier run that left a checkpoint.
#ifndef ENF_VISIBILITY_WORK_H
#define ENF_VISIBILITY_WORK_H

#include "base/parallel.h"
#include "visibility/bytes.h"
#include "visibility/checkpoint.h"
#include "visibility/team.h"

/// Their numbers in checkpoints.
enum { ENF_STAGE_CAST = 1, ENF_STAGE_SETTLE = 2, ENF_STAGE_BODIES = 3 };

/// What a stage is. Results must depend on the cell alone, not on who does what and when.
typedef struct enf_work {
    int32_t stage; ///< ENF_STAGE_...
    uint64_t key;  ///< a hash of what jobs go by, besides the input and the options
    int32_t cell_count;
    const int64_t *cost; ///< per cell: about how long it takes, in any unit; 0: there is nothing to do
    void *user;

    /// Does the cell. *late: there was no time for all of it; what there is holds. Called by several threads.
    enf_status (*run)(void *user, int32_t cell, int thread, bool *late, enf_error *error);

    /// Puts what has been found for a cell.
    void (*encode)(void *user, int32_t cell, enf_bytes *bytes);

    /// Takes what was found for a cell that was not run here. False without memory.
    bool (*decode)(void *user, int32_t cell, enf_reader *reader);
} enf_work;

/// Who works, for how long, and who keeps the results; the same for all stages.
typedef struct enf_workplace {
    enf_crew crew;              ///< watched every 50 ms or so, with the share of the cost that is done
    double deadline;            ///< on enf_timer_now's clock: no job begins later
    enf_checkpoint *checkpoint; ///< or null
    const enf_team *team;       ///< or null
    int64_t stored;             ///< results that the checkpoint had
} enf_workplace;

/// Does all cells, the dearest first. *begun (per cell, the caller's) tells which have a result; the others'
/// turn came after the deadline. In a team, all processes have all results afterwards. ENF_NO_RESOURCES when
/// cancelled, without memory, or if the checkpoint cannot be written; ENF_BAD_INPUT for a wrong checkpoint.
enf_status enf_work_run(const enf_work *work, enf_workplace *place, bool *begun, enf_error *error);

#endif
