// Counts the photons of each cell, and gives each photon its rank among them (in the order of execution, which is not
// fixed).
#include "accel/photons/kd_tree/kd_tree_layout.h"

BUFFER_RO(0, KdArgs, arguments)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RO(2, KdLarge, larges)
BUFFER_RO(3, uint, chunks)
BUFFER_RO(4, uvec4, places)  // of the photons in large nodes, from the second round on
BUFFER_RW(5, uint, starts)
BUFFER_RW(6, uint, scratch)  // (cell, rank) of each photon; after these, from the second round on, its index

KERNEL(kd_tree_count) {
    bool first_round = arguments[0].round == 0u;
    uint chunk = index / 32u;
    KdLarge large = larges[first_round ? 0u : chunks[chunk]];
    uint begin = large.photons.x + (chunk - large.photons.z) * KD_CHUNK;
    uint end = min(begin + KD_CHUNK, large.photons.x + large.photons.y);
    vec3 low = kd_low(large);
    if (begin + batch_item(index, 0u) - chunk * KD_CHUNK >= end) return;
    // Without a branch, so that a compiler can vectorise this; indices past the end read the last photon.
    float x[BATCH];
    float y[BATCH];
    float z[BATCH];
    uint cells[BATCH];
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = min(begin + batch_item(index, k) - chunk * KD_CHUNK, end - 1u);
        uvec4 place = first_round ? photons[i].place : places[i];
        x[k] = uintBitsToFloat(place.x);
        y[k] = uintBitsToFloat(place.y);
        z[k] = uintBitsToFloat(place.z);
        cells[k] = place.w;
    }
    if (kd_by_key(large))
        for (uint k = 0u; k < BATCH; ++k) cells[k] = kd_key_cell(large, cells[k]);
    else
        for (uint k = 0u; k < BATCH; ++k) cells[k] = kd_cell(large, low, vec3(x[k], y[k], z[k]));
    uint ranks[BATCH];
    for (uint k = 0u; k < BATCH; ++k) PREFETCH(starts[large.cells.x + cells[k]]);
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = begin + batch_item(index, k) - chunk * KD_CHUNK;
        if (i < end) ranks[k] = ATOMIC_ADD_U32(starts[large.cells.x + cells[k]], 1u);
    }
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = begin + batch_item(index, k) - chunk * KD_CHUNK;
        if (i >= end) continue;
        scratch[2u * i] = large.cells.x + cells[k];
        scratch[2u * i + 1u] = ranks[k];
    }
}
