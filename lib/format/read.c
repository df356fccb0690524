// SPDX-License-Identifier: MIT
// Header, section table and checksums; validate.c looks at what the sections say.
#include "format/read.h"

#include "base/hash.h"
#include "format/sections.h"

#include <string.h>

_Static_assert(sizeof(enf_file_header) == 64, "header layout");
_Static_assert(sizeof(enf_file_section) == 48, "section layout");
_Static_assert(sizeof(enf_file_provenance) == 152, "provenance layout");
_Static_assert(sizeof(enf_file_frame) == 136, "frame layout");
_Static_assert(sizeof(enf_file_turn) == 72, "turn layout");
_Static_assert(sizeof(enf_file_region) == 32, "region layout");
_Static_assert(sizeof(enf_file_spawn) == 32, "spawn layout");
_Static_assert(sizeof(enf_file_cell) == 80, "cell layout");
_Static_assert(sizeof(enf_file_portal) == 48, "portal layout");
_Static_assert(sizeof(enf_file_portal_polygon) == 56, "portal polygon layout");
_Static_assert(sizeof(enf_file_box) == 32, "box layout");
_Static_assert(sizeof(enf_file_triangle) == 56, "triangle layout");
_Static_assert(sizeof(enf_file_start) == 64, "start layout");
_Static_assert(sizeof(enf_file_sight) == 56, "sight layout");
_Static_assert(sizeof(enf_file_barrier) == 40, "barrier layout");
_Static_assert(sizeof(enf_file_barrier_node) == 112, "barrier node layout");

#define PARTS (ENF_PART_NEEDED + 1)

static enf_status damaged(enf_error *error, const char *what) {
    return enf_fail(error, ENF_BAD_INPUT, "not a usable world file: %s; compile the world again", what);
}

static enf_status check_header(const enf_file_header *header, size_t size, enf_error *error) {
    if (size < sizeof *header || memcmp(header->magic, ENF_FILE_MAGIC, sizeof header->magic) != 0)
        return enf_fail(error, ENF_BAD_INPUT,
                        "this is not a world file (.enf); make one with `enfilade compile`");
    if (header->major != ENF_FILE_MAJOR)
        return enf_fail(error, ENF_BAD_INPUT,
                        "the file has format version %u.%u, this program reads %u.x; %s",
                        (unsigned)header->major, (unsigned)header->minor, (unsigned)ENF_FILE_MAJOR,
                        header->major > ENF_FILE_MAJOR ? "use a newer program" : "compile the world again");
    if (header->header_checksum != enf_hash64(header, offsetof(enf_file_header, header_checksum), 0))
        return damaged(error, "its header is damaged");
    if (header->file_size != size)
        return enf_fail(error, ENF_BAD_INPUT,
                        "the file is incomplete: it has %llu of %llu bytes; copy or compile it again",
                        (unsigned long long)size, (unsigned long long)header->file_size);
    if (header->header_size < sizeof *header || header->entry_size != sizeof(enf_file_section))
        return damaged(error, "its header has a size that this version never writes");
    uint64_t table = header->table_offset, table_size = (uint64_t)header->section_count * header->entry_size;
    if (table < header->header_size || table % ENF_FILE_ALIGNMENT || table > size ||
        table_size > size - table)
        return damaged(error, "its section table lies outside of the file");
    if (header->table_checksum != enf_hash64((const uint8_t *)header + table, (size_t)table_size, 0))
        return damaged(error, "its section table is damaged");
    return ENF_OK;
}

static const enf_section_spec *find_spec(const char tag[8]) {
    for (int i = 0; i < enf_section_spec_count; i++) {
        if (strncmp(tag, enf_section_specs[i].tag, 8) == 0) return &enf_section_specs[i];
    }
    return NULL;
}

static enf_status section_fails(enf_error *error, const enf_section_spec *spec, const char *what) {
    return enf_fail(error, ENF_BAD_INPUT, "not a usable world file: section %s %s; compile the world again",
                    spec->tag, what);
}

