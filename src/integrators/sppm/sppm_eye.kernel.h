// Eye pass: follows camera rays over (nearly) specular surfaces to the first one that reflects diffusely, and records it.
// clang-format off
#define KERNEL_CPU_VARIANTS kAllEffects, kTexturedEffects, kGlassEffects
// clang-format on
#include "core/kernel/scene.h"

#include "core/kernel/direct_light.h"
#include "core/kernel/film.h"
#include "core/kernel/visible_point.h"
#include "integrators/sppm/sppm.layout.h"
#include "integrators/sppm/sppm.params.h"

BUFFER_RO(0, FilmWindow, window)
BUFFER_RO(1, SppmParams, params)
BUFFER_RW(2, FilmPixel, film)
BUFFER_RW(3, SppmHit, hits)
BUFFER_RW(4, vec4, queries)

// As path's: a dimension means the same in every sample.
CONST uint SPPM_VERTEX_DIMENSIONS = 8u;

// Width of a pixel on a surface that a ray through it meets after `distance` (scene units), seen face on.
FN float pixel_footprint(float distance) {
    CameraRecord camera = scene[0].camera;
    float step = max(abs(camera.screen.z), abs(camera.screen.w));
    return camera.data.x == CAMERA_ORTHOGRAPHIC ? step : step * distance;
}

