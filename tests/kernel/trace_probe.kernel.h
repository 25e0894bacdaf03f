// For trace_test: what a ray hits, and whether it is occluded.
#include "core/kernel/scene.h"

struct ProbeRay {
    vec4 origin;  // w: t_max
    vec4 direction;
};

BUFFER_RO(0, ProbeRay, rays)
BUFFER_RW(1, uvec4, hits)

KERNEL(trace_probe) {
    Hit hit;
    vec3 o = vec3(rays[index].origin);
    vec3 d = vec3(rays[index].direction);
    float t_max = rays[index].origin.w;
    bool found = trace_closest(o, d, t_max, hit);
    bool occluded = trace_occluded(o, d, t_max);
    uvec4 answer = uvec4(NONE, NONE, NONE, occluded ? 1u : 0u);
    if (found) answer = uvec4(hit.instance, hit.geometry, hit.primitive, answer.w);
    hits[index] = answer;
}
