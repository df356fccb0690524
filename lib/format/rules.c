// SPDX-License-Identifier: MIT
// Each rule looks at blocks of numbers without a branch, so that compilers use wide registers and the pass
// runs as fast as memory; only what is left, and a bad block, is looked at one by one.
#include "format/rules.h"

#include <math.h>

enum { BLOCK = 256 };

static int64_t find_bad_index(const int32_t *values, int64_t count, int32_t lowest, int64_t end) {
    if (end <= lowest) return count ? 0 : -1;
    uint32_t span = (uint32_t)(end - lowest), bad = 0;
    int64_t i = 0;
    for (; count - i >= BLOCK && !bad; i += bad ? 0 : BLOCK)
        for (int k = 0; k < BLOCK; k++) bad |= (uint32_t)values[i + k] - (uint32_t)lowest >= span;
    while (i < count && (uint32_t)values[i] - (uint32_t)lowest < span) i++;
    return i < count ? i : -1;
}

static int64_t find_bad_offset32(const int32_t *offsets, int64_t count, int64_t end) {
    uint32_t bad = 0;
    int64_t i = 0;
    if (offsets[0] != 0) return 0;
    for (; count - i >= BLOCK && !bad; i += bad ? 0 : BLOCK)
        for (int k = 0; k < BLOCK; k++) bad |= offsets[i + k + 1] < offsets[i + k];
    while (i < count && offsets[i + 1] >= offsets[i]) i++;
    if (i < count) return i + 1;
    return offsets[count] == end ? -1 : count;
}

static int64_t find_bad_offset64(const int64_t *offsets, int64_t count, int64_t end) {
    if (offsets[0] != 0) return 0;
    for (int64_t i = 0; i < count; i++)
        if (offsets[i + 1] < offsets[i]) return i + 1;
    return offsets[count] == end ? -1 : count;
}

static int64_t find_bad_corner(const enf_file_view *view, const enf_file_corner *corners, int64_t count) {
    uint32_t vertices = (uint32_t)view->vertex_count, planes = (uint32_t)view->plane_count, bad = 0;
    int64_t i = 0;
    for (; count - i >= BLOCK && !bad; i += bad ? 0 : BLOCK)
        for (int k = 0; k < BLOCK; k++)
            bad |= ((uint32_t)corners[i + k].vertex >= vertices) |
                   ((uint32_t)corners[i + k].edge_plane >= planes);
    while (i < count && (uint32_t)corners[i].vertex < vertices && (uint32_t)corners[i].edge_plane < planes)
        i++;
    return i < count ? i : -1;
}

static int64_t find_bad_flag(const uint8_t *values, int64_t count) {
    uint8_t all = 0;
    int64_t i = 0;
    for (; count - i >= BLOCK && all <= 1; i += all <= 1 ? BLOCK : 0)
        for (int k = 0; k < BLOCK; k++) all |= values[i + k];
    while (i < count && values[i] <= 1) i++;
    return i < count ? i : -1;
}

// NaN compares false with everything, so it is found as well.
int64_t enf_find_bad_double(const double *values, int64_t count, double largest) {
    uint64_t bad = 0;
    int64_t i = 0;
    for (; count - i >= BLOCK && !bad; i += bad ? 0 : BLOCK)
        for (int k = 0; k < BLOCK; k++) bad |= !(fabs(values[i + k]) <= largest);
    while (i < count && fabs(values[i]) <= largest) i++;
    return i < count ? i : -1;
}

int64_t enf_find_bad_element(const enf_file_view *view, const enf_section_spec *spec) {
    const void *array = enf_view_array(view, spec);
    int64_t count = enf_view_count(view, spec->dimension), target = enf_view_count(view, spec->target);
    int64_t numbers = count * (spec->element_size / sizeof(int32_t)), bad = -1;
    switch ((enf_rule)spec->rule) {
    case ENF_RULE_NONE:
        break;
    case ENF_RULE_INDEX:
        bad = find_bad_index(array, numbers, spec->lowest, target);
        return bad < 0 ? bad : bad / (int64_t)(spec->element_size / sizeof(int32_t));
    case ENF_RULE_OFFSETS32:
        return find_bad_offset32(array, count, target);
    case ENF_RULE_OFFSETS64:
        return find_bad_offset64(array, count, target);
    case ENF_RULE_CORNERS:
        return find_bad_corner(view, array, count);
    case ENF_RULE_FLAG:
        return find_bad_flag(array, count);
    case ENF_RULE_FINITE:
    case ENF_RULE_GRID:
        bad = enf_find_bad_double(array, numbers / 2,
                                  spec->rule == ENF_RULE_GRID ? ENF_FILE_GRID_MAX : 0x1p1000);
        return bad < 0 ? bad : bad / (int64_t)(spec->element_size / sizeof(double));
    }
    return -1;
}
