// SPDX-License-Identifier: GPL-3.0-or-later
// The results of jobs in a file that only ever grows: what a killed run has done, the next one need not do
// again.
//
// All numbers are little-endian. The header has 64 bytes:
//
//      0  8 bytes   "ENFCKPT\n"
//      8  4         ENF_CHECKPOINT_FORMAT
//     12  4         method (enf_method)
//     16  4         1 if lines are kept for witnesses, else 0
//     20  4         cells
//     24  4         openings
//     28  4         0
//     32  8         hash of the graph: ends of the openings, offsets of their corners, the corners
//     40  8         hash of the program's version: another version may find other lines
//     48  8         0
//     56  8         hash of the 56 bytes above
//
// Records follow, in the order in which jobs ended. A record is 32 bytes and what the job found:
//
//      0  4         "job\n"
//      4  4         stage
//      8  8         key: what the stage goes by; records with another key are of no use, and do no harm
//     16  4         cell, as the stage counts them
//     20  4         bytes of the result
//     24  8         hash of the 24 bytes above, with the hash of the result as its seed
//     32            the result, as the stage encodes it
//
// Each record goes to the system with one write; the disk is told to keep them every ten seconds. Records
// that are damaged are passed over, wherever they are, and their jobs done again; what lies behind the last
// good one is cut off.
#ifndef ENF_VISIBILITY_CHECKPOINT_H
#define ENF_VISIBILITY_CHECKPOINT_H

#include "visibility/bytes.h"
#include "visibility/portal_graph.h"

/// Goes up when results change, in what they look like or in what they mean. 2: lines are in order. 3: beams
/// come from all bodies of an owner at once.
enum { ENF_CHECKPOINT_FORMAT = 3 };

typedef struct enf_checkpoint enf_checkpoint;

/// What must be the same for results to be of use.
typedef struct enf_checkpoint_about {
    const enf_portal_graph *graph;
    int32_t method;
    bool keeps_lines;
} enf_checkpoint_about;

/// Opens the file, or makes it if there is none or an empty one. ENF_BAD_INPUT if it is no checkpoint or one
/// of something else, ENF_NO_RESOURCES if it cannot be read or written or another run has it; it is left
/// alone then. Close what is opened.
enf_status enf_checkpoint_open(enf_checkpoint **checkpoint, const char *path,
                               const enf_checkpoint_about *about, enf_error *error);

/// The file stays, for the caller to remove when its results are safe. Null is fine.
void enf_checkpoint_close(enf_checkpoint *checkpoint);

/// One that was there when the file was opened.
typedef struct enf_record {
    int32_t stage, cell;
    uint64_t key;
    const uint8_t *result; ///< size bytes, the checkpoint's own
    size_t size;
} enf_record;

/// What was there, in its order; *count of them. The results are as they were written.
const enf_record *enf_checkpoint_records(const enf_checkpoint *checkpoint, size_t *count);
const char *enf_checkpoint_path(const enf_checkpoint *checkpoint);

/// Adds a record. By one thread at a time.
enf_status enf_checkpoint_add(enf_checkpoint *checkpoint, const enf_record *record, enf_error *error);

#endif
