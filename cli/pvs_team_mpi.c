// SPDX-License-Identifier: GPL-3.0-or-later
// All that knows of MPI. Only the thread that joined makes MPI calls. Errors of MPI itself end all processes,
// as is its way.
#ifndef _GNU_SOURCE
#define _GNU_SOURCE // sched_getaffinity
#endif
#include "cli/pvs_team.h"

#include "base/array.h"
#include "cli/job.h"

#include <limits.h>
#include <mpi.h>
#include <sched.h>
#include <stdlib.h>

enum { PIECE = 1 << 30 }; ///< bytes of a broadcast

static bool send_to(void *user, int to, const enf_bytes *message) {
    (void)user;
    if (message->count > INT_MAX) return false;
    return MPI_Send(message->data, (int)message->count, MPI_BYTE, to, 0, MPI_COMM_WORLD) == MPI_SUCCESS;
}

static bool receive(void *user, int *from, enf_bytes *message) {
    (void)user;
    int waits, count;
    MPI_Status about;
    *from = -1;
    message->count = 0;
    if (MPI_Iprobe(MPI_ANY_SOURCE, 0, MPI_COMM_WORLD, &waits, &about) != MPI_SUCCESS) return false;
    if (!waits) return true;
    MPI_Get_count(&about, MPI_BYTE, &count);
    if (!enf_array_reserve(message->data, message->capacity, (size_t)count)) return false;
    message->count = (size_t)count;
    *from = about.MPI_SOURCE;
    return MPI_Recv(message->data, count, MPI_BYTE, *from, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE) ==
           MPI_SUCCESS;
}

static bool share(void *user, enf_bytes *bytes) {
    const enf_team *team = user;
    uint64_t size = bytes->count;
    MPI_Bcast(&size, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
    int good = team->rank == 0 || enf_array_reserve(bytes->data, bytes->capacity, size), all_good;
    MPI_Allreduce(&good, &all_good, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    if (!all_good) return false;
    bytes->count = size;
    for (uint64_t at = 0; at < size; at += PIECE) {
        int piece = (int)(size - at < PIECE ? size - at : PIECE);
        MPI_Bcast(bytes->data + at, piece, MPI_BYTE, 0, MPI_COMM_WORLD);
    }
    return true;
}

/// Did a launcher start this process? MPI would start one of its own otherwise.
static bool is_launched(void) {
    static const char *const names[] = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (getenv(names[i])) return true;
    return false;
}

const enf_team *cli_team_join(void) {
    static enf_team team = {.user = &team, .send = send_to, .receive = receive, .share = share};
    int given;
    if (!is_launched()) return NULL;
    MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &given);
    MPI_Comm_rank(MPI_COMM_WORLD, &team.rank);
    MPI_Comm_size(MPI_COMM_WORLD, &team.size);
    return &team;
}

int cli_team_threads(const enf_team *team) {
    cpu_set_t mine;
    MPI_Comm here;
    int cores = cli_default_threads(), neighbours = 1;
    if (!team) return cores;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, team->rank, MPI_INFO_NULL, &here);
    MPI_Comm_size(here, &neighbours);
    MPI_Comm_free(&here);
    int fair = cores / neighbours;
    if (sched_getaffinity(0, sizeof mine, &mine) == 0 && CPU_COUNT(&mine) < fair) fair = CPU_COUNT(&mine);
    return fair < 1 ? 1 : fair;
}

void cli_team_leave(const enf_team *team) {
    if (team) MPI_Finalize();
}

void cli_team_abort(const enf_team *team, int status) {
    if (!team) return;
    MPI_Abort(MPI_COMM_WORLD, status);
    abort();
}
