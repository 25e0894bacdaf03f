// Path tracing with next-event estimation, multiple importance sampling (Veach 1997, chapters 9 and 10) and Russian
// roulette. One invocation adds a range of samples to one pixel.
// clang-format off
#define KERNEL_CPU_VARIANTS kAllEffects, kTexturedEffects, kGlassEffects, kSkyEffects, kGlassEffects | EFFECT_COAT, kDiffuseEffects | EFFECT_QUADRICS, kDiffuseEffects | EFFECT_QUADRICS | EFFECT_DIELECTRIC, kDiffuseEffects | EFFECT_TEXTURES | EFFECT_IMAGES
// clang-format on
#include "core/kernel/scene.h"

#include "core/kernel/direct_light.h"
#include "core/kernel/film.h"
#include "integrators/path/path.params.h"

BUFFER_RO(0, FilmWindow, window)
BUFFER_RO(1, PathParams, params)
BUFFER_RW(2, FilmPixel, film)

// After the camera's numbers each vertex has a fixed number of dimensions, so that a dimension means the same in every sample
// whatever the path met before.
CONST uint PATH_VERTEX_DIMENSIONS = 8u;

// Radiance that arrives at the camera along the ray. The first hit's features go to `pixel`.
FN vec3 path_radiance(vec3 ray_origin, vec3 ray_direction, IN(Sampler) numbers, INOUT(FilmPixel) pixel,
                      INOUT(uint) rays) {
    vec3 origin = ray_origin;
    vec3 direction = ray_direction;
    vec3 radiance = vec3(0.0f);
    vec3 throughput = vec3(1.0f);
    vec3 previous = ray_origin;  // the vertex before, whence lights were sampled
    float bsdf_density = 0.0f;   // pdf (solid angle) with which `direction` was sampled
    float eta_scale = 1.0f;      // undoes the scaling of radiance on refraction: roulette must not see it
    bool lights_were_sampled = false;
    int depth = 0;
    uint passed = 0u;
    uint medium = camera_medium();
    uint vertices = uint(params[0].maxdepth) + MAX_PASSED_SURFACES + 1u;  // more than a path has
    uint vertex = 0u;
    while (vertex < vertices) {
        vertex = vertices;  // every way out of the loop but its end leaves it so
        Surface s;
        if (!intersect_scene(origin, direction, s, rays)) {
            if (HAS(EFFECT_ENVIRONMENT)) {
                if (HAS(EFFECT_MEDIUM)) throughput *= medium_transmittance(medium, INFINITE_DISTANCE);
                vec3 emitted = environment_radiance(direction);
                if (!is_black(emitted)) {
                    float weight =
                        lights_were_sampled ? power_heuristic(bsdf_density, environment_pdf(direction)) : 1.0f;
                    radiance += throughput * emitted * weight;
                }
            }
            break;
        }
        if (HAS(EFFECT_MEDIUM)) throughput *= medium_transmittance(medium, s.distance);
        if (HAS(EFFECT_AREA_LIGHTS) && s.light != NONE) {
            vec3 emitted = light_emission(s, -direction);
            if (!is_black(emitted)) {
                float weight =
                    lights_were_sampled ? power_heuristic(bsdf_density, light_pdf(s, previous, direction)) : 1.0f;
                radiance += throughput * emitted * weight;
            }
        }
        if (HAS(EFFECT_INTERFACE) && is_interface(s)) {
            origin = origin_beyond(s.position, s.way, direction);
            medium = medium_behind(s, direction, medium);
            if (++passed > MAX_PASSED_SURFACES) {
                REPORT_UNFINISHED();
                break;
            }
            vertex = uint(depth) + passed;
            continue;
        }
        Frame frame;
        Bsdf bsdf = material_bsdf(s, -direction, frame);
        if (depth == 0) {
            vec3 albedo = bsdf_albedo(bsdf);
            pixel.albedo += vec4(albedo.x, albedo.y, albedo.z, 1.0f);
            pixel.normal += vec4(s.ns.x, s.ns.y, s.ns.z, 0.0f);
            pixel.squares.w += distance_of(s.position, ray_origin);
        }
        if (depth >= params[0].maxdepth) break;
        uint dimension = CAMERA_DIMENSIONS + uint(depth) * PATH_VERTEX_DIMENSIONS;
        // For the direction and for the place on a light: no term of the radiance depends on both.
        uvec4 u_vertex = sample_bits_2d_2d_at(numbers, dimension);
        depth += 1;

        vec3 wo = to_local(frame, -direction);
        lights_were_sampled = !bsdf_is_specular(bsdf);
        if (lights_were_sampled && scene[0].lights.x > 0u) {
            uint u_light = 0u;
            if (light_choice_needs_number()) u_light = sample_bits_1d_at(numbers, dimension + 4u);
            uvec2 u_light_point = uvec2(u_vertex.z, u_vertex.w);
            radiance += throughput * direct_light(s, frame, bsdf, wo, medium, u_light, u_light_point, true, rays);
        }

        BsdfSample next;
        float u_lobe = 0.0f;
        if (bsdf_chooses_lobe(bsdf)) u_lobe = sample_1d_at(numbers, dimension + 5u);
        vec2 u_direction = unit_floats(uvec2(u_vertex.x, u_vertex.y));
        if (!bsdf_sample(bsdf, wo, u_lobe, u_direction, TRANSPORT_RADIANCE, next)) break;
        throughput *= next.f * (abs(next.wi.z) / next.pdf);
        bsdf_density = next.pdf_is_proportional != 0u ? bsdf_pdf(bsdf, wo, next.wi, TRANSPORT_RADIANCE) : next.pdf;
        if ((next.lobe & LOBE_SPECULAR) != 0u) lights_were_sampled = false;
        if ((next.lobe & LOBE_TRANSMISSION) != 0u) eta_scale *= sqr(next.eta);
        direction = to_world(frame, next.wi);
        direction = unit(direction);
        previous = s.position;
        origin = origin_beyond(s.position, s.way, direction);
        medium = medium_behind(s, direction, medium);

        float survival = max_component(throughput) * eta_scale;
        if (!(survival > 0.0f)) break;
        if (depth > params[0].rrdepth && survival < 1.0f) {
            survival = exact_chance(survival);
            if (sample_1d_at(numbers, dimension + 6u) >= survival) break;
            throughput = throughput / survival;
        }
        vertex = uint(depth) + passed;
    }
    if (vertex != vertices) REPORT_UNFINISHED();  // the driver ended the loop
    return radiance;
}

KERNEL(path) {
    FilmWindow w = window[0];
    uvec2 local = film_pixel_of(index, w.pixels);
    uint place = local.y * w.pixels.z + local.x;
    FilmPixel pixel = film[place];
    uint rays = 0u;
    uint i = 0u;
    for (; i < w.samples.y; ++i) {
        CameraSample camera = camera_sample(w, local, i);
        vec3 radiance = path_radiance(camera.ray.origin, camera.ray.direction, camera.numbers, pixel, rays);
        film_add(pixel, film_sensor(radiance), camera.weight, camera.pass);
    }
    if (i != w.samples.y) REPORT_UNFINISHED();
    pixel.counts.y += rays;
    film[place] = pixel;
}
