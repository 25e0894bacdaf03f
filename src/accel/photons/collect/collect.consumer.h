// Sums up the photons that a query finds, for tests and the benchmark. The checksum of keys does not depend on their
// order.
#include "core/kernel/gather.h"
#include "accel/photons/collect/collect_layout.h"

BUFFER_RW(16, CollectResult, results)

struct Gathered {
    vec4 sum;
    uint found;
    uint checksum;
};

FN Gathered gather_begin(uint query) {
    Gathered g;
    g.sum = vec4(0.0f);
    g.found = 0u;
    g.checksum = 0u;
    return g;
}

FN void gather_add(INOUT(Gathered) g, uint query, IN(PhotonRecord) photon, float distance_squared, float weight) {
    Spectrum power = photon_power(photon) * weight;
    g.sum += slot_of(power, weight);
    g.found += 1u;
    g.checksum += hash32(photon.place.w);
}

FN vec4 gather_value(uint query, IN(PhotonRecord) photon, float distance_squared) {
    Spectrum power = photon_power(photon);
    return slot_of(power, 1.0f);
}

// Sums have no keys, so the checksum is 0.
FN Gathered gather_sums(uint query, vec4 sums) {
    Gathered g = gather_begin(query);
    g.sum = sums;
    g.found = uint(sums.w + 0.5f);
    return g;
}

FN void gather_end(IN(Gathered) g, uint query) {
    CollectResult r;
    r.sum = g.sum;
    r.found = uvec4(g.found, g.checksum, 0u, 0u);
    results[query] = r;
}
