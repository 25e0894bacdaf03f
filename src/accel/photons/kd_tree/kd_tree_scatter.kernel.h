// Writes the index of each photon of a large node to the photon's place within its cell.
#include "accel/photons/kd_tree/kd_tree_layout.h"

BUFFER_RO(0, KdArgs, arguments)
BUFFER_RO(1, KdLarge, larges)
BUFFER_RO(2, uint, chunks)
BUFFER_RO(3, uint, starts)
BUFFER_RO(4, uint, scratch)
BUFFER_RW(5, uint, order)

KERNEL(kd_tree_scatter) {
    bool first_round = arguments[0].round == 0u;
    uint chunk = index / 32u;
    KdLarge large = larges[first_round ? 0u : chunks[chunk]];
    uint begin = large.photons.x + (chunk - large.photons.z) * KD_CHUNK;
    uint end = min(begin + KD_CHUNK, large.photons.x + large.photons.y);
    uint start = large.photons.x - starts[large.cells.x];
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = begin + batch_item(index, k) - chunk * KD_CHUNK;
        if (i < end) PREFETCH(starts[scratch[2u * i]]);
    }
    uint to[BATCH];
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = begin + batch_item(index, k) - chunk * KD_CHUNK;
        if (i >= end) continue;
        to[k] = start + starts[scratch[2u * i]] + scratch[2u * i + 1u];
        PREFETCH(order[to[k]]);
    }
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = begin + batch_item(index, k) - chunk * KD_CHUNK;
        if (i < end) order[to[k]] = first_round ? i : scratch[2u * arguments[0].count + i];
    }
}
