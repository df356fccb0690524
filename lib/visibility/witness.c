// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/witness.h"

#include "base/array.h"

#include <inttypes.h>
#include <stdlib.h>

typedef struct entry {
    int32_t cells[2];
    int64_t witness;
} entry;

static int compare(const void *a, const void *b) {
    const entry *x = a, *y = b;
    for (int i = 0; i < 2; i++)
        if (x->cells[i] != y->cells[i]) return x->cells[i] < y->cells[i] ? -1 : 1;
    return x->witness < y->witness ? -1 : x->witness > y->witness;
}

static void print_line(const enf_visibility *visibility, const entry *entry, FILE *out) {
    const enf_line *line = &visibility->witnesses[entry->witness];
    const char *long_line = visibility->long_witnesses ? visibility->long_witnesses[entry->witness] : NULL;
    const double *from = line->from, *to = line->to;
    fprintf(out, "%" PRId32 " %" PRId32 " ", entry->cells[0], entry->cells[1]);
    if (long_line)
        fprintf(out, "%s\n", long_line);
    else
        fprintf(out, "%.17g %.17g %.17g %.17g %.17g %.17g\n", from[0], from[1], from[2], to[0], to[1], to[2]);
}

enf_status enf_witnesses_print(const enf_visibility *visibility, FILE *out, enf_error *error) {
    size_t count = (size_t)visibility->witness_count;
    entry *entries = enf_array_new(count, sizeof *entries);
    if (!entries) return enf_fail_memory(error, "the witnesses");
    for (size_t i = 0; i < count; i++) {
        const int32_t *cells = visibility->witness_cells[i];
        entries[i] = (entry){{cells[0], cells[1]}, (int64_t)i};
    }
    qsort(entries, count, sizeof *entries, compare);
    for (size_t i = 0; i < count && !ferror(out); i++) print_line(visibility, &entries[i], out);
    free(entries);
    return ENF_OK;
}
