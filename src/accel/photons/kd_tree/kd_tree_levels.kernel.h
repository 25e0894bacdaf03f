// Builds the next levels of nodes, above those that the previous step built.
#include "accel/photons/kd_tree/kd_tree_layout.h"

BUFFER_RO(0, KdArgs, arguments)
BUFFER_RO(1, KdLarge, larges)
BUFFER_RO(2, uint, owners)
BUFFER_RO(3, uint, starts)
BUFFER_RW(4, KdNode, nodes)
BUFFER_RW(5, KdBox, boxes)  // a node's box is stored at the index of its first group
#include "accel/photons/kd_tree/kd_tree_join.h"

KERNEL(kd_tree_levels) {
    KdArgs args = arguments[0];
    if (index >= args.groups) return;
    KdLarge large = larges[args.round == 0u ? 0u : owners[index]];
    uint built = KD_GROUP_LEVELS * args.step;
    uint group = index - large.cells.x / KD_GROUP;
    // Every 16^step-th group is the first of those that one invocation joins.
    if (large.cells.y <= built || (group & ((1u << built) - 1u)) != 0u) return;
    uint levels = min(large.cells.y - built, KD_GROUP_LEVELS);
    uint width = 1u << levels;
    uint start = large.photons.x - starts[large.cells.x];
    KdGroup g;
    g.are_nodes = 0u;
    for (uint i = 0u; i <= width; ++i) g.starts[i] = start + starts[index * KD_GROUP + (i << built)];
    uint first = (group * KD_GROUP) >> built;
    for (uint i = 0u; i < width; ++i) {
        KdBox box = boxes[index + ((i << built) / KD_GROUP)];
        g.low[i] = box.low;
        g.high[i] = box.high;
        g.places[i] = large.cells.x + args.first_node + (1u << (large.cells.y - built)) + first + i;
        g.are_nodes |= box.low.w != 0.0f ? 1u << i : 0u;
    }
    KdBox box =
        kd_join(large, args.first_node + large.cells.x, args.leaf_photons, large.cells.y - built, first, width, g);
    boxes[index] = box;
    kd_join_root(large, args.round, built + levels, box);
}
