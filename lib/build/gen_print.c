// SPDX-License-Identifier: GPL-3.0-or-later
// Prints a test world as OBJ: coordinates in the fewest digits that read back as the same double.
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "build/gen_world.h"

// A caller's locale may use a decimal comma; the file does not.
static void print_number(double value, FILE *out) {
    char text[40];
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value) break;
    }
    for (char *c = text; *c; c++)
        if (!strchr("0123456789.+-e", *c)) *c = '.';
    fputs(text, out);
}

static void print_point(const char *prefix, const double point[3], FILE *out) {
    fputs(prefix, out);
    for (int a = 0; a < 3; a++) {
        putc(' ', out);
        print_number(point[a], out);
    }
}

// Triangles group by group, in the order they were made.
static bool print_triangles(const enf_gen_world *world, FILE *out) {
    size_t *start = enf_array_zeroed(world->group_count + 1, sizeof *start);
    int32_t *order = enf_array_new(world->triangle_count, sizeof *order);
    bool done = start && order;
    if (done) {
        for (size_t i = 0; i < world->triangle_count; i++) start[world->triangle_group[i] + 1]++;
        for (size_t g = 0; g < world->group_count; g++) start[g + 1] += start[g];
        for (size_t i = 0; i < world->triangle_count; i++)
            order[start[world->triangle_group[i]]++] = (int32_t)i;
        for (size_t g = 0; g < world->group_count; g++) { // start[g] is now where group g ends
            size_t first = g ? start[g - 1] : 0;
            if (first == start[g]) continue;
            fprintf(out, "g %s\n", world->groups[g]);
            for (size_t i = first; i < start[g]; i++) {
                const int32_t *corners = world->triangles[order[i]];
                fprintf(out, "f %d %d %d\n", corners[0] + 1, corners[1] + 1, corners[2] + 1);
            }
        }
    }
    free(start);
    free(order);
    return done;
}

bool enf_gen_print(const enf_gen_world *world, const char *name, const char *const *settings,
                   size_t setting_count, FILE *out) {
    fprintf(out, "# enfilade gen %s", name);
    for (size_t i = 0; i < setting_count; i++) fprintf(out, " %s", settings[i]);
    fprintf(out, "\n# %zu vertices, %zu triangles\n", world->point_count, world->triangle_count);
    for (size_t i = 0; i < world->spawn_count; i++) {
        print_point("# spawn", world->spawns[i], out);
        fprintf(out, " room-%zu\n", i + 1);
    }
    fprintf(out, "o %s\n", name);
    for (size_t i = 0; i < world->point_count; i++) {
        print_point("v", world->points[i], out);
        putc('\n', out);
    }
    return print_triangles(world, out) && fflush(out) == 0 && !ferror(out);
}
