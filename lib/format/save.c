// SPDX-License-Identifier: MIT
// The table first, the sections after it, straight from the arrays: nothing is copied but the few bytes of
// padding.
#include "format/save.h"

#include "base/hash.h"
#include "format/output.h"
#include "format/sections.h"

#include <stdlib.h>
#include <string.h>

#define SECTIONS_MAX 128

typedef struct layout {
    enf_file_header header;
    enf_file_section sections[SECTIONS_MAX];
    const void *arrays[SECTIONS_MAX];
} layout;

static uint64_t align(uint64_t offset) {
    return (offset + ENF_FILE_ALIGNMENT - 1) / ENF_FILE_ALIGNMENT * ENF_FILE_ALIGNMENT;
}

static void plan(layout *out, const enf_file_view *view) {
    memset(out, 0, sizeof *out);
    enf_file_header *header = &out->header;
    for (int i = 0; i < enf_section_spec_count && header->section_count < SECTIONS_MAX; i++) {
        const enf_section_spec *spec = &enf_section_specs[i];
        const void *array = enf_view_array(view, spec);
        if (!array) continue;
        out->arrays[header->section_count] = array;
        enf_file_section *section = &out->sections[header->section_count++];
        memcpy(section->tag, spec->tag, sizeof section->tag);
        section->count = (uint64_t)enf_view_count(view, spec->dimension) + spec->extra;
        section->element_size = spec->element_size;
        section->flags = spec->part == ENF_PART_NEEDED ? ENF_FILE_MUST_KNOW : 0;
        section->size = section->count * spec->element_size;
        section->checksum = enf_hash64(array, (size_t)section->size, 0);
    }
    size_t table_size = header->section_count * sizeof *out->sections;
    header->table_offset = sizeof *header;
    uint64_t end = header->table_offset + table_size;
    for (uint32_t i = 0; i < header->section_count; i++) {
        out->sections[i].offset = align(end);
        end = out->sections[i].offset + out->sections[i].size;
    }
    memcpy(header->magic, ENF_FILE_MAGIC, sizeof header->magic);
    header->major = ENF_FILE_MAJOR;
    header->minor = ENF_FILE_MINOR;
    header->header_size = sizeof *header;
    header->entry_size = sizeof *out->sections;
    header->file_size = end;
    header->table_checksum = enf_hash64(out->sections, table_size, 0);
    header->header_checksum = enf_hash64(header, offsetof(enf_file_header, header_checksum), 0);
}

static void put_layout(enf_output *output, const layout *plan) {
    static const char zeros[ENF_FILE_ALIGNMENT] = {0};
    uint64_t table_size = plan->header.section_count * sizeof *plan->sections;
    uint64_t end = plan->header.table_offset + table_size;
    enf_output_write(output, &plan->header, sizeof plan->header);
    enf_output_write(output, plan->sections, table_size);
    for (uint32_t i = 0; i < plan->header.section_count; i++) {
        const enf_file_section *section = &plan->sections[i];
        enf_output_write(output, zeros, section->offset - end);
        enf_output_write(output, plan->arrays[i], section->size);
        end = section->offset + section->size;
    }
}

enf_status enf_view_save(const enf_file_view *view, const char *path, enf_error *error) {
    layout *out = malloc(sizeof *out);
    if (!out) return enf_fail_memory(error, "the section table");
    plan(out, view);
    enf_output output;
    enf_status status = enf_output_open(&output, path, error);
    if (!status) {
        put_layout(&output, out);
        status = enf_output_commit(&output, error);
    }
    free(out);
    return status;
}
