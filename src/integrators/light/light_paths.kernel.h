// Follows a path from a light, and connects each vertex to the camera (Dutre, Lafortune and Willems 1993).
#include "core/kernel/scene.h"

#include "core/kernel/film.h"
#include "integrators/light/light_layout.h"

BUFFER_RO(0, FilmWindow, window)
BUFFER_RO(1, LightPass, passes)
BUFFER_RW(2, uint, splats)
BUFFER_RW(3, uint, rays)  // a counter

#include "integrators/bidirectional/lens_connection.h"

// Adds to the picture what the light path shows at the vertex.
FN void splat_vertex(IN(Walk) walk, IN(Surface) s, IN(Vertex) v, IN(Sampler) numbers, uint dimension) {
    LightPass pass = passes[0];
    LensConnection c;
    if (!lens_connect(s, numbers, dimension, c)) return;
    Spectrum f = bsdf_eval(v.bsdf, v.wo, to_local(v.frame, c.camera.wi), TRANSPORT_IMPORTANCE);
    if (is_black(f)) return;
    Spectrum through = scene_transmittance(s, c.camera.wi, c.camera.distance, c.camera.end, walk.medium);
    if (is_black(through)) return;
    float cosine = importance_cosine(walk.ray.direction, s, v, c.camera.wi);
    Spectrum value = walk.throughput * f * through * (cosine * c.camera.importance);
    lens_splat(c, value, float(pass.paths), pass.brightness, pass.quantum, numbers, dimension);
}

KERNEL(light_paths) {
    LightPass pass = passes[0];
    Sampler numbers = light_path_numbers(index, pass.number, pass.seed, pass.sampler_kind);
    Emission start;
    PATH_LOG(log_path(LOG_LIGHT_PATH, index, 0u));
    if (!light_path_emits(numbers, start)) return;
    Walk walk = walk_begin(ray_of(start.origin, start.direction), start.medium, TRANSPORT_IMPORTANCE, pass.maxdepth);
    walk.throughput = start.power;
    Surface s;
    while (walk_next(walk, s)) {
        if (HAS(EFFECT_MEDIUM) && is_black(walk.throughput)) break;
        if (walk_crosses(walk, s)) continue;
        if (walk.depth >= walk.maxdepth) break;
        Vertex v = walk_vertex(walk, s);
        uint dimension = light_vertex_dimension(walk);
        if (!bsdf_is_specular(v.bsdf)) splat_vertex(walk, s, v, numbers, dimension);
        BsdfSample next;
        if (!light_path_samples(v, numbers, dimension, next)) break;
        if (!walk_leave(walk, s, v, next, 0, numbers, dimension + LIGHT_ROULETTE)) break;
    }
    ATOMIC_ADD_U32(rays[0], traced_rays[0]);
}
