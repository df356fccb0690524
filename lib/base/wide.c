// SPDX-License-Identifier: MIT
// Schoolbook arithmetic (Knuth, The Art of Computer Programming 2, 4.3.1): at eight limbs nothing is faster.
#include "base/wide.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

void enf_wide_set(enf_wide *result, enf_int128 value) {
    enf_uint128 magnitude = value < 0 ? -(enf_uint128)value : (enf_uint128)value;
    result->limb[0] = (uint64_t)magnitude;
    result->limb[1] = (uint64_t)(magnitude >> 64);
    result->size = result->limb[1] ? 2 : result->limb[0] ? 1 : 0;
    result->sign = value > 0 ? 1 : value < 0 ? -1 : 0;
}

void enf_wide_set_parts(enf_wide *result, enf_int128 high, enf_int128 low) {
    high += low >> 64;
    uint64_t limb = (uint64_t)low;
    result->sign = high < 0 ? -1 : high > 0 || limb ? 1 : 0;
    if (high < 0) {
        high = ~high + (limb == 0);
        limb = -limb;
    }
    result->limb[0] = limb;
    result->limb[1] = (uint64_t)high;
    result->limb[2] = (uint64_t)(high >> 64);
    result->size = result->limb[2] ? 3 : result->limb[1] ? 2 : limb ? 1 : 0;
}

static int compare_magnitudes(const enf_wide *a, const enf_wide *b) {
    if (a->size != b->size) return a->size < b->size ? -1 : 1;
    for (int i = a->size - 1; i >= 0; i--) {
        if (a->limb[i] != b->limb[i]) return a->limb[i] < b->limb[i] ? -1 : 1;
    }
    return 0;
}

static void add_magnitudes(enf_wide *result, const enf_wide *a, const enf_wide *b, int sign) {
    if (a->size < b->size) {
        const enf_wide *swap = a;
        a = b;
        b = swap;
    }
    int size = a->size, common = b->size;
    uint64_t carry = 0;
    for (int i = 0; i < size; i++) {
        enf_uint128 sum = (enf_uint128)a->limb[i] + (i < common ? b->limb[i] : 0) + carry;
        result->limb[i] = (uint64_t)sum;
        carry = (uint64_t)(sum >> 64);
    }
    if (carry) {
        assert(size < ENF_WIDE_LIMBS);
        result->limb[size++] = carry;
    }
    result->size = size;
    result->sign = sign;
}

/// |a| > |b|
static void subtract_magnitudes(enf_wide *result, const enf_wide *a, const enf_wide *b, int sign) {
    int size = a->size, common = b->size;
    uint64_t borrow = 0;
    for (int i = 0; i < size; i++) {
        uint64_t take = i < common ? b->limb[i] : 0, from = a->limb[i];
        uint64_t difference = from - take - borrow;
        borrow = from < take || (from == take && borrow);
        result->limb[i] = difference;
    }
    while (size > 0 && result->limb[size - 1] == 0) size--;
    result->size = size;
    result->sign = sign;
}

static void add_signed(enf_wide *result, const enf_wide *a, const enf_wide *b, int b_sign) {
    if (b_sign == 0) {
        if (result != a) *result = *a;
    } else if (a->sign == 0) {
        if (result != b) *result = *b;
        result->sign = b_sign;
    } else if (a->sign == b_sign) {
        add_magnitudes(result, a, b, a->sign);
    } else {
        int order = compare_magnitudes(a, b);
        if (order == 0) {
            result->size = result->sign = 0;
        } else if (order > 0) {
            subtract_magnitudes(result, a, b, a->sign);
        } else {
            subtract_magnitudes(result, b, a, b_sign);
        }
    }
}

void enf_wide_add(enf_wide *result, const enf_wide *a, const enf_wide *b) {
    add_signed(result, a, b, b->sign);
}

void enf_wide_subtract(enf_wide *result, const enf_wide *a, const enf_wide *b) {
    add_signed(result, a, b, -b->sign);
}

void enf_wide_multiply(enf_wide *result, const enf_wide *a, const enf_wide *b) {
    const int a_size = a->size, b_size = b->size;
    result->sign = a->sign * b->sign;
    result->size = 0;
    if (result->sign == 0 || a_size < 1 || b_size < 1) return; // no number other than 0 has no limbs
    uint64_t limb[2 * ENF_WIDE_LIMBS], carry = 0;
    for (int j = 0; j < b_size; j++) {
        enf_uint128 sum = (enf_uint128)a->limb[0] * b->limb[j] + carry;
        limb[j] = (uint64_t)sum;
        carry = (uint64_t)(sum >> 64);
    }
    limb[b_size] = carry;
    for (int i = 1; i < a_size; i++) {
        carry = 0;
        for (int j = 0; j < b_size; j++) {
            enf_uint128 sum = (enf_uint128)a->limb[i] * b->limb[j] + limb[i + j] + carry;
            limb[i + j] = (uint64_t)sum;
            carry = (uint64_t)(sum >> 64);
        }
        limb[i + b_size] = carry;
    }
    int size = a_size + b_size;
    size -= limb[size - 1] == 0; // the highest limbs of the factors are not 0
    assert(size <= ENF_WIDE_LIMBS);
    for (int i = 0; i < size; i++) result->limb[i] = limb[i];
    result->size = size;
}

void enf_wide_add_product(enf_wide *result, const enf_wide *a, const enf_wide *b) {
    enf_wide product;
    enf_wide_multiply(&product, a, b);
    add_signed(result, result, &product, product.sign);
}

void enf_wide_subtract_product(enf_wide *result, const enf_wide *a, const enf_wide *b) {
    enf_wide product;
    enf_wide_multiply(&product, a, b);
    add_signed(result, result, &product, -product.sign);
}

/// The leading 128 bits suffice for a double: what lies below can change it by at most one unit in the last
/// place.
static double leading(const enf_wide *a, int *exponent) {
    double value = 0;
    int lowest = a->size > 2 ? a->size - 2 : 0;
    for (int i = a->size - 1; i >= lowest; i--) value = value * 0x1p64 + (double)a->limb[i];
    *exponent = 64 * lowest;
    return a->sign < 0 ? -value : value;
}

double enf_wide_quotient(const enf_wide *a, const enf_wide *b) {
    int a_exponent, b_exponent;
    double above = leading(a, &a_exponent), below = leading(b, &b_exponent);
    return ldexp(above / below, a_exponent - b_exponent);
}
