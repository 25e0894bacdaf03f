// Copies the photons in the order of the sorted pairs.
#include "core/kernel/prelude.h"
#include "core/kernel/photon.h"

BUFFER_RO(0, PhotonRecord, photons)
BUFFER_RO(1, uvec2, sorted)
BUFFER_RW(2, PhotonRecord, ordered)

KERNEL(slabs_order) { ordered[index] = photons[sorted[index].y]; }
