// Merges a camera path's vertex with the photons around it: the light paths that could have continued the path there (Georgiev,
// Krivanek, Davidovic and Slusallek 2012; Hachisuka, Pantaleoni and Jensen 2012).
#include "core/kernel/scene.h"

#include "core/kernel/gather.h"
#include "core/kernel/path_log_merge.h"
#include "integrators/bidirectional/path_vertex.h"

BUFFER_RO(16, BidirectionalPass, passes)
BUFFER_RO(17, PathVertexRecord, merged)
BUFFER_RO(18, vec4, photon_sums)
BUFFER_RW(19, vec4, gathered)

#include "integrators/bidirectional/weights.h"

// Smaller cosines of arriving photons count as this one, because |wi.Ns| / |wi.Ng| is not bounded.
CONST float LEAST_PHOTON_COSINE = 1e-2f;

struct MergePoint {
    Vertex vertex;
    vec3 ng;  // on the camera's side
    uint both_sides;
    MisSums mis;
    int depth;
    float opacity;
};

struct Gathered {
    MergePoint point;
    vec4 sum;  // BSDF times power times weight; w: number of photons
};

FN MergePoint merge_point(IN(PathVertexRecord) x) {
    MergePoint p;
    vec3 direction = path_vertex_direction(x);
    Surface s;
    p.vertex = path_vertex(x, s);
    p.ng = dot3(s.ng, direction) > 0.0f ? -s.ng : s.ng;
    p.both_sides = bsdf_transmits(p.vertex.bsdf) ? 1u : 0u;
    p.mis = path_vertex_sums(x);
    p.depth = path_vertex_depth(x);
    p.opacity = surface_opacity(s);
    return p;
}

// The photon in the path log; `f`: the BSDF and the factors of the estimate, except for the weight and the disk's area.
RARE_FN void log_merged_vertex(int depth, uint query, PhotonRecord photon, uint photon_depth, Spectrum f, float weight,
                               float count) {
    float radius = passes[0].radius;
    Spectrum value = path_vertex_throughput(merged[query]) * f * photon_power(photon) / (PI * radius * radius);
    log_merge(0u, uint(depth) - 1u, photon_depth + 1u, photon, value, weight, count);
}

// Photon and camera path both chose to stop at a mask, but the path has this vertex once: hence the opacity.
FN vec4 merge(IN(MergePoint) p, uint query, IN(PhotonRecord) photon, float count) {
    BidirectionalPass pass = passes[0];
    vec4 sums = photon_sums[photon.place.w];
    vec3 incident = -photon_direction(photon);
    float cosine = dot3(incident, p.ng);
    if (p.depth + int(sums.z) - 1 > pass.maxdepth || !(p.both_sides != 0u || cosine > 0.0f)) return vec4(0.0f);
    vec3 wi = to_local(p.vertex.frame, incident);
    float forward;
    float reverse;
    Spectrum f = bsdf_eval_pdfs(p.vertex.bsdf, p.vertex.wo, wi, TRANSPORT_RADIANCE, forward, reverse);
    MisSums y;
    y.a = sums.x;
    y.d = sums.y;
    uint h = heuristic();
    float others = mis_merged_end(y, forward, pass.eta, h) + mis_merged_end(p.mis, reverse, pass.eta, h);
    PATH_LOG(log_merged_vertex(p.depth, query, photon, uint(sums.z),
                               f * (count * abs(wi.z) / (max(abs(cosine), LEAST_PHOTON_COSINE) * p.opacity)),
                               mis_weight(others), count));
    float scale = count * abs(wi.z) * mis_weight(others) / (max(abs(cosine), LEAST_PHOTON_COSINE) * p.opacity);
    return slot_of(f * photon_power(photon) * scale, count);
}

FN Gathered gather_begin(uint query) {
    Gathered g;
    g.point = merge_point(merged[query]);
    g.sum = vec4(0.0f);
    return g;
}

FN void gather_add(INOUT(Gathered) g, uint query, IN(PhotonRecord) photon, float distance_squared, float weight) {
    g.sum += merge(g.point, query, photon, weight);
}

FN vec4 gather_value(uint query, IN(PhotonRecord) photon, float distance_squared) {
    return merge(merge_point(merged[query]), query, photon, 1.0f);
}

FN Gathered gather_sums(uint query, vec4 sums) {
    Gathered g;
    g.point.vertex.bsdf = no_bsdf();
    g.point.vertex.frame = frame_from_z(vec3(0.0f, 0.0f, 1.0f));
    g.point.vertex.wo = vec3(0.0f);
    g.point.ng = vec3(0.0f);
    g.point.both_sides = 0u;
    g.point.mis.a = 0.0f;
    g.point.mis.d = 0.0f;
    g.point.depth = 0;
    g.point.opacity = 1.0f;
    g.sum = sums;
    return g;
}

FN void gather_end(IN(Gathered) g, uint query) {
    float radius = passes[0].radius;
    Spectrum found = path_vertex_throughput(merged[query]) * spectrum_of(g.sum);
    gathered[query] += slot_of(found / (PI * radius * radius), g.sum.w);
}
