// What a structure's gather kernel and its consumer share: the queries.
//
// A gather kernel is made of two files, in this order: a consumer (NAME.consumer.h), which says what becomes of a photon that a
// query found, and a structure (NAME.gather.h), which finds them and has the KERNEL. The consumer defines
//     struct Gathered { ... };                                     what a query adds up, in registers
//     FN Gathered gather_begin(uint query)
//     FN void gather_add(INOUT(Gathered) g, uint query, IN(PhotonRecord) photon, float distance_squared, float weight)
//     FN void gather_end(IN(Gathered) g, uint query)               called for every query with a radius >= 0
// and, for structures over the hit points, whose photons come to the queries one by one and in no order,
//     FN vec4 gather_value(uint query, IN(PhotonRecord) photon, float distance_squared)     what gather_add adds, as four sums >= 0
//     FN Gathered gather_sums(uint query, vec4 sums)                                        what these sums have gathered
// (xyz in units of power, w a count), and traces no rays. A photon stands for `weight` photons, itself among them; 1 where the structure is exact. Bindings 0 to 15 are the
// structure's, 16 and up the consumer's.
//
// A consumer that wants the nearest photons only has, ahead of this file, `#define GATHER_SHRINKS`, and defines
//     FN float gather_limit(IN(Gathered) g)                        squared distance beyond which it wants no more photons: never grows
// A structure that can stop early asks `#ifdef GATHER_SHRINKS` and leaves out what is farther (not what is as far); others hand over all
// in range, and the consumer ignores what it does not want. core/kernel/nearest.h is such a consumer's heap.
#ifndef LAMPYRIS_KERNEL_GATHER
#define LAMPYRIS_KERNEL_GATHER

#include "core/kernel/photon.h"

BUFFER_RO(0, vec4, queries)  // position, radius; a negative radius asks for nothing

#endif
