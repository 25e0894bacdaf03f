// A path of given length from primary numbers, by one of its strategies (multiplexed: Hachisuka, Kaplanyan and Dachsbacher 2014).
#ifndef LAMPYRIS_MLT_PATH
#define LAMPYRIS_MLT_PATH

#include "core/kernel/camera_connect.h"
#include "integrators/bidirectional/connect.h"
#include "integrators/mlt/mlt_numbers.h"

// What a path contributes to the picture, over the density of its numbers.
struct MltSample {
    vec3 color;  // radiance times the number of pixels: linear Rec. 709; negative under the filter's negative lobes
    float luminance;  // its size; 0: no path
    vec2 raster;
    uint one_pixel;  // 1: it belongs to the pixel at `raster`; 0: to all that the filter there reaches
};

CONST int MLT_NO_ROULETTE = 1000000;

FN float mlt_pixels() {
    CameraRecord camera = scene[0].camera;
    return float(camera.resolution_x) * float(camera.resolution_y);
}

// A pixel, uniform over the picture, and a film point of its filter, as camera_sample chooses one.
FN vec2 mlt_film_point(OUT(vec2) pixel, OUT(float) weight) {
    CameraRecord camera = scene[0].camera;
    uvec2 bits = primary_bits_2d(MLT_RASTER);
    pixel =
        vec2(float(mul_high(bits.x, camera.resolution_x)) + 0.5f, float(mul_high(bits.y, camera.resolution_y)) + 0.5f);
    vec2 rest = unit_floats(uvec2(bits.x * camera.resolution_x, bits.y * camera.resolution_y));
    return pixel + pixel_filter_sample(rest, weight);
}
FN vec2 mlt_lens() { return CALLED_FOR(EFFECT_DEPTH_OF_FIELD) ? primary_2d(MLT_LENS) : vec2(0.5f); }

// Follows a path to its scattering vertex number `vertices`; true if there is one. `vertex_numbers`: where those of the first vertex
// are, and `stride` of the next. `lights`: counts emission that the ray from the last but one vertex finds, in place of the
// last.
FN bool follow_subpath(INOUT(Subpath) path, IN(Emission) start, int vertices, uint vertex_numbers, int stride,
                       bool lights, OUT(Surface) s, OUT(Vertex) v, INOUT(Spectrum) radiance) {
    Sampler unused = sampler_begin(0u, 0u, 0u, SAMPLER_INDEPENDENT);
    bool from_light = path.walk.transport == TRANSPORT_IMPORTANCE;
    uint at = vertex_numbers;
    while (walk_next(path.walk, s)) {
        bool last = path.walk.depth + 1 == vertices;
        if (HAS(EFFECT_AREA_LIGHTS) && last && lights && s.light != NONE) {
            Spectrum emitted = light_emission(s, -path.walk.ray.direction);
            if (!is_black(emitted)) {
                float weight = weight_of_hit_light(path, s);
                radiance += path.walk.throughput * emitted * weight;
                PATH_LOG(log_emission(s, path.walk.throughput * emitted, weight));
            }
        }
        if (walk_crosses(path.walk, s)) continue;
        if (last && lights) return false;
        if (path.walk.depth == 0) {
            if (from_light)
                light_path_meets_first(path, start, s);
            else
                camera_path_meets_first(path, s);
        }
        subpath_arrives(path, s);
        v = walk_vertex(path.walk, s);
        if (last) return true;
        BsdfSample next;
        float density;
        if (!bsdf_sample_density(v.bsdf, v.wo, primary(at), primary_2d(at + 1u), path.walk.transport, next, density))
            return false;
        at = uint(int(at) + stride);
        if (!subpath_leaves(path, s, v, next, density, MLT_NO_ROULETTE, unused, 0u)) return false;
    }
    if (HAS(EFFECT_ENVIRONMENT) && lights && path.walk.escaped && path.walk.depth + 1 == vertices) {
        Spectrum emitted = environment_radiance(path.walk.ray.direction);
        if (!is_black(emitted)) {
            float weight = weight_of_environment(path);
            radiance += path.walk.throughput * emitted * weight;
            PATH_LOG(log_environment(path.walk.ray.direction, path.walk.throughput * emitted, weight));
        }
    }
    return false;
}

