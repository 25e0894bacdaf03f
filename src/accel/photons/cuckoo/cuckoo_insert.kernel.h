// Each cell takes an entry, and the cell that it evicts moves on to its own next entry (Pagh and Rodler 2004; in
// parallel: Alcantara et al. 2009). After too many moves, the cell that was evicted last goes to the stash.
#include "accel/photons/cuckoo/cuckoo_layout.h"

BUFFER_RO(0, CuckooRecord, cuckoo)
BUFFER_RO(1, uvec2, cells)
BUFFER_RW(2, uint, table)  // a cell's index plus one; 0: empty
BUFFER_RW(3, uint, stash)  // the number of cells without an entry, then their indices plus one

CONST uint MOST_MOVES = 200u;

KERNEL(cuckoo_insert) {
    CuckooRecord c = cuckoo[0];
    if (index >= c.cells) return;
    uint item = index + 1u;
    uint entry = cuckoo_entry(c, cells[index].x, 0u);
    for (uint move = 0u; move < MOST_MOVES; ++move) {
        item = ATOMIC_EXCHANGE_U32(table[entry], item);
        if (item == 0u) return;
        uint key = cells[item - 1u].x;
        uint way = 0u;
        while (way < CUCKOO_WAYS - 1u && cuckoo_entry(c, key, way) != entry) way += 1u;
        entry = cuckoo_entry(c, key, (way + 1u) % CUCKOO_WAYS);
    }
    uint place = ATOMIC_ADD_U32(stash[0], 1u);
    if (place < c.stash) stash[1u + place] = item;
}
