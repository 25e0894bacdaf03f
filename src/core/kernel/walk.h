// Following a path from surface to surface: the common part of camera paths, eye paths and photons.
//
//     Walk walk = walk_begin(ray, medium, TRANSPORT_RADIANCE, maxdepth);
//     Surface s;
//     while (walk_next(walk, s)) {                // the next surface that stops the ray
//         ...                                     // its emission
//         if (walk_crosses(walk, s)) continue;    // it only bounds a medium
//         Vertex v = walk_vertex(walk, s);
//         if (walk.depth >= maxdepth) break;
//         ...                                     // direct light, or light from photons
//         BsdfSample next;
//         if (!bsdf_sample(v.bsdf, v.wo, u_lobe, u, walk.transport, next)) break;
//         if (!walk_leave(walk, s, v, next, rrdepth, numbers, dimension)) break;
//     }
//     if (walk.escaped) ...                       // the environment
//
// The walk attenuates its throughput in media, offsets the origins of rays by rounding errors, bounds the number of
// surfaces that it visits, and reports a loop that the driver ended early.
#ifndef LAMPYRIS_KERNEL_WALK
#define LAMPYRIS_KERNEL_WALK

struct Walk {
    Ray ray;              // starts at the last vertex, or at the last surface that let it pass
    Spectrum throughput;  // radiance: weight of the radiance along the ray; importance: power that the ray carries
    float eta_scale;      // undoes the scaling of radiance by refraction, for Russian roulette
    uint transport;       // TRANSPORT_*: radiance flows against the ray, importance along it
    uint medium;          // in which the ray is
    int depth;            // scattering vertices so far
    int maxdepth;         // maximum of depth
    uint passed;          // masks and interfaces passed so far
    bool escaped;         // the ray left the scene
};

// A point where the walk may scatter. Directions are local to `frame` (z: shading normal) and point away from the surface.
struct Vertex {
    Bsdf bsdf;
    Frame frame;
    vec3 wo;  // towards the previous vertex
};

#include "core/kernel/walk_log.h"

// ---- Loops that a driver ends ----------------------------------------------------------------------------------------
// A turn begins by setting walk_turn to walk_turns, and resets it to less once another turn is known to follow. So the
// two are equal if the loop's own code left it, and differ if the driver ended it. Both are 0 until the first turn,
// because a walk need not have one. They are not members of Walk, so that authors of loops can ignore them.

PRIVATE(uint, walk_turn, 1)
PRIVATE(uint, walk_turns, 1)

FN void walk_check() {
    if (DRIVERS_END_LOOPS && walk_turn[0] != walk_turns[0]) REPORT_UNFINISHED();
}

FN void walk_opens() {
    if (!DRIVERS_END_LOOPS) return;
    walk_check();  // of the previous walk
    walk_turn[0] = 0u;
    walk_turns[0] = 0u;
}

FN bool walk_takes_turn(IN(Walk) w) {
    if (HAS(EFFECT_INTERFACE | EFFECT_ALPHA) && w.passed > MAX_PASSED_SURFACES) return false;
    if (!DRIVERS_END_LOOPS) return true;
    bool first = walk_turns[0] == 0u;
    if (first) walk_turns[0] = uint(w.maxdepth) + MAX_PASSED_SURFACES + 2u;  // more than a walk has
    if (!first && !(walk_turn[0] < walk_turns[0])) return false;
    walk_turn[0] = walk_turns[0];
    return true;
}

FN void walk_goes_on(IN(Walk) w) {
    if (DRIVERS_END_LOOPS) walk_turn[0] = uint(w.depth) + w.passed;
}

// ---- The walk --------------------------------------------------------------------------------------------------------

FN Walk walk_begin(IN(Ray) ray, uint medium, uint transport, int maxdepth) {
    Walk w;
    w.ray = ray;
    w.throughput = Spectrum(1.0f);
    w.eta_scale = 1.0f;
    w.transport = transport;
    w.medium = medium;
    w.depth = 0;
    w.maxdepth = maxdepth;
    w.passed = 0u;
    w.escaped = false;
    walk_opens();
    PATH_LOG(log_begins(w));
    return w;
}

// The next surface that the ray hits, even if it is masked and lets the ray pass; `fate` is one of SURFACE_*. False if
// the walk is over.
FN bool walk_next_or_mask(INOUT(Walk) w, OUT(Surface) s, OUT(uint) fate) {
    if (!walk_takes_turn(w)) return false;
    w.escaped = !intersect_next(w.ray.origin, w.ray.direction, s, fate);
    if (w.escaped) {
        PATH_LOG(log_escapes(w));
        return false;
    }
    if (HAS(EFFECT_MEDIUM)) w.throughput *= medium_transmittance(w.medium, s.distance);
    return true;
}

// The next surface that stops the ray; false if the walk is over.
FN bool walk_next(INOUT(Walk) w, OUT(Surface) s) {
    if (!walk_takes_turn(w)) return false;
    w.escaped = !intersect_scene_from(w.ray.origin, w.ray.direction, s);
    if (HAS(EFFECT_MEDIUM)) w.throughput *= medium_transmittance(w.medium, w.escaped ? INFINITE_DISTANCE : s.distance);
    if (w.escaped) PATH_LOG(log_escapes(w));
    return !w.escaped;
}

