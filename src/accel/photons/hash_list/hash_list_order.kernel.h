// The same thread sorts the chains by key. An invocation sorts CHUNK times as many chains as one of linked_list_order.
#include "core/kernel/photon_grid.h"

BUFFER_RO(0, PhotonGrid, grid)
BUFFER_RW(1, uint, heads)
BUFFER_RW(2, uvec2, links)
#include "accel/photons/linked_list/linked_list_chains.h"

CONST uint CHUNK = 8u;

KERNEL(hash_list_order) {
    for (uint part = 0u; part < CHUNK; ++part) sort_chains(index * CHUNK + part, grid[0].entries);
}
