// Subpaths from either end, with the sums for their weights (mis.h). The kernel declares `passes`.
#ifndef LAMPYRIS_SUBPATH
#define LAMPYRIS_SUBPATH

#include "core/kernel/camera_connect.h"
#include "integrators/bidirectional/weights.h"

// A path and its sums.
struct Subpath {
    Walk walk;
    MisSums mis;
    vec3 previous;     // position of the previous vertex
    bool no_distance;  // there is none, because the path starts at infinity
    bool is_specular;  // so far
};

// No path, with all members initialised.
FN Subpath no_subpath() {
    Subpath path;
    path.walk.ray = ray_of(vec3(0.0f), vec3(0.0f, 0.0f, 1.0f));
    path.walk.throughput = Spectrum(0.0f);
    path.walk.eta_scale = 1.0f;
    path.walk.transport = TRANSPORT_RADIANCE;
    path.walk.medium = MEDIUM_VACUUM;
    path.walk.depth = 0;
    path.walk.maxdepth = 0;
    path.walk.passed = 0u;
    path.walk.escaped = false;
    path.mis.a = 0.0f;
    path.mis.d = 0.0f;
    path.previous = vec3(0.0f);
    path.no_distance = true;
    path.is_specular = true;
    return path;
}

// The sums as they arrive at s, the next vertex.
FN void subpath_arrives(INOUT(Subpath) path, IN(Surface) s) {
    float d2 = path.no_distance ? 1.0f : mis_area(length_squared(s.position - path.previous));
    path.no_distance = false;
    mis_arrive(path.mis, d2, dot3(path.walk.ray.direction, s.ng), heuristic());
    // What joins this vertex to the previous one: next-event estimation or a splat at the first vertex, a connection at others.
    if (passes[0].strategies == STRATEGIES_MERGING || (passes[0].connections == 0 && path.walk.depth > 0))
        path.mis.a = 0.0f;
    if (path.walk.depth > 0) path.mis.a *= connection_samples();
}

// Continues from the vertex at s in the sampled direction; `density` is that of bsdf_sample_density. False if the path ends.
FN bool subpath_leaves(INOUT(Subpath) path, IN(Surface) s, IN(Vertex) v, IN(BsdfSample) next, float density,
                       int rrdepth, IN(Sampler) numbers, uint dimension) {
    if ((next.lobe & LOBE_SPECULAR) != 0u) {
        mis_scatter_specular(path.mis, dot3(path.walk.ray.direction, s.ng), next.eta, heuristic());
    } else {
        float reverse = bsdf_pdf(v.bsdf, next.wi, v.wo, TRANSPORT_IMPORTANCE - path.walk.transport);
        mis_scatter(path.mis, dot3(to_world(v.frame, next.wi), s.ng), density, reverse, passes[0].eta, heuristic());
        path.is_specular = false;
    }
    path.previous = s.position;
    return walk_leave(path.walk, s, v, next, rrdepth, numbers, dimension);
}

// ---- The light's end ---------------------------------------------------------------------------------------------------

// The ray that a light emits, before it reaches the first vertex: d is complete but for that vertex's cosine, a needs the
// density of sampling the light from there (light_path_meets_first).
FN Subpath light_path_begin(IN(Emission) start, int maxdepth) {
    Subpath path;
    path.walk = walk_begin(ray_of(start.origin, start.direction), start.medium, TRANSPORT_IMPORTANCE, maxdepth);
    path.walk.throughput = start.power;
    path.previous = start.position;
    path.is_specular = true;
    path.no_distance = true;  // the quotients of densities below have no distances, or include them
    uint kind = lights[start.light].kind;
    path.mis.a = 0.0f;
    path.mis.d = 0.0f;
    if (kind <= LIGHT_GEOMETRY) {
        // The cosine over place_pdf direction_pdf; times the density of sampling the light from the vertex.
        path.mis.a = mis_area(PI * light_sides(lights[start.light]) / start.place_pdf);
        if ((lights[start.light].flags & LIGHT_PASSED) == 0u) path.mis.d = path.mis.a;
    } else if (kind == LIGHT_INFINITE || kind == LIGHT_INFINITE_IMAGE || kind == LIGHT_DISTANT) {
        path.mis.a = mis_area(1.0f / start.direction_pdf);
        if (kind != LIGHT_DISTANT) path.mis.d = path.mis.a / start.place_pdf;
    } else {
        path.mis.a = 1.0f / start.direction_pdf;
        path.no_distance = false;
    }
    path.mis.a = mis_term(path.mis.a, heuristic());
    path.mis.d = passes[0].strategies == STRATEGIES_MERGING ? 0.0f : mis_term(path.mis.d, heuristic());
    return path;
}

// To be called at the first vertex, before subpath_arrives: next-event estimation from s samples area lights in another way
// than emission.
FN void light_path_meets_first(INOUT(Subpath) path, IN(Emission) start, IN(Surface) s) {
    uint kind = lights[start.light].kind;
    if (!HAS(EFFECT_AREA_LIGHTS) || kind > LIGHT_GEOMETRY) {
        if (HAS(EFFECT_LIGHT_TREE))
            path.mis.a *=
                mis_term(light_choice_probability(start.light, s.position) / choice_by_power(start.light), heuristic());
        return;
    }
    float density = area_light_pdf(start.light, s.position, start.position, start.ng, -start.direction);
    path.mis.a = path.mis.a * mis_term(density, heuristic());
}

// ---- The camera's end --------------------------------------------------------------------------------------------------

FN Subpath camera_path_begin(IN(Ray) ray, int maxdepth) {
    Subpath path;
    path.walk = walk_begin(ray, camera_medium(), TRANSPORT_RADIANCE, maxdepth);
    path.previous = ray.origin;
    path.no_distance = true;
    path.is_specular = true;
    path.mis.a = 0.0f;
    path.mis.d = 0.0f;
    return path;
}

// To be called at the first vertex, before subpath_arrives.
FN void camera_path_meets_first(INOUT(Subpath) path, IN(Surface) s) {
    float importance = camera_ray_importance(path.walk.ray.direction, distance_of(s.position, path.previous));
    path.mis.a = mis_term(lens_samples() / mis_area_density(importance), heuristic());
}

// The weight of emission of the area light at s that the path finds by chance, before it arrives there: strategy s = 0.
FN float weight_of_hit_light(IN(Subpath) path, IN(Surface) s) {
    if (path.walk.depth == 0) return 1.0f;
    if (passes[0].strategies == STRATEGIES_MERGING) return path.is_specular ? 1.0f : 0.0f;
    vec3 w = path.walk.ray.direction;
    float direct = area_light_pdf(s.light, path.previous, s.position, s.ng, w);
    float emitted = mis_area_density(area_emission_pdf(s.light, path.previous, s.position, s.ng, w)) * INV_PI /
                    light_sides(lights[s.light]);
    uint h = heuristic();
    return mis_weight(mis_term(direct, h) * path.mis.a + mis_term(emitted, h) * path.mis.d);
}

// The same for radiance from infinite lights.
FN float weight_of_environment(IN(Subpath) path) {
    if (path.walk.depth == 0) return 1.0f;
    if (passes[0].strategies == STRATEGIES_MERGING) return path.is_specular ? 1.0f : 0.0f;
    float direct = environment_pdf(path.walk.ray.direction, false);
    uint h = heuristic();
    return mis_weight(mis_term(direct, h) *
                      (path.mis.a + mis_term(mis_area_density(1.0f / distant_area()), h) * path.mis.d));
}

#endif
