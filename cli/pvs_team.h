// SPDX-License-Identifier: GPL-3.0-or-later
// `mpirun -n N enfilade pvs`: N processes that share the work. Rank 0 reads, writes and speaks; the others
// compute. Without mpirun, or in a build without ENFILADE_MPI, there is one process and no team.
#ifndef ENF_CLI_PVS_TEAM_H
#define ENF_CLI_PVS_TEAM_H

#include "visibility/team.h"

/// Joins the others; null: there are none. Once, before anything else.
const enf_team *cli_team_join(void);

/// Threads for each process if the user does not say: what there is, fairly divided.
int cli_team_threads(const enf_team *team);

/// Leaves the team when all do; null is fine.
void cli_team_leave(const enf_team *team);

/// Ends all processes of the team with this status, wherever they are. Does not return; null is fine, and
/// does.
void cli_team_abort(const enf_team *team, int status);

#endif
