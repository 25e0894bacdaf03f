// Passes on the sums that photons splatted onto each query.
#include "core/kernel/gather.h"
#include "accel/photons/splat/splat_layout.h"

BUFFER_RO(1, SplatRecord, splat)
BUFFER_RO(6, uvec2, sums)  // low and high half of each

FN float splat_sum(uint place, float scale) {
    uvec2 halves = sums[place];
    return (float(halves.y) * 4294967296.0f + float(halves.x)) / scale;
}

KERNEL(splat_finish) {
    if (queries[index].w < 0.0f) return;
    vec4 scale = splat[0].scale;
    vec4 value = vec4(splat_sum(4u * index, scale.x), splat_sum(4u * index + 1u, scale.y),
                      splat_sum(4u * index + 2u, scale.z), splat_sum(4u * index + 3u, scale.w));
    gather_end(gather_sums(index, value), index);
}
