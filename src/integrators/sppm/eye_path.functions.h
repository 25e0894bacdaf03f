// Follows a path from the eye over (nearly) specular surfaces to its hit point, the first surface that reflects diffusely.
#ifndef LAMPYRIS_SPPM_EYE_PATH
#define LAMPYRIS_SPPM_EYE_PATH

#include "core/kernel/direct_light.h"
#include "core/kernel/film.h"
#include "core/kernel/visible_point.h"
#include "integrators/sppm/sppm.layout.h"
#include "integrators/sppm/sppm.params.h"

BUFFER_RO(1, SppmParams, params)

// As path's: a dimension means the same in every sample.
CONST uint SPPM_VERTEX_DIMENSIONS = 8u;

CONST uint EYE_LOBES_ALL = 0u;
CONST uint EYE_LOBES_SPECULAR = 1u;  // of a surface the rest of which is gathered
CONST uint EYE_LOBES_OTHER = 2u;  // of a hit point, whose specular lobes, if any, are followed as part of the eye path
CONST uint EYE_LOBES_COAT =
    3u;  // the coat's reflection of a surface the rest of which is gathered, without a choice by chance

// What a path does at the first smooth coat over something rough.
CONST uint EYE_BRANCH_CHANCE = 0u;   // one of the two
CONST uint EYE_BRANCH_GATHERS = 1u;  // is gathered there
CONST uint EYE_BRANCH_FOLLOWS = 2u;  // follows the coat's reflection, and has nothing but what that brings

struct EyePath {
    vec3 start;
    vec3 origin;
    vec3 direction;
    vec3 throughput;
    vec3 radiance;    // found on the way
    float eta_scale;  // undoes the scaling of radiance on refraction: roulette must not see it
    float way;        // length so far
    int depth;        // scattering vertices so far
    uint medium;
};

FN EyePath eye_path_begin(vec3 origin, vec3 direction, uint medium) {
    EyePath path;
    path.start = origin;
    path.origin = origin;
    path.direction = direction;
    path.throughput = vec3(1.0f);
    path.radiance = vec3(0.0f);
    path.eta_scale = 1.0f;
    path.way = 0.0f;
    path.depth = 0;
    path.medium = medium;
    return path;
}

FN uint eye_path_dimension(IN(EyePath) path) {
    return CAMERA_DIMENSIONS + uint(path.depth - 1) * SPPM_VERTEX_DIMENSIONS;
}

// Width of a pixel on a surface that a ray through it meets after `distance` (scene units), seen face on.
FN float pixel_footprint(float distance) {
    CameraRecord camera = scene[0].camera;
    float step = max(abs(camera.screen.z), abs(camera.screen.w));
    return camera.data.x == CAMERA_ORTHOGRAPHIC ? step : step * distance;
}

// Goes on from s, the path's vertex number `depth`, by one of its lobes; false where the path ends.
FN bool eye_path_scatters(IN(Surface) s, IN(Frame) frame, IN(Bsdf) bsdf, vec3 wo, IN(Sampler) numbers, uint lobes,
                          INOUT(EyePath) path) {
    uint dimension = eye_path_dimension(path);
    BsdfSample next;
    float u_lobe = 0.0f;
    // The coat's reflection is the lobe of the lowest numbers.
    if (bsdf_chooses_lobe(bsdf) && lobes != EYE_LOBES_COAT) u_lobe = sample_1d_at(numbers, dimension + 3u);
    vec2 u_direction = sample_2d_at(numbers, dimension + 4u);
    if (!bsdf_sample(bsdf, wo, u_lobe, u_direction, TRANSPORT_RADIANCE, next)) return false;
    bool specular = (next.lobe & LOBE_SPECULAR) != 0u;
    if ((lobes == EYE_LOBES_SPECULAR || lobes == EYE_LOBES_COAT) && !specular) return false;
    if (lobes == EYE_LOBES_OTHER && specular) return false;
    float density = lobes == EYE_LOBES_COAT ? 1.0f : next.pdf;
    path.throughput *= next.f * (abs(next.wi.z) / density);
    if ((next.lobe & LOBE_TRANSMISSION) != 0u) path.eta_scale *= sqr(next.eta);
    path.direction = unit(to_world(frame, next.wi));
    path.origin = offset_origin(s.position, s.error, s.ng, path.direction);
    path.medium = medium_behind(s, path.direction, path.medium);

    float survival = max_component(path.throughput) * path.eta_scale;
    if (!(survival > 0.0f)) return false;
    if (path.depth > params[0].rrdepth && survival < 1.0f) {
        survival = exact_chance(survival);
        if (sample_1d_at(numbers, dimension + 6u) >= survival) return false;
        path.throughput = path.throughput / survival;
    }
    return true;
}

