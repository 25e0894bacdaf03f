// Connects points to the camera, evaluates the pixel filter at pixels, and splats numbers.
#include "core/kernel/scene.h"
#include "core/kernel/camera_connect.h"

CONST uint PROBE_CONNECT =
    0u;                       // inputs[i]: point, unused; u_lens; results: raster, distance, importance; wi; end; rays
CONST uint PROBE_PIXEL = 1u;  // inputs[2 i]: raster, u; results[i]: pixel, weight
CONST uint PROBE_SPLAT = 2u;  // inputs[2 i]: colour, pixel; inputs[2 i + 1].x: quantum
CONST uint PROBE_SUM = 3u;    // inputs[2 i]: the quantum and pixel i; results[i]: sum, lost

BUFFER_RO(0, uvec4, what)
BUFFER_RO(1, vec4, inputs)
BUFFER_RW(2, vec4, results)
BUFFER_RW(3, uint, splats)

#include "core/kernel/splat.h"
#include "core/kernel/splat_sum.h"

KERNEL(connect_probe) {
    uint kind = what[0].x;
    vec4 first = inputs[2u * index];
    vec4 second = inputs[2u * index + 1u];
    if (kind == PROBE_CONNECT) {
        CameraConnection c;
        c.wi = vec3(0.0f);  // GCC does not see that it is not read unless it is set
        c.end = vec3(0.0f);
        bool seen = camera_connect(vec3(first), vec2(second.x, second.y), c);
        results[3u * index] = vec4(0.0f, 0.0f, -1.0f, 0.0f);
        if (!seen) return;
        results[3u * index] = vec4(c.raster.x, c.raster.y, c.distance, c.importance);
        results[3u * index + 1u] = vec4(c.wi.x, c.wi.y, c.wi.z, 0.0f);
        results[3u * index + 2u] = vec4(c.end.x, c.end.y, c.end.z, 0.0f);
    } else if (kind == PROBE_PIXEL) {
        float weight;
        ivec2 pixel = splat_pixel(vec2(first.x, first.y), vec2(first.z, first.w), weight);
        results[index] =
            vec4(float(pixel.x), float(pixel.y), weight, splat_reaches(vec2(first.x, first.y)) ? 1.0f : 0.0f);
    } else if (kind == PROBE_SPLAT) {
        splat_add(uint(first.w), vec3(first), second.x, hash_combine(what[0].y, index));
    } else {
        uint lost;
        vec3 sum = splat_sum(index, first.x, lost);
        results[index] = vec4(sum.x, sum.y, sum.z, float(lost));
    }
}
