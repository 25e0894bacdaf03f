// Sets words to zero.
#include "core/kernel/prelude.h"

BUFFER_RO(0, uvec4, arguments)  // x: number of groups of four words
BUFFER_RW(1, uvec4, words)

KERNEL(clear) {
    uint count = arguments[0].x;
    for (uint k = 0u; k < BATCH; ++k) {
        uint i = batch_item(index, k);
        if (i < count) words[i] = uvec4(0u);
    }
}
