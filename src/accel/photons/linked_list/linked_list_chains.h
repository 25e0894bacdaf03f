// Sorts the chains of many buckets by key, several in turns: one alone would wait for memory at every node. Before
// including this file, a kernel must declare `heads`, and `links` as in linked_list_sort.h.
#ifndef LAMPYRIS_LINKED_LIST_CHAINS
#define LAMPYRIS_LINKED_LIST_CHAINS

#include "accel/photons/linked_list/linked_list_sort.h"

CONST uint CHAIN_SPAN = 16u;   // batches of buckets per invocation
CONST uint CHAIN_SHORT = 32u;  // chains of up to this many links are sorted by insertion

// Sorts the chains of an invocation's buckets.
FN void sort_chains(uint index, uint buckets) {
    uint bucket[BATCH];
    uint rest[BATCH];    // the first link that is still to be sorted
    uint sorted[BATCH];  // the first link of the sorted ones
    uint lengths[BATCH];
    uint alive = 0u;
    uint opened = 0u;
    uint k = 0u;
    bool open = true;
    uint steps = 0u;
    for (; (open || alive > 0u) && steps < (CHAIN_SHORT + 1u) * CHAIN_SPAN * BATCH; ++steps) {
        // Chains that are done are replaced by the next ones that are not empty.
        while (open && alive < BATCH) {
            uint b = batch_item(CHAIN_SPAN * index + opened / BATCH, opened % BATCH);
            opened += 1u;
            open = opened < CHAIN_SPAN * BATCH;
            uint head = b < buckets ? heads[b] : 0u;
            if (head == 0u) continue;
            PREFETCH(links[head - 1u]);
            bucket[alive] = b;
            rest[alive] = head;
            sorted[alive] = 0u;
            lengths[alive] = 0u;
            alive += 1u;
        }
        if (alive == 0u) continue;
        k = k + 1u < alive ? k + 1u : 0u;
        uint link = rest[k];
        uvec2 item = links[link - 1u];
        if (item.y != 0u) PREFETCH(links[item.y - 1u]);
        uint before = 0u;
        uint after = sorted[k];
        while (after != 0u && links[after - 1u].x < item.x) {
            before = after;
            after = links[after - 1u].y;
        }
        if (item.y != after) links[link - 1u].y = after;
        if (before == 0u) {
            sorted[k] = link;
        } else {
            links[before - 1u].y = link;
        }
        rest[k] = item.y;
        lengths[k] += 1u;
        if (item.y != 0u && lengths[k] < CHAIN_SHORT) continue;
        uint first = sorted[k];
        if (item.y != 0u) {
            uint last = first;
            for (uint i = 1u; i < CHAIN_SHORT; ++i) last = links[last - 1u].y;
            links[last - 1u].y = item.y;
            first = chain_merge_sort(first);
        }
        heads[bucket[k]] = first;
        alive -= 1u;
        bucket[k] = bucket[alive];
        rest[k] = rest[alive];
        sorted[k] = sorted[alive];
        lengths[k] = lengths[alive];
    }
    if (open || alive > 0u) REPORT_UNFINISHED();
}

#endif
