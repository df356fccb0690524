// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/brushes.h"

#include "base/array.h"
#include "cli/random.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { CORNERS_MAX = 64, LINE_MAX_LENGTH = 4096 };

void cli_brushes_free(cli_brushes *brushes) {
    free(brushes->planes);
    free(brushes->list);
    free(brushes->points);
    *brushes = (cli_brushes){0};
}

static bool add_brush(cli_brushes *all) {
    if (!enf_array_reserve(all->list, all->capacity, all->count + 1)) return false;
    all->list[all->count++] = (cli_brush){.first_plane = all->plane_count,
                                          .low = {HUGE_VAL, HUGE_VAL, HUGE_VAL},
                                          .high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    return true;
}

static bool add_point(cli_brushes *all, const char *line) {
    if (!enf_array_reserve(all->points, all->point_capacity, all->point_count + 1)) return false;
    double *at = all->points[all->point_count];
    char *end = (char *)line + 1;
    for (int k = 0; k < 3; k++) {
        at[k] = strtod(end, &end);
        all->low[k] = fmin(all->low[k], at[k]);
        all->high[k] = fmax(all->high[k], at[k]);
    }
    all->point_count++;
    return true;
}

/// Corner numbers of an OBJ polygon, from 0; 0 if one is not among the points, or there are too many.
static int read_corners(const cli_brushes *all, const char *line, size_t corners[CORNERS_MAX]) {
    int count = 0;
    for (const char *at = line + 1;;) {
        char *end;
        long number = strtol(at, &end, 10);
        if (end == at) return count;
        if (number < 1 || (size_t)number > all->point_count || count == CORNERS_MAX) return 0;
        corners[count++] = (size_t)number - 1;
        at = end + strcspn(end, " \n");
    }
}

static bool add_face(cli_brushes *all, const char *line) {
    size_t corners[CORNERS_MAX];
    int count = read_corners(all, line, corners);
    if (count < 3 || all->count == 0) return true;
    if (!enf_array_reserve(all->planes, all->plane_capacity, all->plane_count + 1)) return false;
    double normal[3] = {0, 0, 0};
    const double *origin = all->points[corners[0]];
    for (int i = 1; i + 1 < count; i++) {
        const double *p = all->points[corners[i]], *q = all->points[corners[i + 1]];
        for (int k = 0; k < 3; k++) {
            int a = (k + 1) % 3, b = (k + 2) % 3;
            normal[k] += (p[a] - origin[a]) * (q[b] - origin[b]) - (p[b] - origin[b]) * (q[a] - origin[a]);
        }
    }
    double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    if (length == 0) return true;
    double *plane = all->planes[all->plane_count++];
    plane[3] = 0;
    for (int k = 0; k < 3; k++) {
        plane[k] = normal[k] / length;
        plane[3] -= plane[k] * origin[k];
    }
    cli_brush *brush = &all->list[all->count - 1];
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            brush->low[k] = fmin(brush->low[k], all->points[corners[i]][k]);
            brush->high[k] = fmax(brush->high[k], all->points[corners[i]][k]);
        }
    }
    return true;
}

enf_status cli_brushes_read(cli_brushes *all, const char *path, enf_error *error) {
    *all = (cli_brushes){.low = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, .high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    gzFile file = gzopen(path, "rb");
    if (!file) return enf_fail(error, ENF_NO_RESOURCES, "%s: cannot be opened", path);
    char line[LINE_MAX_LENGTH];
    bool liquid = false, good = true;
    while (good && gzgets(file, line, sizeof line)) {
        if (line[0] == 'g')
            liquid = strstr(line, "liquid") != NULL;
        else if (strncmp(line, "v ", 2) == 0)
            good = add_point(all, line);
        else if (strncmp(line, "# brush", 7) == 0 && !liquid)
            good = add_brush(all);
        else if (line[0] == 'f' && !liquid)
            good = add_face(all, line);
    }
    gzclose(file);
    if (!good) return enf_fail_memory(error, "the brushes");
    if (all->plane_count > 0) return ENF_OK;
    return enf_fail(error, ENF_BAD_INPUT,
                    "%s: names no brushes; what is solid can be told from '# brush' lines only", path);
}

int cli_brushes_side(const cli_brushes *all, const double at[3], double margin) {
    int answer = -1;
    for (size_t b = 0; b < all->count; b++) {
        const cli_brush *brush = &all->list[b];
        bool beyond = false;
        for (int k = 0; k < 3; k++)
            beyond |= at[k] < brush->low[k] - margin || at[k] > brush->high[k] + margin;
        if (beyond) continue;
        size_t end = b + 1 < all->count ? all->list[b + 1].first_plane : all->plane_count;
        double highest = -HUGE_VAL;
        for (size_t p = brush->first_plane; p < end; p++) {
            const double *plane = all->planes[p];
            highest = fmax(highest, plane[0] * at[0] + plane[1] * at[1] + plane[2] * at[2] + plane[3]);
        }
        if (fabs(highest) < margin) return 0;
        if (highest < 0) answer = 1;
    }
    return answer;
}

void cli_brushes_random_point(const cli_brushes *all, uint64_t *seed, double at[3]) {
    for (int k = 0; k < 3; k++) at[k] = all->low[k] + (all->high[k] - all->low[k]) * cli_random_share(seed);
}
