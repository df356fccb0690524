// SPDX-License-Identifier: GPL-3.0-or-later
// The text of visible sets, read back: to compare one result with another.
#include "build/read.h"
#include "visibility/pvs.h"

#include <inttypes.h>

static enf_status fail_cell(const enf_source *source, int64_t cell, int32_t cell_count, enf_error *error) {
    return enf_fail(error, ENF_BAD_INPUT,
                    "%s:%" PRId64 ": there is no cell %" PRId64 "; they are numbered 0 to %" PRId32,
                    source->name, source->line, cell, cell_count - 1);
}

static enf_status read_row(enf_pvs *pvs, enf_source *source, int32_t from, enf_error *error) {
    int64_t last = -1, to;
    bool sees_itself = false;
    while (enf_source_more(source)) {
        if (!enf_source_whole(source, &to) || !enf_source_word_ends(source))
            return enf_source_fail(source, error,
                                   "the number of a cell should stand here; make the file again");
        if (to < 0 || to >= pvs->cell_count) return fail_cell(source, to, pvs->cell_count, error);
        if (to <= last)
            return enf_source_fail(source, error, "the numbers do not ascend; make the file again");
        enf_pvs_set(pvs, from, (int32_t)to);
        sees_itself |= to == from;
        last = to;
    }
    if (sees_itself) return ENF_OK;
    return enf_fail(error, ENF_BAD_INPUT,
                    "%s:%" PRId64 ": cell %" PRId32 " does not see itself; make the file again", source->name,
                    source->line, from);
}

static enf_status read_rows(enf_pvs *pvs, enf_source *source, enf_error *error) {
    bool more = source->size > 0;
    for (int32_t i = 0; i < pvs->cell_count; i++) {
        if (!more)
            return enf_fail(error, ENF_BAD_INPUT,
                            "%s:%" PRId64 ": the file ends before cell %" PRId32 " of %" PRId32
                            "; is it truncated?",
                            source->name, source->line, i, pvs->cell_count);
        enf_status status = read_row(pvs, source, i, error);
        if (status) return status;
        more = enf_source_next_line(source);
    }
    if (!more) return ENF_OK;
    return enf_fail(error, ENF_BAD_INPUT,
                    "%s:%" PRId64 ": there are more lines than the %" PRId32
                    " cells; is it about another world?",
                    source->name, source->line, pvs->cell_count);
}

enf_status enf_pvs_read(enf_pvs *pvs, const char *path, int32_t cell_count, enf_error *error) {
    enf_source source;
    *pvs = (enf_pvs){0};
    enf_status status = enf_source_open(&source, path, error);
    if (!status) status = enf_pvs_new(pvs, cell_count, error);
    if (!status) status = read_rows(pvs, &source, error);
    enf_source_close(&source);
    return status;
}
