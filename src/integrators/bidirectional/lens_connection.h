// Connections of light paths to the lens: strategy t = 1. The kernel declares `window` and `splats`.
#ifndef LAMPYRIS_LENS_CONNECTION
#define LAMPYRIS_LENS_CONNECTION

#include "core/kernel/camera_connect.h"
#include "core/kernel/splat.h"

CONST uint LIGHT_STREAM = 0x1b873593u;  // separates the numbers of light paths from those of pixels
// Dimensions of a light path's vertex.
CONST uint LIGHT_LOBE = 0u;
CONST uint LIGHT_DIRECTION = 1u;
CONST uint LIGHT_ROULETTE = 3u;
CONST uint LIGHT_LENS = 4u;
CONST uint LIGHT_PIXEL = 6u;
CONST uint LIGHT_VERTEX_DIMENSIONS = 8u;

// The random numbers of a light path: the paths of one pass are a stratified set, so the path is the sample, and the
// pass's number replaces the pixel's.
FN Sampler light_path_numbers(uint path, uint pass, uint seed, uint kind) {
    return sampler_begin(pass, path, seed ^ LIGHT_STREAM, kind);
}

FN bool light_path_emits(IN(Sampler) numbers, OUT(Emission) start) {
    uint u_choice = 0u;
    if (scene[0].light_count > 1u) u_choice = sample_bits_1d_at(numbers, 0u);
    uvec2 u_direction = sample_bits_2d_at(numbers, 4u);
    return emit_photon(u_choice, sample_1d_at(numbers, 1u), sample_2d_at(numbers, 2u), u_direction, start);
}

FN uint light_vertex_dimension(IN(Walk) walk) {
    return EMISSION_DIMENSIONS + uint(walk.depth) * LIGHT_VERTEX_DIMENSIONS;
}

FN float light_path_u_lobe(IN(Vertex) v, IN(Sampler) numbers, uint dimension) {
    return bsdf_chooses_lobe(v.bsdf) ? sample_1d_at(numbers, dimension + LIGHT_LOBE) : 0.0f;
}

FN bool light_path_samples(IN(Vertex) v, IN(Sampler) numbers, uint dimension, OUT(BsdfSample) next) {
    float u_lobe = light_path_u_lobe(v, numbers, dimension);
    return bsdf_sample(v.bsdf, v.wo, u_lobe, sample_2d_at(numbers, dimension + LIGHT_DIRECTION), TRANSPORT_IMPORTANCE,
                       next);
}

struct LensConnection {
    CameraConnection camera;
    uint pixel;    // in the film's window
    float weight;  // of the pixel filter
};

// Chooses a point of the lens and a pixel for a vertex; false if no pixel of the window sees it.
FN bool lens_connect(IN(Surface) s, IN(Sampler) numbers, uint dimension, OUT(LensConnection) c) {
    vec2 u_lens = vec2(0.5f);
    c.pixel = 0u;
    c.weight = 0.0f;
    if (CALLED_FOR(EFFECT_DEPTH_OF_FIELD)) u_lens = sample_2d_at(numbers, dimension + LIGHT_LENS);
    if (!camera_connect(s.position, u_lens, c.camera) || !splat_reaches(c.camera.raster)) return false;
    ivec2 pixel = splat_pixel(c.camera.raster, sample_2d_at(numbers, dimension + LIGHT_PIXEL), c.weight);
    FilmWindow w = window[0];
    int x = pixel.x - int(w.x);
    int y = pixel.y - int(w.y);
    if (x < 0 || y < 0 || x >= int(w.width) || y >= int(w.height)) return false;
    c.pixel = uint(y) * w.width + uint(x);
    return true;
}

// A splat in the path log: `value` with the weight of log_weighs, which the pixel gets as `added`.
RARE_FN void log_lens_splat(LensConnection c, Spectrum value, vec3 added) {
    PathLogRecord r = log_record(LOG_SPLAT);
    r.s = r.depth + 2u;
    r.t = 1u;
    r.distance = c.camera.distance;
    r.direction = c.camera.wi;
    r.weight = log_now[0].weight;
    r.value = rgb_of(value) / r.weight;
    r.factor = log_quotient(rgb_of(value), added);
    log_write(r);
}

// Adds `value`, the share of one of `paths` light paths in the pixel's radiance, without the pixel filter. `brightness`: the number
// of paths over that of pixels.
FN void lens_splat(IN(LensConnection) c, Spectrum value, float paths, float brightness, float quantum,
                   IN(Sampler) numbers, uint dimension) {
    vec3 rgb = film_sensor(value * (brightness / paths)) * (c.weight / brightness);
    PATH_LOG(log_lens_splat(c, value, rgb));
    uint key = hash_combine(hash_combine(numbers.key, numbers.index), dimension);
    splat_add(c.pixel, rgb, quantum, key);
}

#endif