/// Places a known section in the view. `counted` tells which dimensions have their count already.
static enf_status place_section(enf_file_view *view, const enf_file_section *section,
                                const enf_section_spec *spec, bool *counted, bool skip_checksums,
                                enf_error *error) {
    if (enf_view_array(view, spec)) return section_fails(error, spec, "is there twice");
    if (section->element_size != spec->element_size || section->count > section->size ||
        section->count * section->element_size != section->size)
        return section_fails(error, spec, "has a wrong size");
    if (section->count < spec->extra) return section_fails(error, spec, "is empty");
    const uint8_t *bytes = view->bytes + section->offset;
    if (!skip_checksums && enf_hash64(bytes, (size_t)section->size, 0) != section->checksum)
        return section_fails(error, spec, "is damaged (wrong checksum)");

    uint64_t count = section->count - spec->extra;
    if (counted[spec->dimension]) {
        if ((uint64_t)enf_view_count(view, spec->dimension) != count)
            return section_fails(error, spec, "has another count than the sections it belongs to");
    } else if (!enf_view_set_count(view, spec->dimension, count)) {
        return section_fails(error, spec, "has a count that is out of range");
    }
    counted[spec->dimension] = true;
    enf_view_set_array(view, spec, bytes);
    return ENF_OK;
}

static enf_status place_sections(enf_file_view *view, bool skip_checksums, enf_error *error) {
    bool counted[ENF_DIMENSION_COUNT] = {false};
    uint64_t end =
        view->header->table_offset + (uint64_t)view->header->section_count * sizeof *view->sections;
    for (uint32_t i = 0; i < view->header->section_count; i++) {
        const enf_file_section *section = &view->sections[i];
        if (section->offset < end || section->offset % ENF_FILE_ALIGNMENT || section->offset > view->size ||
            section->size > view->size - section->offset)
            return damaged(error, "a section overlaps another or lies outside of the file");
        end = section->offset + section->size;

        const enf_section_spec *spec = find_spec(section->tag);
        if (!spec && section->flags & ENF_FILE_MUST_KNOW)
            return enf_fail(error, ENF_BAD_INPUT,
                            "the file needs something that this program does not know; use a newer program");
        if (!spec) continue;
        enf_status status = place_section(view, section, spec, counted, skip_checksums, error);
        if (status) return status;
    }
    return ENF_OK;
}

/// A part is there as a whole, or not at all; the core must be there.
static enf_status check_parts(enf_file_view *view, enf_error *error) {
    int wanted[PARTS] = {0}, found[PARTS] = {0};
    const enf_section_spec *missing[PARTS] = {NULL};
    for (int i = 0; i < enf_section_spec_count; i++) {
        const enf_section_spec *spec = &enf_section_specs[i];
        wanted[spec->part]++;
        if (enf_view_array(view, spec))
            found[spec->part]++;
        else
            missing[spec->part] = spec;
    }
    for (int part = ENF_PART_CORE; part < ENF_PART_OPTIONAL; part++) {
        bool may_be_absent = part != ENF_PART_CORE;
        if (found[part] < wanted[part] && !(may_be_absent && found[part] == 0))
            return section_fails(error, missing[part], "is missing");
    }
    view->has_exact = found[ENF_PART_EXACT] > 0;
    view->has_geometry = found[ENF_PART_GEOMETRY] > 0;
    return ENF_OK;
}

static bool is_little_endian(void) {
    const uint16_t one = 1;
    uint8_t first;
    memcpy(&first, &one, 1);
    return first == 1;
}

enf_status enf_file_read(enf_file_view *view, const void *bytes, size_t size, bool skip_checksums,
                         enf_error *error) {
    memset(view, 0, sizeof *view);
    if (!is_little_endian())
        return enf_fail(error, ENF_BAD_USAGE,
                        "world files are used in place and need a little-endian machine");
    enf_status status = check_header(bytes, size, error);
    if (status) return status;
    view->bytes = bytes;
    view->size = size;
    view->header = bytes;
    view->sections = (const void *)(view->bytes + view->header->table_offset);
    status = place_sections(view, skip_checksums, error);
    if (!status) status = check_parts(view, error);
    if (!status) status = enf_view_check(view, error);
    return status;
}
