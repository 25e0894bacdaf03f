// Follows a path from a light, and connects each vertex to the camera (Dutre, Lafortune and Willems 1993).
#include "core/kernel/scene.h"

#include "core/kernel/film.h"
#include "core/kernel/camera_connect.h"
#include "integrators/light/light_layout.h"

BUFFER_RO(0, FilmWindow, window)
BUFFER_RO(1, LightPass, passes)
BUFFER_RW(2, uint, splats)
BUFFER_RW(3, uint, rays)  // a counter

#include "core/kernel/splat.h"

CONST uint LIGHT_STREAM = 0x1b873593u;  // separates the numbers from those of pixels
// Dimensions of a vertex.
CONST uint LIGHT_LOBE = 0u;
CONST uint LIGHT_DIRECTION = 1u;
CONST uint LIGHT_ROULETTE = 3u;
CONST uint LIGHT_LENS = 4u;
CONST uint LIGHT_PIXEL = 6u;
CONST uint LIGHT_VERTEX_DIMENSIONS = 8u;

// Adds to the picture what the light path shows at the vertex.
FN void splat_vertex(IN(Walk) walk, IN(Surface) s, IN(Vertex) v, IN(Sampler) numbers, uint dimension) {
    LightPass pass = passes[0];
    vec2 u_lens = vec2(0.5f);
    if (CALLED_FOR(EFFECT_DEPTH_OF_FIELD)) u_lens = sample_2d_at(numbers, dimension + LIGHT_LENS);
    CameraConnection c;
    if (!camera_connect(s.position, u_lens, c) || !splat_reaches(c.raster)) return;
    float weight;
    ivec2 pixel = splat_pixel(c.raster, sample_2d_at(numbers, dimension + LIGHT_PIXEL), weight);
    FilmWindow w = window[0];
    int x = pixel.x - int(w.x);
    int y = pixel.y - int(w.y);
    if (x < 0 || y < 0 || x >= int(w.width) || y >= int(w.height)) return;
    vec3 wi = to_local(v.frame, c.wi);
    Spectrum f = bsdf_eval(v.bsdf, v.wo, wi, TRANSPORT_IMPORTANCE);
    if (is_black(f)) return;
    float cosine = importance_cosine(walk, s, v, c.wi);
    Spectrum through = scene_transmittance(s, c.wi, c.distance, c.end, walk.medium);
    if (is_black(through)) return;
    Spectrum value = walk.throughput * f * through * (cosine * c.importance);
    vec3 rgb = film_sensor(value * pass.brightness) * (weight / pass.brightness);
    uint key = hash_combine(hash_combine(numbers.key, numbers.index), dimension);
    splat_add(uint(y) * w.width + uint(x), rgb, pass.quantum, key);
}

KERNEL(light_paths) {
    LightPass pass = passes[0];
    // The paths of one pass are a stratified set: the path is the sample, and the pass's number replaces the pixel's.
    Sampler numbers = sampler_begin(pass.number, index, pass.seed ^ LIGHT_STREAM, pass.sampler_kind);
    uint u_choice = 0u;
    if (scene[0].light_count > 1u) u_choice = sample_bits_1d_at(numbers, 0u);
    uvec2 u_emission = sample_bits_2d_at(numbers, 4u);
    Emission start;
    if (!emit_photon(u_choice, sample_1d_at(numbers, 1u), sample_2d_at(numbers, 2u), u_emission, start)) return;
    Walk walk = walk_begin(ray_of(start.origin, start.direction), start.medium, TRANSPORT_IMPORTANCE, pass.maxdepth);
    walk.throughput = start.power / float(pass.paths);
    Surface s;
    while (walk_next(walk, s)) {
        if (HAS(EFFECT_MEDIUM) && is_black(walk.throughput)) break;
        if (walk_crosses(walk, s)) continue;
        if (walk.depth >= walk.maxdepth) break;
        Vertex v = walk_vertex(walk, s);
        uint dimension = EMISSION_DIMENSIONS + uint(walk.depth) * LIGHT_VERTEX_DIMENSIONS;
        if (!bsdf_is_specular(v.bsdf)) splat_vertex(walk, s, v, numbers, dimension);
        BsdfSample next;
        float u_lobe = 0.0f;
        if (bsdf_chooses_lobe(v.bsdf)) u_lobe = sample_1d_at(numbers, dimension + LIGHT_LOBE);
        vec2 u_direction = sample_2d_at(numbers, dimension + LIGHT_DIRECTION);
        if (!bsdf_sample(v.bsdf, v.wo, u_lobe, u_direction, TRANSPORT_IMPORTANCE, next)) break;
        if (!walk_leave(walk, s, v, next, 0, numbers, dimension + LIGHT_ROULETTE)) break;
    }
    ATOMIC_ADD_U32(rays[0], traced_rays[0]);
}