// Follows the path. Where it ends at a hit point, `place` is that and the radius of the first pass; else the radius is negative.
// `from_camera`: what emits on the way counts in full, a light is sampled at the hit point (direct=nee), and the first surface's
// features go to `pixel`. A path from another hit point (final gathering) does without: there these are counted already.
// `branch_asked`: EYE_BRANCH_*.
FN void follow_eye_path(IN(Sampler) numbers, bool from_camera, uint branch_asked, INOUT(EyePath) path,
                        INOUT(FilmPixel) pixel, INOUT(SppmHit) hit, OUT(vec4) place, INOUT(uint) rays) {
    uint branch = branch_asked;
    bool first = from_camera && branch != EYE_BRANCH_FOLLOWS;
    uint passed = 0u;
    uint vertices = uint(params[0].maxdepth) + MAX_PASSED_SURFACES + 1u;  // more than a path has
    uint vertex = 0u;
    place = vec4(0.0f, 0.0f, 0.0f, -1.0f);
    while (vertex < vertices) {
        vertex = vertices;
        Surface s;
        Hit met;
        if (!intersect_scene_from(path.origin, path.direction, s, met, rays)) {
            if (HAS(EFFECT_MEDIUM)) path.throughput *= medium_transmittance(path.medium, INFINITE_DISTANCE);
            if (HAS(EFFECT_ENVIRONMENT) && from_camera)
                path.radiance += path.throughput * environment_radiance(path.direction);
            break;
        }
        if (HAS(EFFECT_MEDIUM)) path.throughput *= medium_transmittance(path.medium, s.distance);
        // No vertex before this one sampled lights: what is emitted counts in full.
        if (HAS(EFFECT_AREA_LIGHTS) && from_camera && s.light != NONE)
            path.radiance += path.throughput * light_emission(s, -path.direction);
        if (HAS(EFFECT_INTERFACE) && is_interface(s)) {
            path.way += s.distance;
            path.origin = offset_origin(s.position, s.error, s.ng, path.direction);
            path.medium = medium_behind(s, path.direction, path.medium);
            if (++passed > MAX_PASSED_SURFACES) {
                REPORT_UNFINISHED();
                break;
            }
            vertex = uint(path.depth) + passed;
            continue;
        }
        Surface shaded = s;
        Frame frame;
        Bsdf bsdf = material_bsdf(shaded, -path.direction, frame);
        if (first) {
            first = false;
            vec3 albedo = bsdf_albedo(bsdf);
            pixel.albedo += vec4(albedo.x, albedo.y, albedo.z, 1.0f);
            pixel.normal += vec4(shaded.ns.x, shaded.ns.y, shaded.ns.z, 0.0f);
            pixel.squares.w += distance_of(s.position, path.start);
        }
        path.way += s.distance;
        if (path.depth >= params[0].maxdepth) break;
        path.depth += 1;
        uint dimension = eye_path_dimension(path);

        vec3 wo = to_local(frame, -path.direction);
        uint action = visible_action(bsdf, params[0].glossy);
        uint lobes = EYE_LOBES_ALL;
        if (action == VISIBLE_SPLIT && branch == EYE_BRANCH_CHANCE) {
            action = sample_1d_at(numbers, dimension + 7u) < 0.5f ? VISIBLE_GATHER : VISIBLE_FOLLOW;
            path.throughput = 2.0f * path.throughput;
            lobes = EYE_LOBES_SPECULAR;  // the rest is gathered, half of the time
        } else if (action == VISIBLE_SPLIT) {
            action = branch == EYE_BRANCH_GATHERS ? VISIBLE_GATHER : VISIBLE_FOLLOW;
            if (action == VISIBLE_FOLLOW) path.radiance = vec3(0.0f);  // the other branch has it
            lobes = EYE_LOBES_COAT;
            branch = EYE_BRANCH_CHANCE;
        }
        if (action == VISIBLE_GATHER && branch != EYE_BRANCH_FOLLOWS) {
            if (from_camera && params[0].direct == SPPM_DIRECT_NEE && scene[0].lights.x > 0u) {
                uint u_light = 0u;
                if (light_choice_needs_number()) u_light = sample_bits_1d_at(numbers, dimension);
                uvec2 u_point = sample_bits_2d_at(numbers, dimension + 1u);
                path.radiance +=
                    path.throughput * direct_light(shaded, frame, bsdf, wo, path.medium, u_light, u_point, false, rays);
            }
            float first_radius = params[0].radius;
            if (!(first_radius > 0.0f)) first_radius = params[0].footprint * pixel_footprint(path.way);
            hit.origin = uvec4(floatBitsToUint(path.origin.x), floatBitsToUint(path.origin.y),
                               floatBitsToUint(path.origin.z), met.instance);
            hit.direction = uvec4(floatBitsToUint(path.direction.x), floatBitsToUint(path.direction.y),
                                  floatBitsToUint(path.direction.z), met.geometry);
            // Below that the disk is as good as the place is known.
            float least = max(4.0f * length_of(s.error), scene[0].bounds.w * params[0].minradius);
            hit.more = uvec4(met.primitive, floatBitsToUint(least), path.medium, uint(path.depth));
            hit.radiance.w = first_radius;
            place = vec4(s.position.x, s.position.y, s.position.z, first_radius);
            break;
        }
        if (action == VISIBLE_GATHER) break;
        if (eye_path_scatters(s, frame, bsdf, wo, numbers, lobes, path)) vertex = uint(path.depth) + passed;
    }
    if (vertex != vertices) REPORT_UNFINISHED();                   // the driver ended the loop
    if (branch == EYE_BRANCH_FOLLOWS) path.radiance = vec3(0.0f);  // it met no coat
    hit.radiance.x = path.radiance.x;
    hit.radiance.y = path.radiance.y;
    hit.radiance.z = path.radiance.z;
}

#endif
