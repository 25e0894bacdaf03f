// Kernels that have to compute where they will touch memory handle SPAN batches an invocation: each is computed, and asked for, before
// the one ahead of it is used, so that a CPU does not wait between. The host runs span_count(n) invocations (core/photons/photon_map.h).
#ifndef LAMPYRIS_KERNEL_SPAN
#define LAMPYRIS_KERNEL_SPAN

#include "core/kernel/prelude.h"

CONST uint SPAN = 4u;

// The k-th item of an invocation's `turn`-th batch; and where its place is kept: there is room for two batches.
FN uint span_item(uint index, uint turn, uint k) { return batch_item(index * SPAN + turn, k); }
FN uint span_room(uint turn, uint k) { return (turn & 1u) * BATCH + k; }

#endif
