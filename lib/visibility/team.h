// SPDX-License-Identifier: GPL-3.0-or-later
// Processes that work on the same graph: how they send one another bytes. Who carries them (MPI, a test) is
// none of the library's business.
#ifndef ENF_VISIBILITY_TEAM_H
#define ENF_VISIBILITY_TEAM_H

#include "visibility/bytes.h"

/// All calls come from the thread that called enf_visibility_run. False: the team is broken, or there is no
/// memory.
typedef struct enf_team {
    int rank, size; ///< rank 0 deals the work out and has the checkpoint
    void *user;

    /// To rank 0, or from it; messages between two processes keep their order.
    bool (*send)(void *user, int to, const enf_bytes *message);

    /// Overwrites *message with one that has come, if there is one; *from is -1 if there is none. Never
    /// waits.
    bool (*receive)(void *user, int *from, enf_bytes *message);

    /// All call it: rank 0 with the bytes, the others get them into *bytes, which they overwrite.
    bool (*share)(void *user, enf_bytes *bytes);
} enf_team;

#endif
