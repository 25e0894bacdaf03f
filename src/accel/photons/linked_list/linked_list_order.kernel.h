// Sorts each chain by key, because photons were linked in no fixed order.
#include "core/kernel/photon_grid.h"

BUFFER_RO(0, PhotonGrid, grid)
BUFFER_RW(1, uint, heads)
BUFFER_RW(2, uvec2, links)
#include "accel/photons/linked_list/linked_list_chains.h"

KERNEL(linked_list_order) { sort_chains(index, grid[0].entries); }
