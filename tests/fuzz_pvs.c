// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzz target for visibility (libFuzzer: clang -fsanitize=fuzzer,address,undefined; also called by
// test_visibility.c with mutated graphs): bytes become a small portal graph, portals crossing, touching,
// bent, anywhere; each rung must end, with symmetric sets, each in the one before.
#include "visibility/visibility.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { CELLS = 7, OPENINGS_MOST = 12 };

typedef struct bytes {
    const uint8_t *at, *end;
} bytes;

static void require(bool promise) {
    if (!promise) abort();
}

static int take(bytes *bytes) {
    return bytes->at < bytes->end ? *bytes->at++ : 0;
}

/// Mostly small whole numbers, so that much touches; some anything.
static double take_number(bytes *bytes) {
    int kind = take(bytes);
    double value = (signed char)take(bytes);
    if (kind == 1) return value * 1e-9;
    if (kind == 2) return value * 1e90;
    if (kind == 3) return value / 3;
    if (kind == 4) return value + 0x1p-40;
    return value / 16;
}

static bool add_opening(enf_portal_graph *graph, bytes *bytes) {
    int32_t cells = take(bytes), from = cells % CELLS, to = cells / CELLS % CELLS,
            count = 3 + take(bytes) % 3;
    double corners[5][3];
    for (int32_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++) corners[i][axis] = take_number(bytes);
    return from == to || enf_portal_graph_add(graph, from, to, (const double(*)[3])corners, count);
}

/// The corners may be in no plane and in no order: that is for the tests of conservativeness to say; here
/// nothing may break.
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    bytes bytes = {data, data + size};
    enf_portal_graph graph = {.cell_count = CELLS};
    enf_error error = {0};
    bool good = true;
    for (int i = 0; good && i < OPENINGS_MOST && bytes.at < bytes.end; i++)
        good = add_opening(&graph, &bytes);
    enf_visibility outer = {0}, inner = {0};
    good = good && !enf_portal_graph_finish(&graph, &error);
    for (int method = 0; good && method < ENF_METHOD_COUNT; method++) {
        const enf_visibility_options options = {
            .method = (enf_method)method, .threads = 1, .want_witnesses = true};
        good = !enf_visibility_run(&inner, &graph, &options, &error);
        for (int32_t i = 0; good && i < CELLS; i++)
            for (int32_t j = 0; j < CELLS; j++) {
                require(enf_pvs_get(&inner.pvs, i, j) == enf_pvs_get(&inner.pvs, j, i));
                require(!method || !enf_pvs_get(&inner.pvs, i, j) || enf_pvs_get(&outer.pvs, i, j));
            }
        enf_visibility_free(&outer);
        outer = inner;
        inner = (enf_visibility){0};
    }
    enf_visibility_free(&outer);
    enf_portal_graph_free(&graph);
    return 0;
}
