// SPDX-License-Identifier: GPL-3.0-or-later
// How a cost grows with a size.
#ifndef ENF_CLI_EXPONENT_H
#define ENF_CLI_EXPONENT_H

#include <stddef.h>

/// The power of the sizes that the costs, all above 0, grow like: the slope of log cost over log size, by
/// least squares; NaN for fewer than two sizes.
double cli_exponent_fit(const double *sizes, const double *costs, size_t count);

#endif
