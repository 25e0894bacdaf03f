// For mis_test: the weights of all strategies of a path, by the recursion of mis.h. The host gives what lights, camera and
// materials would. The ends are weighed as in subpath.h and in the kernels of bdpt.
#include "core/kernel/prelude.h"
#include "core/kernel/math.h"
#include "integrators/bidirectional/mis.h"

CONST uint PROBE_AREA = 0u;
CONST uint PROBE_PASSED = 1u;  // an area light that rays pass
CONST uint PROBE_INFINITE = 2u;
CONST uint PROBE_POINT = 3u;
CONST uint PROBE_DISTANT = 4u;

// Places per path: s vertices from the light, 0 to 7; then those of merging at vertex 0 to 7.
CONST uint PROBE_STRATEGIES = 8u;
CONST uint PROBE_WEIGHTS = 16u;

struct ProbeVertex {
    vec4 position;    // at infinity: a point in the light's direction from the next vertex
    vec4 normal;      // geometric
    float to_camera;  // densities (1/sr) of the directions to the next and to the previous vertex
    float to_light;
    float eta;  // relative index, of a light path's refraction
    uint specular;
};

struct ProbePath {
    uint first;  // vertex; it is on the light, and the last one is on the camera
    uint count;
    uint light;  // PROBE_*
    uint orthographic;
    float pe;  // density of the start on the light
    float pw;  // of a light ray: per solid angle, at infinity per area; area lights: unused, it is that of their cosine
    float pd;  // of next-event estimation from vertex 1 (1/sr); other lights: pe
    float sides;
    float pc;  // of a camera ray: 1/sr, or per area if orthographic
    float lens_samples;
    float radius;   // of the scene
    float samples;  // of each strategy that connects two vertices
    float eta;      // of merging; 0: none
};

BUFFER_RO(0, uvec4, what)  // heuristic
BUFFER_RO(1, ProbePath, paths)
BUFFER_RO(2, ProbeVertex, vertices)
BUFFER_RW(3, float, weights)  // -1: no such strategy

PRIVATE(vec2, light_sums, 8)  // of the light path at each vertex

FN float mis_area(IN(ProbePath) p, float area) { return area / sqr(p.radius); }
FN float mis_area_density(IN(ProbePath) p, float density) { return density * sqr(p.radius); }
FN float mis_weight(float others) { return 1.0f / (1.0f + others); }

FN vec3 way(uint from, uint to) { return vec3(vertices[to].position) - vec3(vertices[from].position); }
FN float cosine(uint at, uint other) { return dot3(unit(way(at, other)), vec3(vertices[at].normal)); }

// light_path_begin, light_path_meets_first
FN MisSums light_begins(IN(ProbePath) p, uint h) {
    MisSums m;
    m.a = 0.0f;
    m.d = 0.0f;
    if (p.light <= PROBE_PASSED) {
        m.a = mis_area(p, PI * p.sides / p.pe);
        if (p.light != PROBE_PASSED) m.d = m.a;
    } else if (p.light != PROBE_POINT) {
        m.a = mis_area(p, 1.0f / p.pw);
        if (p.light != PROBE_DISTANT) m.d = m.a / p.pe;
    } else {
        m.a = 1.0f / p.pw;
    }
    m.a = mis_term(m.a, h);
    m.d = mis_term(m.d, h);
    if (p.light <= PROBE_PASSED) m.a = m.a * mis_term(p.pd, h);
    return m;
}

// CameraConnection::importance of the last vertex but one
FN float importance(IN(ProbePath) p, uint at) {
    return p.orthographic != 0u ? p.pc : p.pc / length_squared(way(at, at + 1u));
}

// subpath_arrives
FN void arrives(IN(ProbePath) p, INOUT(MisSums) m, uint at, uint previous, bool no_distance, uint h) {
    float d2 = no_distance ? 1.0f : mis_area(p, length_squared(way(previous, at)));
    mis_arrive(m, d2, cosine(at, previous), h);
    if (previous != p.first && previous + 1u != p.first + p.count) m.a *= mis_term(p.samples, h);
}

// subpath_leaves
FN void leaves(IN(ProbePath) p, INOUT(MisSums) m, uint at, uint previous, uint next, uint h) {
    ProbeVertex v = vertices[at];
    bool from_light = next > at;
    if (v.specular != 0u) {
        mis_scatter_specular(m, cosine(at, previous), from_light ? v.eta : 1.0f / v.eta, h);
    } else {
        mis_scatter(m, cosine(at, next), from_light ? v.to_camera : v.to_light, from_light ? v.to_light : v.to_camera,
                    p.eta, h);
    }
}

