// Follows a path from the eye over (nearly) specular surfaces to its hit point, the first other surface.
#ifndef LAMPYRIS_EYE_PATH
#define LAMPYRIS_EYE_PATH

#include "core/kernel/film.h"
#include "core/kernel/visible_point.h"
#include "integrators/photon_paths/hit_record.h"

BUFFER_RO(1, PhotonPathParams, params)

CONST uint EYE_LOBES_ALL = 0u;
CONST uint EYE_LOBES_SPECULAR = 1u;  // at a surface where the other lobes are gathered
CONST uint EYE_LOBES_OTHER = 2u;     // at a hit point, whose specular lobes, if any, the eye path follows
// The coat's reflection, without a random choice, at a surface where the other lobes are gathered.
CONST uint EYE_LOBES_COAT = 3u;

// What a path does at the first smooth coat over a rough base.
CONST uint EYE_BRANCH_CHANCE = 0u;   // one of the two, by random choice
CONST uint EYE_BRANCH_GATHERS = 1u;  // gathers there
CONST uint EYE_BRANCH_FOLLOWS = 2u;  // follows the coat's reflection, and counts only the light from there

struct EyePath {
    Walk walk;
    vec3 start;
    Spectrum radiance;  // before the hit point, and direct light there
    float travelled;    // length so far, in scene units
};

FN EyePath eye_path_begin(IN(Ray) ray, uint medium) {
    EyePath path;
    path.walk = walk_begin(ray, medium, TRANSPORT_RADIANCE, params[0].maxdepth);
    path.start = ray.origin;
    path.radiance = Spectrum(0.0f);
    path.travelled = 0.0f;
    return path;
}

// The random numbers of a vertex; as in path, a dimension means the same in every sample.
CONST uint EYE_LIGHT_CHOICE = 0u;
CONST uint EYE_LIGHT_POINT = 1u;
CONST uint EYE_LOBE = 3u;
CONST uint EYE_DIRECTION = 4u;
CONST uint EYE_ROULETTE = 6u;
CONST uint EYE_BRANCH = 7u;
CONST uint EYE_VERTEX_DIMENSIONS = 8u;
FN uint eye_vertex_dimension(IN(Walk) walk) { return CAMERA_DIMENSIONS + uint(walk.depth) * EYE_VERTEX_DIMENSIONS; }

// Width of a pixel on a surface seen face on, which a ray through it hits after `distance` (scene units).
FN float pixel_footprint(float distance) {
    CameraRecord camera = scene[0].camera;
    float step = max(abs(camera.screen.z), abs(camera.screen.w));
    return camera.kind == CAMERA_ORTHOGRAPHIC ? step : step * distance;
}

// Continues from the vertex at s by one of its lobes; false if the path ends.
FN bool eye_path_scatters(IN(Surface) s, IN(Vertex) v, IN(Sampler) numbers, uint lobes, INOUT(Walk) walk) {
    uint dimension = eye_vertex_dimension(walk);
    BsdfSample next;
    float u_lobe = 0.0f;
    // The coat's reflection is the lobe of the lowest random numbers.
    if (bsdf_chooses_lobe(v.bsdf) && lobes != EYE_LOBES_COAT) u_lobe = sample_1d_at(numbers, dimension + EYE_LOBE);
    vec2 u_direction = sample_2d_at(numbers, dimension + EYE_DIRECTION);
    if (!bsdf_sample(v.bsdf, v.wo, u_lobe, u_direction, TRANSPORT_RADIANCE, next)) return false;
    bool specular = (next.lobe & LOBE_SPECULAR) != 0u;
    if ((lobes == EYE_LOBES_SPECULAR || lobes == EYE_LOBES_COAT) && !specular) return false;
    if (lobes == EYE_LOBES_OTHER && specular) return false;
    if (lobes == EYE_LOBES_COAT) next.pdf = 1.0f;  // there was no random choice
    return walk_leave(walk, s, v, next, params[0].rrdepth, numbers, dimension + EYE_ROULETTE);
}

// Records a hit point at s, which the path's last ray hit.
FN void record_hit_point(IN(EyePath) path, IN(Surface) s, INOUT(HitPointRecord) hit, OUT(vec4) place) {
    float first_radius = params[0].radius;
    if (!(first_radius > 0.0f)) first_radius = params[0].footprint * pixel_footprint(path.travelled);
    Ray ray = path.walk.ray;
    hit.origin =
        uvec4(floatBitsToUint(ray.origin.x), floatBitsToUint(ray.origin.y), floatBitsToUint(ray.origin.z), s.instance);
    hit.direction = uvec4(floatBitsToUint(ray.direction.x), floatBitsToUint(ray.direction.y),
                          floatBitsToUint(ray.direction.z), s.geometry);
    // For smaller disks, the rounding error of the hit point would matter.
    float least = max(4.0f * length_of(s.error), scene[0].bounds.w * params[0].minradius);
    hit.more = uvec4(s.primitive, floatBitsToUint(least), path.walk.medium, uint(path.walk.depth) + 1u);
    hit.radiance.w = first_radius;
    place = vec4(s.position.x, s.position.y, s.position.z, first_radius);
}

