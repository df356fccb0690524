// SPDX-License-Identifier: GPL-3.0-or-later
// A build without MPI.
#include "cli/pvs_team.h"

#include "cli/job.h"

const enf_team *cli_team_join(void) {
    return NULL;
}

int cli_team_threads(const enf_team *team) {
    (void)team;
    return cli_default_threads();
}

void cli_team_leave(const enf_team *team) {
    (void)team;
}

void cli_team_abort(const enf_team *team, int status) {
    (void)team;
    (void)status;
}
