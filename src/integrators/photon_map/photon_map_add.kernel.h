// Adds what a gather ray found to its hit point.
#include "core/kernel/prelude.h"
#include "core/kernel/layout.h"
#include "core/kernel/math.h"
#include "core/kernel/photon.h"
#include "integrators/photon_map/photon_map.params.h"
#include "integrators/sppm/sppm.layout.h"

BUFFER_RO(0, PhotonMapParams, params)
BUFFER_RO(1, SppmHit, ends)
BUFFER_RO(2, vec4, queries)
BUFFER_RO(3, vec4, gathered)
BUFFER_RW(4, SppmHit, hits)

KERNEL(photon_map_add) {
    float radius = queries[index].w;
    if (radius < 0.0f) return;
    float share = 1.0f / (PI * max(radius * radius, SMALLEST_RADIUS_SQUARED) * float(params[0].gather));
    vec3 arriving = vec3(ends[index].throughput) * vec3(gathered[index]) * share;
    vec3 radiance = vec3(hits[index].throughput) * arriving;
    hits[index].radiance += vec4(radiance.x, radiance.y, radiance.z, 0.0f);
}
