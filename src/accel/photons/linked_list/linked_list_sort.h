// Sorts a chain by key, however long it is. Before including this file, a kernel must declare `links`, which this
// writes: x is a photon's key, y the link to the next photon, which is its index plus one, or 0 at the end.
#ifndef LAMPYRIS_LINKED_LIST_SORT
#define LAMPYRIS_LINKED_LIST_SORT

// Merges runs of 1, 2, 4, ... links in place (Knuth, volume 3, 5.2.4), so that a chain of any length n takes n log n
// steps.
FN uint chain_merge_sort(uint first) {
    uint head = first;
    uint width = 1u;
    uint merges = 2u;
    bool cut = false;  // the driver ended a loop early: the chain is neither sorted nor complete
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
            for (; left_count < width && right != 0u; ++left_count) right = links[right - 1u].y;
            cut = cut || (left_count < width && right != 0u);
            uint right_count = width;
            while (left_count > 0u || (right_count > 0u && right != 0u)) {
                bool from_left = left_count > 0u;
                if (from_left && right_count > 0u && right != 0u) from_left = links[left - 1u].x <= links[right - 1u].x;
                uint taken = from_left ? left : right;
                if (from_left) {
                    left = links[left - 1u].y;
                    left_count -= 1u;
                } else {
                    right = links[right - 1u].y;
                    right_count -= 1u;
                }
                if (tail == 0u) {
                    head = taken;
                } else {
                    links[tail - 1u].y = taken;
                }
                tail = taken;
            }
            cut = cut || left_count > 0u || (right_count > 0u && right != 0u);
            rest = right;
        }
        cut = cut || rest != 0u;
        if (tail != 0u) links[tail - 1u].y = 0u;
        width = width * 2u;
    }
    if (cut || merges > 1u) REPORT_UNFINISHED();
    return head;
}

#endif
