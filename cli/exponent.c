// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/exponent.h"

#include <math.h>

double cli_exponent_fit(const double *sizes, const double *costs, size_t count) {
    double x = 0, y = 0, xx = 0, xy = 0;
    for (size_t i = 0; i < count; i++) {
        const double u = log(sizes[i]), v = log(costs[i]);
        x += u, y += v, xx += u * u, xy += u * v;
    }
    const double n = (double)count;
    return count < 2 ? NAN : (n * xy - x * y) / (n * xx - x * x);
}
