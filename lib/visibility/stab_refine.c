// SPDX-License-Identifier: GPL-3.0-or-later
// From knowing that there is a line to a line that anybody can check: between doubles if there are such, or
// else in as many digits as it takes.
#include "visibility/stab_fine.h"

#include <stdlib.h>

enum { BITS = 256, BITS_MOST = 1 << 14 };

/// So many bits are good for so many digits, and some are left for rounding.
static int digits_of(mp_bitcnt_t bits) {
    return (int)(bits * 15 / 64);
}

static void keep_text(enf_stabber *stabber, enf_stab *stab, char *text) {
    free(stabber->long_line);
    stabber->long_line = text;
    stab->long_line = text;
    stabber->counts.lines_long++;
}

/// One attempt with so many bits. False without memory.
static bool attempt(enf_stabber *stabber, enf_fine *fine, enf_stab *stab) {
    bool passes;
    enf_fine_start(fine, stabber);
    if (!enf_fine_centre(fine, stabber, &passes)) return false;
    if (!passes) return true;
    if (enf_fine_round(fine, stabber, &stab->line)) {
        stab->has_line = true;
        stabber->counts.lines_fine++;
        return true;
    }
    char *text = enf_fine_text(fine, stabber, digits_of(fine->bits));
    if (!text) return false;
    if (enf_stabber_passes_text(stabber, text))
        keep_text(stabber, stab, text);
    else
        free(text);
    return true;
}

enf_status enf_stabber_refine(enf_stabber *stabber, enf_stab *stab, enf_error *error) {
    bool done = true;
    for (mp_bitcnt_t bits = BITS; done && bits <= BITS_MOST && !stab->has_line && !stab->long_line;
         bits *= 2) {
        enf_fine fine;
        enf_fine_init(&fine, bits);
        done = attempt(stabber, &fine, stab);
        enf_fine_clear(&fine);
    }
    return done ? ENF_OK : enf_fail_memory(error, "a line in many digits");
}
