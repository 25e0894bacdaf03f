// Kernels that have to compute the addresses of their random accesses handle SPAN batches per invocation: each batch's
// addresses are computed and prefetched before the previous batch is used, so that a CPU does not wait in between. The
// host runs span_count(n) invocations (core/photons/photon_map.h).
#ifndef LAMPYRIS_KERNEL_SPAN
#define LAMPYRIS_KERNEL_SPAN

#include "core/kernel/prelude.h"

CONST uint SPAN = 4u;

// The k-th item of an invocation's `turn`-th batch, and the slot in which its address is kept; two batches have slots.
FN uint span_item(uint index, uint turn, uint k) { return batch_item(index * SPAN + turn, k); }
FN uint span_room(uint turn, uint k) { return (turn & 1u) * BATCH + k; }

#endif
