// Adds the radiance that a gather ray found to its hit point.
#include "core/kernel/prelude.h"
#include "core/kernel/layout.h"
#include "core/kernel/math.h"
#include "core/kernel/photon.h"
#include "integrators/photon_map/photon_map_params.h"
#include "integrators/photon_paths/photon_paths_layout.h"

BUFFER_RO(0, PhotonMapParams, params)
BUFFER_RO(1, HitPointRecord, ends)
BUFFER_RO(2, vec4, queries)
BUFFER_RO(3, vec4, gathered)
BUFFER_RW(4, HitPointRecord, hits)

KERNEL(photon_map_add) {
    float radius = queries[index].w;
    if (radius < 0.0f) return;
    float share = 1.0f / (PI * max(radius * radius, SMALLEST_RADIUS_SQUARED) * float(params[0].gather));
    Spectrum arriving = spectrum_of(ends[index].throughput) * spectrum_of(gathered[index]) * share;
    Spectrum radiance = spectrum_of(hits[index].throughput) * arriving;
    hits[index].radiance += slot_of(radiance, 0.0f);
}
