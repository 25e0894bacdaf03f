// Host code that the hash grids with chains share: linked_list, and hash_list, which one thread builds.
#pragma once

#include "core/photons/photon_grid.h"
#include "accel/photons/linked_list/linked_list_params.h"

namespace lampyris {

class ListGrid : public PhotonMap {
 public:
    LinkedListParams params;
    PhotonMapCapabilities capabilities() const override { return {.exact = true, .fixed_order = keyed()}; }

 protected:
    bool keyed() const { return params.order == 0; }  // chains are sorted by their photons' keys

    // Makes the grid and its buffers, with empty chains. Returns the number of chains.
    uint32_t open_chains(const PhotonSet& photons) {
        const size_t count = photons.count;
        kernel::PhotonGrid grid = make_grid(photons, params.cell_size);
        grid.entries = table_entries(photons, params.table_size);
        grid.option = keyed();
        upload("grid", grid);
        const BufferHandle heads = keep("heads", size_t(grid.entries) * 4);
        keep("links", keyed() ? count * 8 : 8);
        keep("nodes", count * 16);
        clear(heads, size_t(grid.entries) * 4);
        return grid.entries;
    }
};

}  // namespace lampyris
