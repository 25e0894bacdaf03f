// Finds the cells that are large. It runs twice: first to count them, their chunks and their own cells; then, when
// memory for these has been allocated, to write the next round's nodes.
#include "accel/photons/kd_tree/kd_tree_layout.h"

BUFFER_RO(0, KdArgs, arguments)
BUFFER_RO(1, KdLarge, larges)
BUFFER_RO(2, uint, owners)  // large node of each group of cells
BUFFER_RO(3, uint, starts)
BUFFER_RW(4, uint, counters)  // large nodes, chunks, cells, most levels; then the same for the second run
BUFFER_RW(5, uint, links)     // of each large cell, its index among the next round's nodes
BUFFER_RW(6, KdLarge, next)
BUFFER_RW(7, uint, next_chunks)  // large node of each chunk
BUFFER_RW(8, uint, next_owners)

KERNEL(kd_tree_list) {
    KdArgs args = arguments[0];
    if (index >= args.groups * KD_GROUP) return;
    uint begin = starts[index];
    uint count = starts[index + 1u] - begin;
    if (!kd_is_large(count, args.leaf_photons)) return;
    uint levels = kd_levels(count, args.leaf_photons);
    uint chunks = (count + KD_CHUNK - 1u) / KD_CHUNK;
    bool counting = args.step == 0u;
    uint first = counting ? 0u : 4u;
    uint node = ATOMIC_ADD_U32(counters[first], 1u);
    uint chunk = ATOMIC_ADD_U32(counters[first + 1u], chunks);
    uint cell = ATOMIC_ADD_U32(counters[first + 2u], 1u << levels);
    ATOMIC_MAX_U32(counters[first + 3u], levels);
    if (counting) return;
    KdLarge parent = larges[args.round == 0u ? 0u : owners[index / KD_GROUP]];
    links[index] = node;
    next[node].photons = uvec4(parent.photons.x + begin - starts[parent.cells.x], count, chunk, 0u);
    next[node].cells = uvec4(cell, levels, 0u, 0u);
    next[node].least = uvec4(0u);
    next[node].greatest = uvec4(0u);
    for (uint k = 0u; k < chunks; ++k) next_chunks[chunk + k] = node;
    for (uint k = 0u; k < (1u << levels) / KD_GROUP; ++k) next_owners[cell / KD_GROUP + k] = node;
}