// connect_to_light
FN float weight_of_light(IN(ProbePath) p, IN(MisSums) m, uint h) {
    uint x = p.first + 1u;
    float emitted;
    if (p.light <= PROBE_PASSED) {
        emitted = mis_area_density(p, p.pe) * INV_PI / (p.sides * p.pd);
    } else if (p.light == PROBE_POINT) {
        emitted = p.pw / mis_area(p, length_squared(way(x, p.first)));
    } else {
        emitted = mis_area_density(p, p.pw);
    }
    float others = mis_end(m, emitted * abs(cosine(x, p.first)), vertices[x].to_camera, p.eta, h);
    if (p.light == PROBE_AREA || p.light == PROBE_INFINITE) others += mis_term(vertices[x].to_light / p.pd, h);
    return mis_weight(others);
}

// connect_to_vertex: y = x - 1
FN float weight_of_connection(IN(ProbePath) p, IN(MisSums) m, uint x, uint h) {
    uint y = x - 1u;
    vec2 sums = light_sums[y - p.first];
    MisSums m_y;
    m_y.a = sums.x;
    m_y.d = sums.y;
    float inverse_d2 = 1.0f / mis_area(p, length_squared(way(x, y)));
    float from_x = vertices[x].to_light * abs(cosine(y, x)) * inverse_d2;
    float from_y = vertices[y].to_camera * abs(cosine(x, y)) * inverse_d2;
    float others =
        mis_end(m_y, from_x, vertices[y].to_light, p.eta, h) + mis_end(m, from_y, vertices[x].to_camera, p.eta, h);
    return mis_weight(others / mis_term(p.samples, h));
}

// merge.consumer.h
FN float weight_of_merging(IN(ProbePath) p, IN(MisSums) m, uint at, uint h) {
    vec2 sums = light_sums[at - p.first];
    MisSums y;
    y.a = sums.x;
    y.d = sums.y;
    return mis_weight(mis_merged_end(y, vertices[at].to_light, p.eta, h) +
                      mis_merged_end(m, vertices[at].to_camera, p.eta, h));
}

// weight_of_hit_light, weight_of_environment: the sums are those that leave vertex 1
FN float weight_of_hit(IN(ProbePath) p, IN(MisSums) m, uint h) {
    float emitted = p.light == PROBE_AREA ? mis_area_density(p, p.pe) * INV_PI / p.sides : 0.0f;
    if (p.light == PROBE_AREA) return mis_weight(mis_term(p.pd, h) * m.a + mis_term(emitted, h) * m.d);
    return mis_weight(mis_term(p.pd, h) * (m.a + mis_term(mis_area_density(p, p.pw), h) * m.d));
}

KERNEL(mis_probe) {
    uint h = what[0].x;
    ProbePath p = paths[index];
    uint result = PROBE_WEIGHTS * index;
    for (uint s = 0u; s < PROBE_WEIGHTS; ++s) weights[result + s] = -1.0f;
    uint camera = p.first + p.count - 1u;

    MisSums m = light_begins(p, h);
    for (uint i = 1u; i + 1u < p.count; ++i) {
        uint at = p.first + i;
        arrives(p, m, at, at - 1u, i == 1u && p.light != PROBE_POINT, h);
        light_sums[i] = vec2(m.a, m.d);
        if (at + 1u == camera && vertices[at].specular == 0u) {  // splat_vertex
            float from_camera = mis_area_density(p, importance(p, at) * abs(cosine(at, camera))) / p.lens_samples;
            weights[result + i + 1u] = mis_weight(mis_end(m, from_camera, vertices[at].to_light, p.eta, h));
        }
        leaves(p, m, at, at - 1u, at + 1u, h);
    }

    m.a = mis_term(p.lens_samples / mis_area_density(p, importance(p, camera - 1u)), h);  // camera_path_meets_first
    m.d = 0.0f;
    for (uint i = p.count - 2u; i > 0u; --i) {
        uint at = p.first + i;
        arrives(p, m, at, at + 1u, at + 1u == camera, h);
        if (vertices[at].specular == 0u) {
            if (p.eta > 0.0f) weights[result + PROBE_STRATEGIES + i] = weight_of_merging(p, m, at, h);
            if (i == 1u) {
                weights[result + 1u] = weight_of_light(p, m, h);
            } else if (vertices[at - 1u].specular == 0u) {
                weights[result + i] = weight_of_connection(p, m, at, h);
            }
        }
        leaves(p, m, at, at + 1u, at - 1u, h);
    }
    if (p.light == PROBE_AREA || p.light == PROBE_INFINITE) weights[result] = weight_of_hit(p, m, h);
}
