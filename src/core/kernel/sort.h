// Sorts a range of (key, value) pairs in place, in one invocation: insertion sort for short ranges, else heap sort. The
// pairs are the kernel's buffer BUFFER_RW(..., uvec2, order), declared before this file is included.
#ifndef LAMPYRIS_KERNEL_SORT
#define LAMPYRIS_KERNEL_SORT

#include "core/kernel/prelude.h"

// Heap sort (Williams 1964) needs no memory and no recursion. Sifts `root` down in the heap of `count` pairs from
// `begin` on.
FN void sort_sink(uint begin, uint root, uint count) {
    uvec2 pair = order[begin + root];
    uint hole = root;
    // One level per step, so the bound is never reached.
    uint step = 0u;
    for (; step < 32u && 2u * hole + 1u < count; ++step) {
        uint child = 2u * hole + 1u;
        if (child + 1u < count && order[begin + child].x < order[begin + child + 1u].x) child += 1u;
        if (order[begin + child].x <= pair.x) break;
        order[begin + hole] = order[begin + child];
        hole = child;
    }
    order[begin + hole] = pair;
}

FN void sort_order(uint begin, uint end) {
    uint count = end - begin;
    if (count > 32u) {
        uint sunk = 0u;
        for (; sunk < count / 2u; ++sunk) sort_sink(begin, count / 2u - 1u - sunk, count);
        uint taken = 0u;
        for (; taken < count - 1u; ++taken) {
            uint last = count - 1u - taken;
            uvec2 largest = order[begin];
            order[begin] = order[begin + last];
            order[begin + last] = largest;
            sort_sink(begin, 0u, last);
        }
        if (sunk != count / 2u || taken != count - 1u) REPORT_UNFINISHED();
        return;
    }
    for (uint i = begin + 1u; i < end; ++i) {
        uvec2 pair = order[i];
        uint hole = i;
        for (; hole > begin && order[hole - 1u].x > pair.x; --hole) order[hole] = order[hole - 1u];
        order[hole] = pair;
    }
}

#endif