// Follows the path. If it ends at a hit point, `place` is its position and the first pass's radius; else the radius is
// negative. `from_camera`: emission on the way counts in full, a light is sampled at the hit point (direct=nee), and
// `first` gets the features of the first surface. Paths from another hit point (final gathering) omit these, because
// they are counted already. `branch_asked`: EYE_BRANCH_*.
FN void follow_eye_path(IN(Sampler) numbers, bool from_camera, uint branch_asked, INOUT(EyePath) path,
                        INOUT(FirstHit) first, INOUT(HitPointRecord) hit, OUT(vec4) place) {
    uint branch = branch_asked;
    bool first_is_asked = from_camera && branch != EYE_BRANCH_FOLLOWS;
    place = vec4(0.0f, 0.0f, 0.0f, -1.0f);
    Surface s;
    while (walk_next(path.walk, s)) {
        // No previous vertex sampled lights, so emission counts in full.
        if (HAS(EFFECT_AREA_LIGHTS) && from_camera && s.light != NONE) {
            Spectrum emitted = path.walk.throughput * light_emission(s, -path.walk.ray.direction);
            path.radiance += emitted;
            PATH_LOG(log_emission(s, emitted, 1.0f));
        }
        path.travelled += s.distance;
        if (walk_crosses(path.walk, s)) continue;
        Vertex v = walk_vertex(path.walk, s);
        if (first_is_asked) {
            first_is_asked = false;
            first = first_hit(s, bsdf_albedo(v.bsdf), distance_of(s.position, path.start));
        }
        if (path.walk.depth >= path.walk.maxdepth) break;
        uint dimension = eye_vertex_dimension(path.walk);
        uint action = bsdf_visible_action(v.bsdf, params[0].glossy);
        uint lobes = EYE_LOBES_ALL;
        if (action == VISIBLE_SPLIT && branch == EYE_BRANCH_CHANCE) {
            action = sample_1d_at(numbers, dimension + EYE_BRANCH) < 0.5f ? VISIBLE_GATHER : VISIBLE_FOLLOW;
            path.walk.throughput = 2.0f * path.walk.throughput;
            PATH_LOG(log_carries(path.walk.throughput));
            lobes = EYE_LOBES_SPECULAR;  // the other lobes are gathered, with probability 1/2
        } else if (action == VISIBLE_SPLIT) {
            action = branch == EYE_BRANCH_GATHERS ? VISIBLE_GATHER : VISIBLE_FOLLOW;
            if (action == VISIBLE_FOLLOW) {  // counted by the other branch
                path.radiance = Spectrum(0.0f);
                PATH_LOG(log_discards());
            }
            lobes = EYE_LOBES_COAT;
            branch = EYE_BRANCH_CHANCE;
        }
        if (action == VISIBLE_GATHER && branch != EYE_BRANCH_FOLLOWS) {
            if (from_camera && params[0].direct == DIRECT_NEE && scene[0].light_count > 0u) {
                uint u_light = 0u;
                if (light_choice_needs_number()) u_light = sample_bits_1d_at(numbers, dimension + EYE_LIGHT_CHOICE);
                uvec2 u_point = sample_bits_2d_at(numbers, dimension + EYE_LIGHT_POINT);
                path.radiance += path.walk.throughput * direct_light(s, v, path.walk.medium, u_light, u_point, false);
            }
            record_hit_point(path, s, hit, place);
        }
        if (action == VISIBLE_GATHER) break;
        if (!eye_path_scatters(s, v, numbers, lobes, path.walk)) break;
    }
    if (HAS(EFFECT_ENVIRONMENT) && from_camera && path.walk.escaped) {
        Spectrum emitted = path.walk.throughput * environment_radiance(path.walk.ray.direction);
        path.radiance += emitted;
        PATH_LOG(log_environment(path.walk.ray.direction, emitted, 1.0f));
    }
    if (branch == EYE_BRANCH_FOLLOWS) {  // no coat: the other branch counts all
        path.radiance = Spectrum(0.0f);
        PATH_LOG(log_discards());
    }
    hit.radiance = slot_of(path.radiance, hit.radiance.w);
}

#endif
