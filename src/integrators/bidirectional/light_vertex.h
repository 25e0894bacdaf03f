// The contents of a LightVertexRecord, by name, and the vertex itself.
#ifndef LAMPYRIS_LIGHT_VERTEX
#define LAMPYRIS_LIGHT_VERTEX

#include "integrators/bidirectional/bidirectional_layout.h"
#include "integrators/bidirectional/mis.h"

FN vec3 light_vertex_origin(IN(LightVertexRecord) y) {
    return vec3(uintBitsToFloat(y.origin.x), uintBitsToFloat(y.origin.y), uintBitsToFloat(y.origin.z));
}
// Of the ray that arrives, away from the light.
FN vec3 light_vertex_direction(IN(LightVertexRecord) y) {
    return vec3(uintBitsToFloat(y.direction.x), uintBitsToFloat(y.direction.y), uintBitsToFloat(y.direction.z));
}
FN uint light_vertex_previous(IN(LightVertexRecord) y) { return y.more.y; }
// Number of the scattering vertex on the path, from 1, and number among the path's stored vertices, from 1.
FN int light_vertex_depth(IN(LightVertexRecord) y) { return int(y.more.z >> 16u); }
FN uint light_vertex_rank(IN(LightVertexRecord) y) { return y.more.z & 0xffffu; }
FN Spectrum light_vertex_throughput(IN(LightVertexRecord) y) { return spectrum_of(y.throughput); }
FN MisSums light_vertex_sums(IN(LightVertexRecord) y) {
    MisSums m;
    m.a = uintBitsToFloat(y.more.w);
    m.d = y.throughput.w;
    return m;
}

FN LightVertexRecord light_vertex_record(IN(Ray) ray, IN(Surface) s, Spectrum throughput, IN(MisSums) m, uint depth,
                                         uint rank, uint previous) {
    LightVertexRecord y;
    y.origin =
        uvec4(floatBitsToUint(ray.origin.x), floatBitsToUint(ray.origin.y), floatBitsToUint(ray.origin.z), s.instance);
    y.direction = uvec4(floatBitsToUint(ray.direction.x), floatBitsToUint(ray.direction.y),
                        floatBitsToUint(ray.direction.z), s.geometry);
    y.more = uvec4(s.primitive, previous, depth << 16u | rank, floatBitsToUint(m.a));
    y.throughput = slot_of(throughput, m.d);
    return y;
}

FN Vertex light_vertex(IN(LightVertexRecord) y, OUT(Surface) s) {
    Hit hit;
    hit.instance = y.origin.w;
    hit.geometry = y.direction.w;
    hit.primitive = y.more.x;
    s = no_surface();
    vec3 direction = light_vertex_direction(y);
    surface_at(hit, light_vertex_origin(y), direction, s);
    return vertex_at(s, direction);
}

#endif
