// Computes where a ray hits a quadric or a patch, and whether a ray that leaves that point finds the shape again.
#include "core/kernel/scene.h"

// rays[3 i ...]: origin, geometry; direction, primitive; direction in which to leave, t_max.
BUFFER_RO(0, vec4, rays)
// results[9 i ...]: (hit, t, uv); position; error; ng; dpdu; dpdv; dndu; dndv; (hit again, t, hit before t_max, -).
BUFFER_RW(1, vec4, results)

KERNEL(shape_probe) {
    vec3 o = vec3(rays[3u * index]);
    vec3 d = vec3(rays[3u * index + 1u]);
    vec3 leave = vec3(rays[3u * index + 2u]);
    float t_max = rays[3u * index + 2u].w;
    uint geometry = uint(rays[3u * index].w);
    uint primitive = uint(rays[3u * index + 1u].w);
    bool is_patch = geometries[geometry].kind == GEOMETRY_BILINEAR;
    Surface s = no_surface();
    bool hit;
    bool before;
    float t = 0.0f;
    vec2 uv;
    if (is_patch) {
        hit = bilinear_surface(geometry, primitive, o, d, s);
        before = bilinear_hit(geometry, primitive, o, d, t_max, t, uv);
    } else {
        hit = quadric_surface(geometry, o, d, s);
        before = quadric_hit(geometry, o, d, t_max, t);
    }
    uint at = 9u * index;
    if (!hit) {
        for (uint i = 0u; i < 9u; ++i) results[at + i] = vec4(0.0f);
        return;
    }
    vec3 start = offset_origin(s.position, s.error, s.ng, leave);
    float t_again = 0.0f;
    bool again = is_patch ? bilinear_hit(geometry, primitive, start, leave, INFINITE_DISTANCE, t_again, uv)
                          : quadric_hit(geometry, start, leave, INFINITE_DISTANCE, t_again);
    results[at] = vec4(1.0f, s.distance, s.uv.x, s.uv.y);
    results[at + 1u] = vec4(s.position, 0.0f);
    results[at + 2u] = vec4(s.error, 0.0f);
    results[at + 3u] = vec4(s.ng, 0.0f);
    results[at + 4u] = vec4(s.dpdu, 0.0f);
    results[at + 5u] = vec4(s.dpdv, 0.0f);
    results[at + 6u] = vec4(s.dndu, 0.0f);
    results[at + 7u] = vec4(s.dndv, 0.0f);
    results[at + 8u] = vec4(again ? 1.0f : 0.0f, t_again, before ? 1.0f : 0.0f, 0.0f);
}
