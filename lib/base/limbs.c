// SPDX-License-Identifier: MIT
#include "base/limbs.h"

#include <math.h>

enum { SIZE_MAX_LIMBS = 8 };

/// The number without its exponent. The leading 128 bits suffice for a double: what lies below can change it
/// by at most one unit in the last place.
static double leading(const uint64_t *a, int size, int *exponent) {
    uint64_t magnitude[SIZE_MAX_LIMBS], mask = enf_limbs_mask(a, size), carry = mask & 1;
    for (int i = 0; i < size; i++) {
        magnitude[i] = (a[i] ^ mask) + carry;
        carry = carry && magnitude[i] == 0;
    }
    while (size > 0 && magnitude[size - 1] == 0) size--;
    double value = 0;
    int lowest = size > 2 ? size - 2 : 0;
    for (int i = size - 1; i >= lowest; i--) value = value * 0x1p64 + (double)magnitude[i];
    *exponent = 64 * lowest;
    return mask ? -value : value;
}

double enf_limbs_quotient(const uint64_t *a, int a_size, const uint64_t *b, int b_size) {
    int a_exponent, b_exponent;
    double above = leading(a, a_size, &a_exponent), below = leading(b, b_size, &b_exponent);
    return ldexp(above / below, a_exponent - b_exponent);
}
