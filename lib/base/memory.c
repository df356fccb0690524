// SPDX-License-Identifier: MIT
// Linux tells by getrusage, /proc/self and the files of control groups (both versions); elsewhere fewer of
// these exist, and what does not exist limits nothing.
#include "base/memory.h"

#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

enum { PATH_LENGTH = 1024 };

uint64_t enf_memory_peak(void) {
    struct rusage usage;
    if (getrusage(RUSAGE_SELF, &usage) != 0) return 0;
    return (uint64_t)usage.ru_maxrss * 1024; // Linux counts kilobytes
}

uint64_t enf_memory_resident(void) {
    FILE *file = fopen("/proc/self/statm", "re");
    uint64_t size, resident = 0;
    if (!file) return 0;
    if (fscanf(file, "%" SCNu64 " %" SCNu64, &size, &resident) != 2) resident = 0;
    fclose(file);
    long page = sysconf(_SC_PAGESIZE);
    return page > 0 ? resident * (uint64_t)page : 0;
}

static void take_least(uint64_t limit, const char *name, uint64_t *least, const char **limiter) {
    if (limit >= *least) return;
    *least = limit;
    *limiter = name;
}

/// The number in a file that holds one; words such as "max" are no limit.
static uint64_t read_limit(const char *path) {
    FILE *file = fopen(path, "re");
    uint64_t limit;
    if (!file) return UINT64_MAX;
    if (fscanf(file, "%" SCNu64, &limit) != 1) limit = UINT64_MAX;
    fclose(file);
    return limit;
}

/// The limit of a group and of all those around it. `group` begins with a slash and is cut short.
static uint64_t read_groups(const char *root, char *group, const char *name) {
    uint64_t least = UINT64_MAX;
    for (;;) {
        char path[2 * PATH_LENGTH];
        snprintf(path, sizeof path, "%s%s/%s", root, group, name);
        uint64_t limit = read_limit(path);
        if (limit < least) least = limit;
        char *slash = strrchr(group, '/');
        if (!slash) return least;
        *slash = 0;
    }
}

/// A line of /proc/self/cgroup is "number:controllers:/group"; version 2 has number 0 and no controllers.
static uint64_t read_control_groups(void) {
    FILE *file = fopen("/proc/self/cgroup", "re");
    uint64_t least = UINT64_MAX;
    char line[PATH_LENGTH];
    while (file && fgets(line, sizeof line, file)) {
        line[strcspn(line, "\n")] = 0;
        char *controllers = strchr(line, ':'), *group = controllers ? strchr(controllers + 1, ':') : NULL;
        if (!group) continue;
        *group++ = 0;
        bool second = strcmp(line, "0:") == 0, first = strcmp(controllers + 1, "memory") == 0;
        uint64_t limit = UINT64_MAX;
        if (second) limit = read_groups("/sys/fs/cgroup", group, "memory.max");
        if (first) limit = read_groups("/sys/fs/cgroup/memory", group, "memory.limit_in_bytes");
        if (limit < least) least = limit;
    }
    if (file) fclose(file);
    return least;
}

uint64_t enf_memory_limit(const char **limiter) {
    uint64_t least = UINT64_MAX;
    *limiter = "nothing";
    long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    if (pages > 0 && page > 0)
        take_least((uint64_t)pages * (uint64_t)page, "this machine's memory", &least, limiter);
    take_least(read_control_groups(), "the control group's limit", &least, limiter);
    struct rlimit space;
    if (getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY)
        take_least(space.rlim_cur, "the limit of the address space (ulimit -v)", &least, limiter);
    return least;
}
