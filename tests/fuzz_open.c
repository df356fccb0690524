// SPDX-License-Identifier: MIT
// Fuzz target for the opener and the queries (libFuzzer: `./run fuzz`; also called by test_format.c with
// mutated worlds). Whatever the bytes are, the outcome is an error or a world that can be used.
#include "base/hash.h"
#include "fuzz_queries.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void open_and_use(const uint8_t *bytes, size_t size, bool skip_checksums) {
    enf_world *world;
    enf_error error;
    enf_open_options options = {.size = sizeof options, .skip_checksums = skip_checksums};
    if (enf_world_open_memory(&world, bytes, size, &options, &error) == ENF_OK) fuzz_queries(world);
    enf_world_close(world);
}

/// The parts one after the other, in an order that depends on the bytes; asked before each. Some parts may be
/// damaged and others not.
static void open_lazily_and_use(const uint8_t *bytes, size_t size) {
    enf_world *world;
    enf_error error;
    enf_open_options options = {.size = sizeof options, .skip_checksums = true, .mode = ENF_OPEN_LAZY};
    if (enf_world_open_memory(&world, bytes, size, &options, &error) == ENF_OK) {
        uint64_t order = enf_hash64(bytes, size, 0);
        for (int i = 0; i < 3; i++, order >>= 8) {
            // Much of a query makes what it needs, and so loads it: only the first round sees an empty world.
            fuzz_queries(world);
            enf_world_load(world, (uint32_t)order & ENF_LOAD_ALL, &error);
        }
        enf_world_load(world, ENF_LOAD_ALL, &error);
        fuzz_queries(world);
    }
    enf_world_close(world);
}

/// Makes header and table pass their checksums, so that mutations get behind them.
static void repair(uint8_t *bytes, size_t size) {
    enf_file_header *header = (void *)bytes;
    if (size < sizeof *header) return;
    header->file_size = size;
    uint64_t table_size = (uint64_t)header->section_count * sizeof(enf_file_section);
    if (header->table_offset <= size && table_size <= size - header->table_offset)
        header->table_checksum = enf_hash64(bytes + header->table_offset, (size_t)table_size, 0);
    header->header_checksum = enf_hash64(header, offsetof(enf_file_header, header_checksum), 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    uint8_t *copy =
        calloc(size ? size : 1, 1); // exactly as large, so that a sanitizer sees one byte too many
    if (!copy) return 0;
    if (size) memcpy(copy, data, size);
    open_and_use(copy, size, false);
    repair(copy, size);
    open_and_use(copy, size, true);
    open_lazily_and_use(copy, size);
    free(copy);
    return 0;
}
