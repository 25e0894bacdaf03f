// Copies the photons of a group of cells, sorted by key within each cell, and builds the nodes above.
#include "accel/photons/kd_tree/kd_tree_layout.h"

BUFFER_RO(0, KdArgs, arguments)
BUFFER_RO(1, PhotonRecord, photons)
BUFFER_RO(2, KdLarge, larges)
BUFFER_RO(3, uint, owners)
BUFFER_RO(4, uint, starts)
BUFFER_RO(5, uint, links)
BUFFER_RO(6, KdLarge, next)
BUFFER_RO(7, uint, order)
BUFFER_RW(8, uvec4, places)
BUFFER_RW(9, uvec4, fluxes)
BUFFER_RW(10, KdNode, nodes)
BUFFER_RW(11, KdBox, boxes)
#include "accel/photons/kd_tree/kd_tree_join.h"

KERNEL(kd_tree_leaves) {
    KdArgs args = arguments[0];
    if (index >= args.groups) return;
    KdLarge large = larges[args.round == 0u ? 0u : owners[index]];
    uint cell = index * KD_GROUP;
    uint start = large.photons.x - starts[large.cells.x];
    KdGroup g;
    g.are_nodes = 0u;
    for (uint c = 0u; c <= KD_GROUP; ++c) g.starts[c] = start + starts[cell + c];
    for (uint c = 0u; c < KD_GROUP; ++c) {
        if (kd_is_large(g.starts[c + 1u] - g.starts[c], args.leaf_photons)) continue;
        for (uint i = g.starts[c]; i < g.starts[c + 1u]; ++i) PREFETCH(photons[order[i]]);
    }
    for (uint c = 0u; c < KD_GROUP; ++c) {
        uint begin = g.starts[c];
        uint count = g.starts[c + 1u] - begin;
        g.places[c] = 1u;
        if (kd_is_large(count, args.leaf_photons)) {
            KdLarge child = next[links[cell + c]];
            g.low[c] = vec4(kd_low(child), 0.0f);
            g.high[c] = vec4(kd_high(child), 0.0f);
            g.places[c] = args.next_node + child.cells.x;
            g.are_nodes |= 1u << c;
            continue;
        }
        vec3 low = vec3(3e38f);
        vec3 high = vec3(-3e38f);
        uint keys[2u * KD_MAX_LEAF];
        for (uint i = 0u; i < count; ++i) keys[i] = photons[order[begin + i]].place.w;
        for (uint i = 0u; i < count; ++i) {
            uint key = keys[i];
            uint rank = 0u;
            for (uint k = 0u; k < count; ++k) rank += keys[k] < key ? 1u : 0u;
            PhotonRecord photon = photons[order[begin + i]];
            places[begin + rank] = photon.place;
            fluxes[begin + rank] = photon.flux;
            low = min(low, photon_position(photon));
            high = max(high, photon_position(photon));
        }
        g.low[c] = vec4(low.x, low.y, low.z, 0.0f);
        g.high[c] = vec4(high.x, high.y, high.z, 0.0f);
    }
    KdBox box = kd_join(large, args.first_node + large.cells.x, args.leaf_photons, large.cells.y, cell - large.cells.x,
                        KD_GROUP, g);
    boxes[index] = box;
    kd_join_root(large, args.round, KD_GROUP_LEVELS, box);
}
