// The queries, which a structure's gather kernel and its consumer share.
//
// A gather kernel consists of two files, in this order: a consumer (NAME.consumer.h), which processes the photons that
// a query finds, and a structure (NAME.gather.h), which finds them and has the KERNEL. The consumer defines
//     struct Gathered { ... };                                     a query's sums, in registers
//     FN Gathered gather_begin(uint query)
//     FN void gather_add(INOUT(Gathered) g, uint query, IN(PhotonRecord) photon, float distance_squared, float weight)
//     FN void gather_end(IN(Gathered) g, uint query)               runs for every query with a radius >= 0
// and, for structures built over the hit points, where photons reach the queries one by one in no fixed order,
//     FN vec4 gather_value(uint query, IN(PhotonRecord) photon, float distance_squared)    gather_add's four terms, >= 0
//     FN Gathered gather_sums(uint query, vec4 sums)                                       the Gathered with these sums
// (xyz in units of power, w a count). It must not trace rays. A photon counts as `weight` photons, including itself;
// the weight is 1 if the structure is exact. The structure uses bindings 0 to 15, the consumer those from 16 on.
//
// A consumer that needs only the nearest photons has `#define GATHER_SHRINKS` before it includes this file, and defines
//     FN float gather_limit(IN(Gathered) g)          squared distance beyond which it ignores photons; it never grows
// A structure that can stop early tests `#ifdef GATHER_SHRINKS`, and skips photons beyond that distance (not those
// exactly at it). Other structures pass on all photons in range, and the consumer ignores those that it does not need.
// core/kernel/nearest.h has the heap for such a consumer.
#ifndef LAMPYRIS_KERNEL_GATHER
#define LAMPYRIS_KERNEL_GATHER

#include "core/kernel/photon.h"

BUFFER_RO(0, vec4, queries)  // position, radius; no photons are sought if the radius is negative

#endif
