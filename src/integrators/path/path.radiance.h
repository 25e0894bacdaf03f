// Path tracing with next-event estimation, multiple importance sampling (Veach 1997, chapters 9 and 10) and Russian
// roulette.
#include "core/kernel/radiance.h"

#include "integrators/path/path_params.h"

BUFFER_RO(1, PathParams, params)

// Each vertex has a fixed number of dimensions, so that a dimension means the same in every sample, whatever the path
// hit before. Direction and light share one 2D point, shifted differently: no term of the radiance depends on both.
CONST uint PATH_DIRECTION_AND_LIGHT = 0u;
CONST uint PATH_LIGHT_CHOICE = 4u;
CONST uint PATH_LOBE = 5u;
CONST uint PATH_ROULETTE = 6u;
CONST uint PATH_VERTEX_DIMENSIONS = 8u;

FN Spectrum radiance_along(IN(Ray) ray, INOUT(Sampler) numbers, INOUT(FirstHit) first) {
    Walk walk = walk_begin(ray, camera_medium(), TRANSPORT_RADIANCE, params[0].maxdepth);
    Spectrum radiance = Spectrum(0.0f);
    vec3 previous = ray.origin;        // the previous vertex, where lights were sampled
    float bsdf_density = 0.0f;         // pdf (solid angle) with which the ray's direction was sampled
    bool lights_were_sampled = false;  // if so, emission that the ray hits is weighted against it
    Surface s;
    while (walk_next(walk, s)) {
        vec3 direction = walk.ray.direction;
        Spectrum emitted = light_emission(s, -direction);
        if (!is_black(emitted)) {
            float weight =
                lights_were_sampled ? power_heuristic(bsdf_density, light_pdf(s, previous, direction)) : 1.0f;
            radiance += walk.throughput * emitted * weight;
            PATH_LOG(log_emission(s, walk.throughput * emitted, weight));
        }
        if (walk_crosses(walk, s)) continue;
        Vertex v = walk_vertex(walk, s);
        if (walk.depth == 0) first = first_hit(s, bsdf_albedo(v.bsdf), distance_of(s.position, ray.origin));
        if (walk.depth >= walk.maxdepth) break;
        uint dimension = CAMERA_DIMENSIONS + uint(walk.depth) * PATH_VERTEX_DIMENSIONS;
        uvec4 u = sample_bits_joined_2d_2d_at(numbers, dimension + PATH_DIRECTION_AND_LIGHT,
                                              CAMERA_GROUPS + uint(walk.depth));

        lights_were_sampled = !bsdf_is_specular(v.bsdf);
        if (lights_were_sampled && scene[0].light_count > 0u) {
            uint u_light = 0u;
            if (light_choice_needs_number()) u_light = sample_bits_1d_at(numbers, dimension + PATH_LIGHT_CHOICE);
            radiance += walk.throughput * direct_light(s, v, walk.medium, u_light, uvec2(u.z, u.w), true);
        }

        BsdfSample next;
        float u_lobe = 0.0f;
        if (bsdf_chooses_lobe(v.bsdf)) u_lobe = sample_1d_at(numbers, dimension + PATH_LOBE);
        vec2 u_direction = unit_floats(uvec2(u.x, u.y));
        if (!bsdf_sample_density(v.bsdf, v.wo, u_lobe, u_direction, TRANSPORT_RADIANCE, next, bsdf_density)) break;
        if ((next.lobe & LOBE_SPECULAR) != 0u) lights_were_sampled = false;
        previous = s.position;
        if (!walk_leave(walk, s, v, next, params[0].rrdepth, numbers, dimension + PATH_ROULETTE)) break;
    }
    if (HAS(EFFECT_ENVIRONMENT) && walk.escaped) {
        Spectrum emitted = environment_radiance(walk.ray.direction);
        if (!is_black(emitted)) {
            float weight =
                lights_were_sampled ? power_heuristic(bsdf_density, environment_pdf(walk.ray.direction, true)) : 1.0f;
            radiance += walk.throughput * emitted * weight;
            PATH_LOG(log_environment(walk.ray.direction, walk.throughput * emitted, weight));
        }
    }
    return radiance;
}