// Follows the ray. Where it ends at a hit point, `place` is that and the radius of the first pass; else the radius is negative.
FN void sppm_eye_path(IN(CameraSample) camera, INOUT(FilmPixel) pixel, INOUT(SppmHit) hit, OUT(vec4) place,
                      INOUT(uint) rays) {
    vec3 origin = camera.ray.origin;
    vec3 direction = camera.ray.direction;
    vec3 radiance = vec3(0.0f);
    vec3 throughput = vec3(1.0f);
    float eta_scale = 1.0f;
    float way = 0.0f;  // length of the path so far
    bool first = true;
    int depth = 0;
    uint passed = 0u;
    uint medium = camera_medium();
    uint vertices = uint(params[0].maxdepth) + MAX_PASSED_SURFACES + 1u;  // more than a path has
    uint vertex = 0u;
    place = vec4(0.0f, 0.0f, 0.0f, -1.0f);
    while (vertex < vertices) {
        vertex = vertices;
        Surface s;
        Hit met;
        if (!intersect_scene_from(origin, direction, s, met, rays)) {
            if (HAS(EFFECT_MEDIUM)) throughput *= medium_transmittance(medium, INFINITE_DISTANCE);
            if (HAS(EFFECT_ENVIRONMENT)) radiance += throughput * environment_radiance(direction);
            break;
        }
        if (HAS(EFFECT_MEDIUM)) throughput *= medium_transmittance(medium, s.distance);
        // No vertex before this one sampled lights: what is emitted counts in full.
        if (HAS(EFFECT_AREA_LIGHTS) && s.light != NONE) radiance += throughput * light_emission(s, -direction);
        if (HAS(EFFECT_INTERFACE) && is_interface(s)) {
            way += s.distance;
            origin = offset_origin(s.position, s.error, s.ng, direction);
            medium = medium_behind(s, direction, medium);
            if (++passed > MAX_PASSED_SURFACES) {
                REPORT_UNFINISHED();
                break;
            }
            vertex = uint(depth) + passed;
            continue;
        }
        Surface shaded = s;
        Frame frame;
        Bsdf bsdf = material_bsdf(shaded, -direction, frame);
        if (first) {
            first = false;
            vec3 albedo = bsdf_albedo(bsdf);
            pixel.albedo += vec4(albedo.x, albedo.y, albedo.z, 1.0f);
            pixel.normal += vec4(shaded.ns.x, shaded.ns.y, shaded.ns.z, 0.0f);
            pixel.squares.w += distance_of(s.position, camera.ray.origin);
        }
        way += s.distance;
        if (depth >= params[0].maxdepth) break;
        uint dimension = CAMERA_DIMENSIONS + uint(depth) * SPPM_VERTEX_DIMENSIONS;
        depth += 1;

        vec3 wo = to_local(frame, -direction);
        uint action = visible_action(bsdf, params[0].glossy);
        bool split = action == VISIBLE_SPLIT;
        if (split) {
            action = sample_1d_at(camera.numbers, dimension + 7u) < 0.5f ? VISIBLE_GATHER : VISIBLE_FOLLOW;
            throughput = 2.0f * throughput;
        }
        if (action == VISIBLE_GATHER) {
            if (params[0].direct == SPPM_DIRECT_NEE && scene[0].lights.x > 0u) {
                float u_light = 0.0f;
                if (scene[0].lights.x > 1u) u_light = sample_1d_at(camera.numbers, dimension);
                vec2 u_point = sample_2d_at(camera.numbers, dimension + 1u);
                radiance += throughput * direct_light(shaded, frame, bsdf, wo, medium, u_light, u_point, false, rays);
            }
            float first_radius = params[0].radius;
            if (!(first_radius > 0.0f)) first_radius = params[0].footprint * pixel_footprint(way);
            hit.origin =
                uvec4(floatBitsToUint(origin.x), floatBitsToUint(origin.y), floatBitsToUint(origin.z), met.instance);
            hit.direction = uvec4(floatBitsToUint(direction.x), floatBitsToUint(direction.y),
                                  floatBitsToUint(direction.z), met.geometry);
            // Below that the disk is as good as the place is known.
            float least = max(4.0f * length_of(s.error), scene[0].bounds.w * params[0].minradius);
            hit.more = uvec4(met.primitive, floatBitsToUint(least), 0u, 0u);
            hit.radiance.w = first_radius;
            place = vec4(s.position.x, s.position.y, s.position.z, first_radius);
            break;
        }

        BsdfSample next;
        float u_lobe = 0.0f;
        if (bsdf_chooses_lobe(bsdf)) u_lobe = sample_1d_at(camera.numbers, dimension + 3u);
        vec2 u_direction = sample_2d_at(camera.numbers, dimension + 4u);
        if (!bsdf_sample(bsdf, wo, u_lobe, u_direction, TRANSPORT_RADIANCE, next)) break;
        // The rest of a split surface is gathered, half of the time.
        if (split && (next.lobe & LOBE_SPECULAR) == 0u) break;
        throughput *= next.f * (abs(next.wi.z) / next.pdf);
        if ((next.lobe & LOBE_TRANSMISSION) != 0u) eta_scale *= sqr(next.eta);
        direction = unit(to_world(frame, next.wi));
        origin = offset_origin(s.position, s.error, s.ng, direction);
        medium = medium_behind(s, direction, medium);

        float survival = max_component(throughput) * eta_scale;
        if (!(survival > 0.0f)) break;
        if (depth > params[0].rrdepth && survival < 1.0f) {
            if (sample_1d_at(camera.numbers, dimension + 6u) >= survival) break;
            throughput = throughput / survival;
        }
        vertex = uint(depth) + passed;
    }
    if (vertex != vertices) REPORT_UNFINISHED();  // the driver ended the loop
    hit.radiance.x = radiance.x;
    hit.radiance.y = radiance.y;
    hit.radiance.z = radiance.z;
    hit.throughput = vec4(throughput.x, throughput.y, throughput.z, camera.weight);
}

KERNEL(sppm_eye) {
    FilmWindow w = window[0];
    uvec2 local = film_pixel_of(index, w.pixels);
    uint place = local.y * w.pixels.z + local.x;
    FilmPixel pixel = film[place];
    uint pixels = w.pixels.z * w.pixels.w;
    uint i = 0u;
    for (; i < w.samples.y; ++i) {
        uint at = i * pixels + place;
        CameraSample camera = camera_sample(w, local, i);
        SppmHit hit;
        hit.origin = uvec4(0u);
        hit.direction = uvec4(0u);
        hit.more = uvec4(0u);
        hit.radiance = vec4(0.0f);
        vec4 query;
        uint rays = 0u;
        sppm_eye_path(camera, pixel, hit, query, rays);
        pixel.counts.y += rays;
        hits[at] = hit;
        queries[at] = query;
    }
    if (i != w.samples.y) REPORT_UNFINISHED();
    film[place] = pixel;
}
