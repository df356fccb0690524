// SPDX-License-Identifier: GPL-3.0-or-later
// The oracle for stabbing: CGAL's numbers, CGAL's linear programs, and a decision about real lines that goes
// another way than the library's. It shares no code with the library.
#ifndef ENF_TESTS_ORACLE_STAB_H
#define ENF_TESTS_ORACLE_STAB_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/// An edge a line must pass so that det(to - from, a - from, b - from) > 0.
typedef struct oracle_edge {
    double a[3], b[3];
} oracle_edge;

/// Does the line pass all edges?
bool oracle_stab_passes(const oracle_edge *edges, int count, const double from[3], const double to[3]);

/// The same for a line of six decimals, `x y z x y z`, as they stand; false as well if it is not that.
bool oracle_stab_passes_text(const oracle_edge *edges, int count, const char *line);

/// Is there an x in R^6, line or not, that passes all edges?
bool oracle_stab_program(const oracle_edge *edges, int count);

/// Is there a real line that passes all edges? oracle_stab_program must have said yes.
bool oracle_stab_line(const oracle_edge *edges, int count);

/// How many rays has the cone {x : <x, side> >= 0 for all sides} of whole numbers? 0 if the sides span fewer
/// than six dimensions. *falls: is sign * (x0 x3 + x1 x4 + x2 x5) below 0 anywhere in it?
int oracle_stab_cone(const double (*sides)[6], int count, int sign, bool *falls);

#ifdef __cplusplus
}
#endif
#endif