// Vertices from the light, of a path with that many scattering ones.
FN int mlt_vertices_from_light(int depth) {
    int strategies = depth + 2;
    return min(int(primary(MLT_STRATEGY) * float(strategies)), strategies - 1);
}

FN MltSample mlt_sample(int depth) {
    MltSample sample_;
    sample_.color = vec3(0.0f);
    sample_.luminance = 0.0f;
    sample_.raster = vec2(0.0f);
    sample_.one_pixel = 1u;
    float weight = 1.0f;
    int strategies = depth + 2;
    int from_light = mlt_vertices_from_light(depth);
    int from_camera = depth + 2 - from_light;

    Spectrum value = Spectrum(0.0f);
    LightEnd y;
    Subpath light_path = no_subpath();
    Subpath camera_path = no_subpath();
    Surface s = no_surface();
    Vertex v;
    v.bsdf = no_bsdf();
    v.frame = frame_from_z(vec3(0.0f, 0.0f, 1.0f));
    v.wo = vec3(0.0f);
    y.surface = s;
    y.vertex = v;
    y.direction = vec3(0.0f);
    y.throughput = Spectrum(0.0f);
    y.mis = light_path.mis;
    bool complete = true;
    // One loop, because a GLSL compiler inlines every call.
    for (uint end = 0u; end < 2u; ++end) {
        bool light = end == 0u;
        int vertices = light ? from_light - 1 : from_camera - 1;
        if (vertices < 1 || !complete) continue;
        Emission start;
        Subpath path;
        if (light) {
            complete = emit_photon(primary_bits(MLT_EMISSION), primary(MLT_EMISSION + 1u),
                                   primary_2d(MLT_EMISSION + 2u), primary_bits_2d(MLT_EMISSION + 4u), start);
            if (!complete) continue;
            path = light_path_begin(start, depth);
        } else {
            vec2 film_point = mlt_film_point(sample_.raster, weight);
            path = camera_path_begin(camera_ray(film_point, mlt_lens()), depth);
        }
        int stride = int(MLT_VERTEX_NUMBERS);
        uint first = MLT_VERTICES;
        if (light) {
            first += MLT_VERTEX_NUMBERS * uint(depth - 1);
            stride = -stride;
        }
        complete = follow_subpath(path, start, vertices, first, stride, from_light == 0, s, v, value);
        if (complete) complete = !bsdf_is_specular(v.bsdf);
        if (light) {
            light_path = path;
            y.surface = s;
            y.vertex = v;
            y.direction = path.walk.ray.direction;
            y.throughput = path.walk.throughput;
            y.mis = path.mis;
        } else {
            camera_path = path;
        }
    }

    if (from_light == 0) {
        value = value * mlt_pixels();
    } else if (!complete) {
        return sample_;
    } else if (from_camera == 1) {
        CameraConnection c;
        if (!camera_connect(y.surface.position, mlt_lens(), c) || !splat_reaches(c.raster)) return sample_;
        sample_.raster = c.raster;
        sample_.one_pixel = 0u;
        value = connect_to_lens(light_path, y.surface, y.vertex, c);
    } else if (from_light == 1) {
        value =
            connect_to_light(camera_path, s, v, primary_bits(MLT_CONNECTION), primary_bits_2d(MLT_CONNECTION + 1u)) *
            mlt_pixels();
    } else {
        PATH_LOG(log_connects(uint(from_light) - 1u, 1.0f));
        value = connect_to_vertex(camera_path, s, v, y) * mlt_pixels();
    }
    // The sensor's limit is one of radiance.
    vec3 color = film_sensor(value * (float(strategies) / mlt_pixels())) * (weight * mlt_pixels());
    float l = abs(luminance(color));
    if (!(l > 0.0f) || !is_finite3(color)) return sample_;
    sample_.color = color;
    sample_.luminance = l;
    return sample_;
}

#endif
