// SPDX-License-Identifier: GPL-3.0-or-later
// The ladder: a hint; the shortest vector of the hull in doubles, whose outcome is proved by error bounds or
// by whole numbers; else the program in whole numbers. For real lines: a search from the program's solution,
// then the quadric in whole numbers.
#include "visibility/stab_parts.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

enf_stabber *enf_stabber_new(const enf_pluecker *pluecker) {
    enf_stabber *stabber = enf_array_zeroed(1, sizeof *stabber);
    if (!stabber) return NULL;
    stabber->pluecker = pluecker;
    for (int i = 0; i < ENF_PLUECKER; i++) mpz_init(stabber->point[i]);
    enf_quadric_init(&stabber->quadric);
    return stabber;
}

void enf_stabber_free(enf_stabber *stabber) {
    if (!stabber) return;
    for (int32_t k = 0; k < stabber->whole_count; k++) {
        for (int i = 0; i < ENF_PLUECKER; i++) mpz_clear(stabber->whole[k][i]);
    }
    for (int i = 0; i < ENF_PLUECKER; i++) mpz_clear(stabber->point[i]);
    enf_quadric_free(&stabber->quadric);
    free(stabber->whole);
    free(stabber->sides);
    free(stabber->order);
    free(stabber->sources);
    free(stabber->vectors);
    free(stabber->products);
    free(stabber->long_line);
    free(stabber);
}

const enf_stab_counts *enf_stabber_counts(const enf_stabber *stabber) {
    return &stabber->counts;
}

/// Does a certificate show that there is no solution?
static bool is_certain(enf_stabber *stabber) {
    int32_t members[ENF_HULL_MAX];
    if (enf_stabber_zero_by_double(stabber)) {
        stabber->counts.zero_by_double++;
        return true;
    }
    const int count = enf_stabber_members(stabber, members);
    if (enf_stabber_zero_by_small(stabber, members, count)) {
        stabber->counts.zero_by_small++;
        return true;
    }
    if (!enf_stabber_zero_by_whole(stabber, members, count)) return false;
    stabber->counts.zero_by_whole++;
    return true;
}

/// Is there a strict solution? Then hull.x is one, or `point`.
static enf_status decide_program(enf_stabber *stabber, const enf_line *start, bool *feasible,
                                 enf_error *error) {
    double x[ENF_PLUECKER];
    stabber->hull = (enf_min_norm){0};
    if (!stabber->rough) {
        enf_stabber_coordinates(stabber, start, x);
        *feasible =
            enf_min_norm_find(stabber->vectors, stabber->edge_count, stabber->capacity, x, ENF_STAB_MARGIN, 0,
                              stabber->products, &stabber->hull) == ENF_MIN_NORM_POSITIVE;
        if (*feasible || is_certain(stabber)) return ENF_OK;
    }
    stabber->counts.programs++;
    if (!enf_stabber_order(stabber) || !enf_stabber_whole_edges(stabber))
        return enf_fail_memory(error, "a portal sequence's edges");
    *feasible = !enf_stabber_program(stabber);
    return ENF_OK;
}

static void set_line(enf_stab *stab, const enf_line *line) {
    *stab = (enf_stab){.answer = ENF_STAB_VISIBLE, .has_line = true, .line = *line};
}

static void count_size(enf_stabber *stabber) {
    int size = 0;
    while (size < ENF_STAB_SIZES - 1 && stabber->edge_count >= 8 << size) size++;
    stabber->counts.sizes[size]++;
}

/// The hint, and whether the relaxation has a solution: HIDDEN, OPEN or VISIBLE.
static enf_status begin(enf_stabber *stabber, const int32_t *sequence, int32_t count, const enf_line *hint,
                        enf_stab *stab, enf_error *error) {
    bool feasible = false;
    *stab = (enf_stab){.answer = ENF_STAB_HIDDEN};
    stabber->counts.calls++;
    stabber->sequence = sequence;
    stabber->count = count;
    if (hint && enf_stabber_passes(stabber, hint)) {
        stabber->counts.hints++;
        set_line(stab, hint);
        return ENF_OK;
    }
    if (!enf_stabber_take(stabber, sequence, count))
        return enf_fail_memory(error, "a portal sequence's edges");
    count_size(stabber);
    enf_line guess = hint ? *hint : enf_stabber_guess(stabber);
    enf_status status = decide_program(stabber, &guess, &feasible, error);
    if (status == ENF_OK && feasible) stab->answer = ENF_STAB_OPEN;
    return status;
}

enf_status enf_stab_lp(enf_stabber *stabber, const int32_t *sequence, int32_t count, const enf_line *hint,
                       enf_stab *stab, enf_error *error) {
    enf_line line;
    enf_status status = begin(stabber, sequence, count, hint, stab, error);
    if (status != ENF_OK || stab->answer != ENF_STAB_OPEN || stabber->point_is_whole) return status;
    if (enf_stabber_line(stabber, stabber->hull.x, &line) && enf_stabber_passes(stabber, &line))
        set_line(stab, &line);
    return ENF_OK;
}

enf_status enf_stab_exact(enf_stabber *stabber, const int32_t *sequence, int32_t count, const enf_line *hint,
                          enf_stab *stab, enf_error *error) {
    enf_line line;
    bool meets;
    enf_status status = begin(stabber, sequence, count, hint, stab, error);
    if (status != ENF_OK || stab->answer != ENF_STAB_OPEN) return status;
    if (!stabber->point_is_whole && enf_stabber_search(stabber, &line)) {
        set_line(stab, &line);
        return ENF_OK;
    }
    stabber->counts.quadrics++;
    status = enf_stabber_quadric(stabber, &meets, error);
    if (status != ENF_OK) return status;
    stabber->counts.quadrics_hidden += !meets;
    stab->answer = meets ? ENF_STAB_VISIBLE : ENF_STAB_HIDDEN;
    if (!meets) return ENF_OK;
    if (enf_stabber_line(stabber, stabber->hull.x, &line) && enf_stabber_passes(stabber, &line))
        set_line(stab, &line);
    else if (stabber->has_meeting)
        status = enf_stabber_refine(stabber, stab, error);
    stabber->counts.lines_missing += !stab->has_line && !stab->long_line;
    return status;
}
