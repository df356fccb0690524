// SPDX-License-Identifier: GPL-3.0-or-later
// The weights are a vector of the null space of the edges' matrix, found by fraction-free elimination
// (Bareiss, "Sylvester's identity and multistep integer-preserving Gaussian elimination", 1968).
#include "visibility_check/hidden_proof.h"

#include "base/array.h"
#include "base/hash.h"
#include "visibility_check/whole_number.h"

#include <stdlib.h>
#include <string.h>

enum { ROWS = 6 };

typedef struct enf_proof_slot {
    int32_t edges[ENF_PROOF_EDGES]; ///< ascending, -1 where there are fewer; or -2, ... -2, two portals
    bool taken;
    int8_t answer; ///< 1: proved; -1: not
} proof_slot;

typedef struct proof_numbers {
    mpz_t matrix[ROWS][ENF_PROOF_EDGES];
    mpz_t end[2][3];
    mpz_t divisor, product;
    int unit; ///< every coordinate of the graph is a multiple of 2^unit
    int pivot_column[ROWS];
} proof_numbers;

static bool make_numbers(enf_hidden_proof *proof) {
    proof_numbers *numbers = malloc(sizeof *numbers);
    if (!numbers) return false;
    for (int r = 0; r < ROWS; r++)
        for (int k = 0; k < ENF_PROOF_EDGES; k++) mpz_init(numbers->matrix[r][k]);
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 3; i++) mpz_init(numbers->end[k][i]);
    mpz_inits(numbers->divisor, numbers->product, NULL);
    proof->numbers = numbers;
    return true;
}

static void free_numbers(proof_numbers *numbers) {
    if (!numbers) return;
    for (int r = 0; r < ROWS; r++)
        for (int k = 0; k < ENF_PROOF_EDGES; k++) mpz_clear(numbers->matrix[r][k]);
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 3; i++) mpz_clear(numbers->end[k][i]);
    mpz_clears(numbers->divisor, numbers->product, NULL);
    free(numbers);
}

bool enf_hidden_proof_make(enf_hidden_proof *proof, const enf_portal_graph *graph) {
    *proof = (enf_hidden_proof){.graph = graph, .slot_count = 1 << 12};
    size_t corners = graph->opening_count ? (size_t)graph->opening_corner[graph->opening_count] : 0;
    proof->corner_next = enf_array_new(corners, sizeof *proof->corner_next);
    proof->slots = enf_array_zeroed(proof->slot_count, sizeof *proof->slots);
    if (!make_numbers(proof) || !proof->corner_next || !proof->slots) return false;
    for (int32_t k = 0; k < graph->opening_count; k++) {
        int32_t first = graph->opening_corner[k], end = graph->opening_corner[k + 1];
        for (int32_t c = first; c < end; c++) proof->corner_next[c] = c + 1 < end ? c + 1 : first;
    }
    ((proof_numbers *)proof->numbers)->unit = enf_last_bit_of_graph(graph);
    return true;
}

void enf_hidden_proof_free(enf_hidden_proof *proof) {
    free_numbers(proof->numbers);
    free(proof->corner_next);
    free(proof->slots);
    memset(proof, 0, sizeof *proof);
}

// ---------------------------------------------------------------------------------------------- numbers

/// Column k: direction and moment of an edge.
static void set_column(const enf_hidden_proof *proof, int k, int32_t edge) {
    proof_numbers *numbers = proof->numbers;
    int32_t corner[2] = {edge >> 1, proof->corner_next[edge >> 1]};
    for (int e = 0; e < 2; e++)
        for (int i = 0; i < 3; i++)
            enf_set_whole(numbers->end[e ^ (edge & 1)][i], proof->graph->corners[corner[e]][i],
                          numbers->unit);
    mpz_t *a = numbers->end[0], *b = numbers->end[1];
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, l = (i + 2) % 3;
        mpz_sub(numbers->matrix[i][k], b[i], a[i]);
        mpz_mul(numbers->matrix[3 + i][k], a[j], b[l]);
        mpz_submul(numbers->matrix[3 + i][k], a[l], b[j]);
    }
}

/// Brings column k to 0 but for row `pivot`, where the entry is not 0.
static void eliminate(proof_numbers *numbers, int pivot, int k, int count) {
    for (int r = 0; r < ROWS; r++) {
        if (r == pivot) continue;
        for (int c = 0; c < count; c++) {
            if (c == k) continue;
            mpz_ptr entry = numbers->matrix[r][c];
            mpz_mul(entry, entry, numbers->matrix[pivot][k]);
            mpz_submul(entry, numbers->matrix[r][k], numbers->matrix[pivot][c]);
            mpz_divexact(entry, entry, numbers->divisor);
        }
        mpz_set_ui(numbers->matrix[r][k], 0);
    }
    mpz_set(numbers->divisor, numbers->matrix[pivot][k]);
}