// Continues straight on behind s.
FN void walk_passes(INOUT(Walk) w, IN(Surface) s) {
    PATH_LOG(log_passes(s.position, s.distance, w.medium, is_interface(s) ? LOG_PASS_INTERFACE : LOG_PASS_MASK));
    w.ray.origin = origin_beyond(s.position, s.way, w.ray.direction);
    w.passed += 1u;
    if (w.passed <= MAX_PASSED_SURFACES)
        walk_goes_on(w);
    else
        REPORT_UNFINISHED();
}

// Whether s only bounds a medium; if so, the walk continues behind it.
FN bool walk_crosses(INOUT(Walk) w, IN(Surface) s) {
    if (!HAS(EFFECT_INTERFACE) || !is_interface(s)) return false;
    w.medium = medium_behind(s, w.ray.direction, w.medium);
    walk_passes(w, s);
    return true;
}

FN bool walk_crosses_or_passes(INOUT(Walk) w, IN(Surface) s, uint fate) {
    if (fate == SURFACE_STOPS) return walk_crosses(w, s);
    walk_passes(w, s);
    return true;
}

// The vertex at s, which was reached in the given direction. Afterwards, the surface's shading normal includes the bump
// or normal map, and its material is the one that a mix chose.
FN Vertex vertex_at(INOUT(Surface) s, vec3 direction) {
    Vertex v;
    v.bsdf = material_bsdf(s, -direction, v.frame);
    v.wo = to_local(v.frame, -direction);
    return v;
}

FN Vertex walk_vertex(IN(Walk) w, INOUT(Surface) s) {
    Vertex v = vertex_at(s, w.ray.direction);
    PATH_LOG(log_vertex(w, s, v));
    return v;
}

// The cosine for f(wo, wi) if a vertex of a walk from a light, which arrived there in direction `arriving`, is connected to
// a point in the unit direction `onward`: |wi.Ns wo.Ng| / |wi.Ng|, with wi towards the light and wo onward, since shading
// normals are not symmetric (Veach 1997, equation 5.19). 0 if the light grazes the surface.
FN float importance_cosine(vec3 arriving, IN(Surface) s, IN(Vertex) v, vec3 onward) {
    float towards = abs_dot(arriving, s.ng);
    return towards > 0.0f ? abs(v.wo.z) * abs_dot(onward, s.ng) / towards : 0.0f;
}

// The factor of a sampled direction for the throughput: the BSDF times the cosine over the density, with the correction
// for shading normals that the transport requires.
FN Spectrum vertex_weight(IN(Walk) w, IN(Surface) s, IN(Vertex) v, IN(BsdfSample) next, vec3 onward) {
    if (w.transport == TRANSPORT_RADIANCE) return next.f * (abs(next.wi.z) / next.pdf);
    // Shading normals make scattering non-symmetric (Veach 1997, equation 5.19). The correction is
    // |wi.Ns wo.Ng| / (|wi.Ng| |wo.Ns|), whose |wo.Ns| cancels the cosine of the weight. wi points towards the light,
    // wo onward.
    float towards = abs_dot(w.ray.direction, s.ng);
    return towards > 0.0f ? next.f * (abs(v.wo.z) * abs_dot(onward, s.ng) / (towards * next.pdf)) : Spectrum(0.0f);
}

// Continues from s in a sampled direction, unless Russian roulette ends the walk. Call it last in a turn. Roulette may
// end the walk after `rrdepth` vertices, and uses the random number of `dimension`. The probability of survival is the
// throughput for radiance. For importance it is the remaining fraction of the power, so that photons keep about the
// same power: few bright photons would be noise.
FN bool walk_leave(INOUT(Walk) w, IN(Surface) s, IN(Vertex) v, IN(BsdfSample) next, int rrdepth, IN(Sampler) numbers,
                   uint dimension) {
    vec3 onward = unit(to_world(v.frame, next.wi));
    float before = max_value(w.throughput);
    w.throughput *= vertex_weight(w, s, v, next, onward);
    if ((next.lobe & LOBE_TRANSMISSION) != 0u) w.eta_scale *= sqr(next.eta);
    float after = max_value(w.throughput);
    float survival = w.transport == TRANSPORT_RADIANCE ? after * w.eta_scale : after / before;
    w.depth += 1;
    PATH_LOG(log_scatters(w, next, onward));
    if (!(survival > 0.0f) || w.depth > w.maxdepth) return false;
    if (w.transport == TRANSPORT_IMPORTANCE && !is_finite(after)) return false;
    if (w.depth > rrdepth && survival < 1.0f) {
        survival = exact_chance(survival);
        bool ends = sample_1d_at(numbers, dimension) >= survival;
        PATH_LOG(log_roulette(survival, ends));
        if (ends) return false;
        w.throughput = w.throughput / survival;
    }
    w.ray.direction = onward;
    w.ray.origin = origin_beyond(s.position, s.way, onward);
    w.medium = medium_behind(s, onward, w.medium);
    walk_goes_on(w);
    return true;
}

#endif
