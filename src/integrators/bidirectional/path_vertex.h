// The contents of a PathVertexRecord, by name, and the vertex itself.
#ifndef LAMPYRIS_PATH_VERTEX
#define LAMPYRIS_PATH_VERTEX

#include "integrators/bidirectional/bidirectional_layout.h"
#include "integrators/bidirectional/mis.h"

FN vec3 path_vertex_origin(IN(PathVertexRecord) y) {
    return vec3(uintBitsToFloat(y.origin.x), uintBitsToFloat(y.origin.y), uintBitsToFloat(y.origin.z));
}
// Of the ray that arrives.
FN vec3 path_vertex_direction(IN(PathVertexRecord) y) {
    return vec3(uintBitsToFloat(y.direction.x), uintBitsToFloat(y.direction.y), uintBitsToFloat(y.direction.z));
}
FN uint path_vertex_previous(IN(PathVertexRecord) y) { return y.more.y; }
// Number of the scattering vertex on the path, from 1, and number among the path's stored vertices, from 1.
FN int path_vertex_depth(IN(PathVertexRecord) y) { return int(y.more.z >> 16u); }
FN uint path_vertex_rank(IN(PathVertexRecord) y) { return y.more.z & 0xffffu; }
FN Spectrum path_vertex_throughput(IN(PathVertexRecord) y) { return spectrum_of(y.throughput); }
FN MisSums path_vertex_sums(IN(PathVertexRecord) y) {
    MisSums m;
    m.a = uintBitsToFloat(y.more.w);
    m.d = y.throughput.w;
    return m;
}

FN PathVertexRecord path_vertex_record(IN(Ray) ray, IN(Surface) s, Spectrum throughput, IN(MisSums) m, uint depth,
                                       uint rank, uint previous) {
    PathVertexRecord y;
    y.origin =
        uvec4(floatBitsToUint(ray.origin.x), floatBitsToUint(ray.origin.y), floatBitsToUint(ray.origin.z), s.instance);
    y.direction = uvec4(floatBitsToUint(ray.direction.x), floatBitsToUint(ray.direction.y),
                        floatBitsToUint(ray.direction.z), s.geometry);
    y.more = uvec4(s.primitive, previous, depth << 16u | rank, floatBitsToUint(m.a));
    y.throughput = slot_of(throughput, m.d);
    return y;
}

FN Vertex path_vertex(IN(PathVertexRecord) y, OUT(Surface) s) {
    Hit hit;
    hit.instance = y.origin.w;
    hit.geometry = y.direction.w;
    hit.primitive = y.more.x;
    s = no_surface();
    vec3 direction = path_vertex_direction(y);
    surface_at(hit, path_vertex_origin(y), direction, s);
    return vertex_at(s, direction);
}

#endif
