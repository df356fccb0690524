// SPDX-License-Identifier: MIT
// Mutations for the fuzzer that keep a world a world: numbers within sections change, sections stay where
// they are. What bytes at random do to a file mostly ends at its table.
#include "enfilade/format.h"

#include <stdlib.h>
#include <string.h>

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed);

static uint64_t next_random(uint64_t *seed) { // splitmix64
    uint64_t z = *seed += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

/// A section that lies in the file and is not empty; null: this is no world.
static const enf_file_section *choose_section(const uint8_t *data, size_t size, uint64_t *seed) {
    const enf_file_header *header = (const void *)data;
    if (size < sizeof *header || header->table_offset % 8 || header->table_offset > size ||
        header->section_count == 0 ||
        header->section_count > (size - header->table_offset) / sizeof(enf_file_section))
        return NULL;
    const enf_file_section *sections = (const void *)(data + header->table_offset);
    for (int tries = 0; tries < 20; tries++) {
        const enf_file_section *section = &sections[next_random(seed) % header->section_count];
        if (section->size >= 4 && section->size <= size && section->offset <= size - section->size)
            return section;
    }
    return NULL;
}

/// A number of 4 bytes that means something else: near, at a border, or from elsewhere in the section.
static void change_number(uint8_t *section, size_t size, uint64_t *seed) {
    static const uint32_t nasty[] = {0,          1,          2,          UINT32_MAX, UINT32_MAX - 1,
                                     0x7fffffff, 0x80000000, 0x7ff00000, 0x7ff80000, 0xfff00000,
                                     0x7fefffff, 0x7f800000, 0x00100000, 0x3ff00000, 0x43400000};
    size_t words = size / 4;
    uint8_t *at = section + 4 * (next_random(seed) % words);
    uint32_t value;
    memcpy(&value, at, 4);
    switch (next_random(seed) % 5) {
    case 0:
        value = nasty[next_random(seed) % (sizeof nasty / sizeof *nasty)];
        break;
    case 1:
        value += (uint32_t)(next_random(seed) % 5) - 2;
        break;
    case 2:
        memcpy(&value, section + 4 * (next_random(seed) % words), 4);
        break;
    case 3:
        value ^= UINT32_C(1) << next_random(seed) % 32;
        break;
    default:
        value = (uint32_t)(next_random(seed) % (words + 2));
    }
    memcpy(at, &value, 4);
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned start) {
    uint64_t seed = start;
    const enf_file_section *section = choose_section(data, size, &seed);
    if (!section || next_random(&seed) % 16 == 0) return LLVMFuzzerMutate(data, size, max_size);
    uint64_t changes = 1 + next_random(&seed) % 4;
    for (uint64_t i = 0; i < changes && section; i++) {
        uint8_t *bytes = data + section->offset;
        size_t left = (size_t)section->size;
        if (section->element_size == 1 || next_random(&seed) % 8 == 0) {
            size_t at = (size_t)(next_random(&seed) % left), room = left - at < 16 ? left - at : 16;
            LLVMFuzzerMutate(bytes + at, room, room);
        } else {
            change_number(bytes, left, &seed);
        }
        section = choose_section(data, size, &seed);
    }
    return size;
}