/// Gauss-Jordan. Returns the rank; *free_column is the first column without a pivot, or -1.
static int reduce(proof_numbers *numbers, int count, int *free_column) {
    int rank = 0;
    *free_column = -1;
    mpz_set_ui(numbers->divisor, 1);
    for (int k = 0; k < count; k++) {
        int row = rank;
        while (row < ROWS && mpz_sgn(numbers->matrix[row][k]) == 0) row++;
        if (row == ROWS) {
            if (*free_column < 0) *free_column = k;
            continue;
        }
        for (int c = 0; c < count && row != rank; c++)
            mpz_swap(numbers->matrix[row][c], numbers->matrix[rank][c]);
        eliminate(numbers, rank, k, count);
        numbers->pivot_column[rank++] = k;
    }
    return rank;
}

/// Is there a combination of the columns, with one free column taken once, that is 0 and has no negative
/// weight? After the elimination all pivots are equal to the divisor.
static bool has_weights(const proof_numbers *numbers, int rank, int free_column) {
    for (int r = 0; r < rank; r++) {
        // The pivots that were made before the free column was passed, and those after, alike.
        int sign =
            mpz_sgn(numbers->matrix[r][free_column]) * mpz_sgn(numbers->matrix[r][numbers->pivot_column[r]]);
        if (sign > 0) return false;
    }
    return true;
}

static bool compute(const enf_hidden_proof *proof, const int32_t *edges, int count) {
    proof_numbers *numbers = proof->numbers;
    for (int k = 0; k < count; k++) set_column(proof, k, edges[k]);
    int free_column, rank = reduce(numbers, count, &free_column);
    bool is_pivot[ENF_PROOF_EDGES] = {false};
    for (int r = 0; r < rank; r++) is_pivot[numbers->pivot_column[r]] = true;
    for (int k = 0; k < count; k++)
        if (!is_pivot[k] && has_weights(numbers, rank, k)) return true;
    return false;
}

// ---------------------------------------------------------------------------------------------- memory

static proof_slot *find_slot(proof_slot *slots, size_t slot_count, const int32_t *edges) {
    size_t at = enf_hash64(edges, ENF_PROOF_EDGES * sizeof *edges, 0) & (slot_count - 1);
    while (slots[at].taken && memcmp(slots[at].edges, edges, sizeof slots[at].edges) != 0)
        at = (at + 1) & (slot_count - 1);
    return &slots[at];
}

static void grow(enf_hidden_proof *proof) {
    size_t wanted = proof->slot_count * 2;
    proof_slot *slots = enf_array_zeroed(wanted, sizeof *slots);
    if (!slots) { // forget everything instead
        memset(proof->slots, 0, proof->slot_count * sizeof *proof->slots);
        proof->used = 0;
        return;
    }
    for (size_t s = 0; s < proof->slot_count; s++)
        if (proof->slots[s].taken) *find_slot(slots, wanted, proof->slots[s].edges) = proof->slots[s];
    free(proof->slots);
    proof->slots = slots;
    proof->slot_count = wanted;
}

/// The slot of a key, which is taken from then on. Room is made before, so that the slot stays where it is.
static proof_slot *take_slot(enf_hidden_proof *proof, const int32_t *key) {
    if (2 * (proof->used + 1) > proof->slot_count) grow(proof);
    proof_slot *slot = find_slot(proof->slots, proof->slot_count, key);
    if (!slot->taken) {
        memcpy(slot->edges, key, sizeof slot->edges);
        slot->taken = true;
        proof->used++;
    }
    return slot;
}

bool enf_hidden_proof_ask(enf_hidden_proof *proof, const int32_t *edges, int count) {
    int32_t key[ENF_PROOF_EDGES];
    for (int k = 0; k < ENF_PROOF_EDGES; k++) key[k] = k < count ? edges[k] : -1;
    for (int k = 1; k < count; k++)
        for (int at = k; at > 0 && key[at] < key[at - 1]; at--) {
            int32_t swap = key[at];
            key[at] = key[at - 1];
            key[at - 1] = swap;
        }
    proof->asked++;
    proof_slot *slot = take_slot(proof, key);
    if (slot->answer) return slot->answer > 0;
    bool proved = compute(proof, key, count);
    proof->computed++;
    proof->failed += !proved;
    slot->answer = proved ? 1 : -1;
    return proved;
}

int8_t *enf_hidden_proof_of_portals(enf_hidden_proof *proof, int32_t first, int32_t second) {
    int32_t key[ENF_PROOF_EDGES];
    for (int k = 0; k < ENF_PROOF_EDGES; k++) key[k] = -2;
    key[ENF_PROOF_EDGES - 2] = first;
    key[ENF_PROOF_EDGES - 1] = second;
    return &take_slot(proof, key)->answer;
}
