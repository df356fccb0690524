// SPDX-License-Identifier: MIT
// Whole numbers of a fixed width, two's complement, lowest limb first, for the exact tier of the predicates.
// The widths are known where these are called, so that compilers unroll everything: no loop, no branch, no
// allocation. Nothing is checked: a caller shows by the degree of what it computes that its results fit.
#ifndef ENF_BASE_LIMBS_H
#define ENF_BASE_LIMBS_H

#include <stdbool.h>
#include <stdint.h>
#ifdef __x86_64__
#include <immintrin.h>
#endif

__extension__ typedef __int128 enf_int128;
__extension__ typedef unsigned __int128 enf_uint128;

#if defined __GNUC__ && !defined __clang__
#define ENF_UNROLL _Pragma("GCC unroll 8")
#else
#define ENF_UNROLL
#endif

/// a + b + carry (0 or 1), which becomes the next carry; the same for a - b - borrow.
static inline uint64_t enf_limb_add(uint64_t a, uint64_t b, unsigned char *carry) {
#ifdef __x86_64__
    unsigned long long sum;
    *carry = _addcarry_u64(*carry, a, b, &sum);
    return sum;
#else
    enf_uint128 sum = (enf_uint128)a + b + *carry;
    *carry = (unsigned char)(sum >> 64);
    return (uint64_t)sum;
#endif
}

static inline uint64_t enf_limb_subtract(uint64_t a, uint64_t b, unsigned char *borrow) {
#ifdef __x86_64__
    unsigned long long difference;
    *borrow = _subborrow_u64(*borrow, a, b, &difference);
    return difference;
#else
    enf_uint128 difference = (enf_uint128)a - b - *borrow;
    *borrow = (unsigned char)(difference >> 64) & 1;
    return (uint64_t)difference;
#endif
}

/// All ones if the number is negative, else 0.
static inline uint64_t enf_limbs_mask(const uint64_t *a, int size) {
    return -(a[size - 1] >> 63);
}

static inline bool enf_limbs_is_zero(const uint64_t *a, int size) {
    uint64_t any = 0;
    ENF_UNROLL for (int i = 0; i < size; i++) any |= a[i];
    return any == 0;
}

/// -1, 0 or +1.
static inline int enf_limbs_sign(const uint64_t *a, int size) {
    return a[size - 1] >> 63 ? -1 : !enf_limbs_is_zero(a, size);
}

static inline void enf_limbs_set(uint64_t out[2], enf_int128 value) {
    out[0] = (uint64_t)value;
    out[1] = (uint64_t)(value >> 64);
}

/// 2^64 * high + low, which must be less than 2^191 in size.
static inline void enf_limbs_set_parts(uint64_t out[3], enf_int128 high, enf_int128 low) {
    out[0] = (uint64_t)low;
    enf_limbs_set(out + 1, high + (low >> 64));
}

/// sum += a, both of the same size.
static inline void enf_limbs_add(uint64_t *sum, const uint64_t *a, int size) {
    unsigned char carry = 0;
    ENF_UNROLL for (int i = 0; i < size; i++) sum[i] = enf_limb_add(sum[i], a[i], &carry);
}

/// sum -= a & mask, the mask all ones or 0.
static inline void enf_limbs_subtract_masked(uint64_t *sum, const uint64_t *a, uint64_t mask, int size) {
    unsigned char borrow = 0;
    ENF_UNROLL for (int i = 0; i < size; i++) sum[i] = enf_limb_subtract(sum[i], a[i] & mask, &borrow);
}

static inline void enf_limbs_subtract(uint64_t *sum, const uint64_t *a, int size) {
    enf_limbs_subtract_masked(sum, a, UINT64_MAX, size);
}

/// out = a * b, in a_size + b_size limbs; out is neither a nor b. Schoolbook (Knuth, The Art of Computer
/// Programming 2, 4.3.1): at these sizes nothing is faster.
static inline void enf_limbs_multiply(uint64_t *out, const uint64_t *a, int a_size, const uint64_t *b,
                                      int b_size) {
    ENF_UNROLL for (int j = 0; j < b_size; j++) out[j] = 0;
    ENF_UNROLL for (int i = 0; i < a_size; i++) {
        uint64_t carry = 0;
        ENF_UNROLL for (int j = 0; j < b_size; j++) {
            enf_uint128 limb = (enf_uint128)a[i] * b[j] + out[i + j] + carry;
            out[i + j] = (uint64_t)limb;
            carry = (uint64_t)(limb >> 64);
        }
        out[i + b_size] = carry;
    }
    // What was taken as 2^(64 size) + a, for a negative a, was too much by 2^(64 size) * b; the same for b.
    enf_limbs_subtract_masked(out + a_size, b, enf_limbs_mask(a, a_size), b_size);
    enf_limbs_subtract_masked(out + b_size, a, enf_limbs_mask(b, b_size), a_size);
}

/// a / b rounded to double (within 5 units in the last place); b must not be 0.
double enf_limbs_quotient(const uint64_t *a, int a_size, const uint64_t *b, int b_size);

#endif
