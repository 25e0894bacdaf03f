// Sorts a chain by key. The kernel has declared `photons` and, to write, `nodes`: one per photon, its position and in w the link to the
// next, which is an index plus one, or 0 at the end.
#ifndef LAMPYRIS_LINKED_LIST_SORT
#define LAMPYRIS_LINKED_LIST_SORT

CONST uint CHAIN_SHORT = 32u;

// Merges runs of 1, 2, 4, ... links in place (Knuth, volume 3, 5.2.4), so that a chain of any length takes n log n.
FN uint chain_merge_sort(uint first) {
    uint head = first;
    uint width = 1u;
    uint merges = 2u;
    uint level = 0u;
    for (; level < 32u && merges > 1u; ++level) {
        uint rest = head;
        uint tail = 0u;
        head = 0u;
        merges = 0u;
        while (rest != 0u) {
            merges += 1u;
            uint left = rest;
            uint right = rest;
            uint left_count = 0u;
            for (; left_count < width && right != 0u; ++left_count) right = nodes[right - 1u].w;
            uint right_count = width;
            while (left_count > 0u || (right_count > 0u && right != 0u)) {
                bool from_left = left_count > 0u;
                if (from_left && right_count > 0u && right != 0u)
                    from_left = photons[left - 1u].place.w <= photons[right - 1u].place.w;
                uint taken = from_left ? left : right;
                if (from_left) {
                    left = nodes[left - 1u].w;
                    left_count -= 1u;
                } else {
                    right = nodes[right - 1u].w;
                    right_count -= 1u;
                }
                if (tail == 0u) {
                    head = taken;
                } else {
                    nodes[tail - 1u].w = taken;
                }
                tail = taken;
            }
            rest = right;
        }
        if (tail != 0u) nodes[tail - 1u].w = 0u;
        width = width * 2u;
    }
    if (merges > 1u) REPORT_UNFINISHED();
    return head;
}

// The chain's new first link.
FN uint chain_sort(uint first) {
    uint keys[CHAIN_SHORT];
    uint places[CHAIN_SHORT];
    uint count = 0u;
    uint link = first;
    for (; count < CHAIN_SHORT && link != 0u; ++count) {
        uint key = photons[link - 1u].place.w;
        uint hole = count;
        for (; hole > 0u && keys[hole - 1u] > key; --hole) {
            keys[hole] = keys[hole - 1u];
            places[hole] = places[hole - 1u];
        }
        keys[hole] = key;
        places[hole] = link;
        link = nodes[link - 1u].w;
    }
    if (link != 0u) return chain_merge_sort(first);
    for (uint i = 0u; i < count; ++i) nodes[places[i] - 1u].w = i + 1u < count ? places[i + 1u] : 0u;
    return count > 0u ? places[0] : 0u;
}

#endif
