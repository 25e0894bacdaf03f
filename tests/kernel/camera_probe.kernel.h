// Generates the camera's rays and the pixel filter's offsets.
#include "core/kernel/scene.h"

CONST uint PROBE_FILTER = 0u;  // results[i]: offset, weight
CONST uint PROBE_RAY = 1u;     // inputs[i]: raster, u_lens; results[2 i ...]: origin; direction

BUFFER_RO(0, uvec4, what)  // operation, seed
BUFFER_RO(1, vec4, inputs)
BUFFER_RW(2, vec4, results)

KERNEL(camera_probe) {
    if (what[0].x == PROBE_FILTER) {
        Rng rng = rng_begin(what[0].y, index);
        vec2 u;
        u.x = rng_float(rng);
        u.y = rng_float(rng);
        float weight;
        vec2 offset = pixel_filter_sample(u, weight);
        results[index] = vec4(offset.x, offset.y, weight, 0.0f);
        return;
    }
    Ray ray = camera_ray(vec2(inputs[index].x, inputs[index].y), vec2(inputs[index].z, inputs[index].w));
    results[2u * index] = vec4(ray.origin, 0.0f);
    results[2u * index + 1u] = vec4(ray.direction, 0.0f);
}
