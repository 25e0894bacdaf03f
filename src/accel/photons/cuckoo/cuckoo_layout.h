// A dictionary from cells to runs of photons. A cell's key is a 32-bit hash; cells with the same key share a run.
#ifndef LAMPYRIS_CUCKOO
#define LAMPYRIS_CUCKOO

#include "core/kernel/photon_grid.h"

CONST uint CUCKOO_WAYS = 4u;

struct CuckooRecord {
    PhotonGrid grid;
    uvec4 seeds;  // one for each hash function (way)
    uint cells;   // number of runs, that is, of keys whose cells hold photons
    uint stash;   // capacity of the stash
    uint unused0;
    uint unused1;
};

FN uint cuckoo_key(IN(PhotonGrid) g, uvec3 cell) { return cell_hash(row_hash(cell.y, cell.z, g.resolution.w), cell.x); }
FN uint cuckoo_entry(IN(CuckooRecord) c, uint key, uint way) {
    uint seed = way == 0u ? c.seeds.x : (way == 1u ? c.seeds.y : (way == 2u ? c.seeds.z : c.seeds.w));
    return hashed_entry(hash32(key ^ seed), c.grid.entries);
}

#endif
