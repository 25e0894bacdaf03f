// Follows a camera path: connects each vertex to a light (strategies s = 1) and to the vertices of a light path, and stores it
// to be merged with photons.
#include "core/kernel/scene.h"

#include "core/kernel/film.h"
#include "integrators/bidirectional/bidirectional_layout.h"

BUFFER_RO(0, FilmWindow, window)
BUFFER_RO(1, BidirectionalPass, passes)
BUFFER_RW(2, FilmPixel, film)
BUFFER_RW(3, uint, counters)
BUFFER_RO(4, PathVertexRecord, vertices)
BUFFER_RO(5, uint, last_vertices)
BUFFER_RW(6, vec4,
          seen)  // of each pixel: what its camera path contributes, without merging; w: weight of the pixel filter
BUFFER_RW(7, PathVertexRecord, merged)  // vertices to be merged
BUFFER_RW(8, vec4, queries)             // position, radius of each of these
BUFFER_RW(9, uint, last_merged)         // of each pixel: slot of the last one, or NONE
BUFFER_RW(10, float, connected)  // of each pixel, if the pass wants shares: what connections to light paths contribute

#include "core/kernel/camera_connect.h"
#include "integrators/bidirectional/path_vertex.h"
#include "integrators/bidirectional/connect.h"
#include "integrators/bidirectional/partners.h"

// Dimensions of a vertex, as those of `path`, and one for the choice of vertices to connect to.
CONST uint BDPT_DIRECTION_AND_LIGHT = 0u;
CONST uint BDPT_LIGHT_CHOICE = 4u;
CONST uint BDPT_LOBE = 5u;
CONST uint BDPT_ROULETTE = 6u;
CONST uint BDPT_CONNECTIONS = 7u;
CONST uint BDPT_VERTEX_DIMENSIONS = 8u;

// Connects to vertices of light paths.
FN Spectrum connect_to_light_paths(IN(Subpath) path, IN(Surface) s, IN(Vertex) v, uint light_path, uint bits) {
    Partners partners = partners_begin(light_path, path.walk.depth + 1, bits);
    Spectrum sum = Spectrum(0.0f);
    while (next_partner(partners)) {
        PathVertexRecord y = vertices[partners.found];
        LightEnd end;
        end.vertex = path_vertex(y, end.surface);
        end.direction = path_vertex_direction(y);
        end.throughput = path_vertex_throughput(y);
        end.mis = path_vertex_sums(y);
        PATH_LOG(log_partner(partners.light_path));
        PATH_LOG(log_connects(uint(path_vertex_depth(y)), partners.chance));
        sum += connect_to_vertex(path, s, v, end);
    }
    return sum / partners.chance;
}

// Stores a vertex to be merged; the result is its slot.
FN uint keep_vertex(IN(Subpath) path, IN(Surface) s, uint previous) {
    BidirectionalPass pass = passes[0];
    uint slot = ATOMIC_ADD_U32(counters[MERGE_QUERIES], 1u);
    if (slot >= pass.query_capacity) return previous;
    merged[slot] =
        path_vertex_record(path.walk.ray, s, path.walk.throughput, path.mis, uint(path.walk.depth) + 1u, 0u, previous);
    queries[slot] = vec4(s.position.x, s.position.y, s.position.z, pass.radius);
    return slot;
}

KERNEL(camera_subpaths) {
    BidirectionalPass pass = passes[0];
    FilmWindow w = window[0];
    uvec2 local = film_pixel_of(index, w);
    uint light_path = film_pixel_number(local, w) % pass.paths;
    if (light_path < pass.first_path || light_path - pass.first_path >= pass.part_paths) return;
    uint at = local.y * w.width + local.x;
    CameraSample camera = camera_sample(w, local, 0u);
    Subpath path = camera_path_begin(camera.ray, pass.maxdepth);
    FirstHit first = no_first_hit();
    Spectrum radiance = Spectrum(0.0f);
    Spectrum by_connections = Spectrum(0.0f);
    connections_tried[0] = 0u;
    connections_visible[0] = 0u;
    uint last_kept = NONE;
    Surface s;
    while (walk_next(path.walk, s)) {
        if (HAS(EFFECT_AREA_LIGHTS) && s.light != NONE && strategy_wanted(0, path.walk.depth + 2)) {
            Spectrum emitted = light_emission(s, -path.walk.ray.direction);
            if (!is_black(emitted)) {
                float weight = weight_of_hit_light(path, s);
                radiance += path.walk.throughput * emitted * weight;
                PATH_LOG(log_emission(s, path.walk.throughput * emitted, weight));
            }
        }
        if (walk_crosses(path.walk, s)) continue;
        if (path.walk.depth == 0) camera_path_meets_first(path, s);
        subpath_arrives(path, s);
        Vertex v = walk_vertex(path.walk, s);
        if (path.walk.depth == 0) first = first_hit(s, bsdf_albedo(v.bsdf), distance_of(s.position, camera.ray.origin));
        if (path.walk.depth >= path.walk.maxdepth) break;
        uint dimension = CAMERA_DIMENSIONS + uint(path.walk.depth) * BDPT_VERTEX_DIMENSIONS;
        uvec4 u = sample_bits_joined_2d_2d_at(camera.numbers, dimension + BDPT_DIRECTION_AND_LIGHT,
                                              CAMERA_GROUPS + uint(path.walk.depth));
        bool joins = !bsdf_is_specular(v.bsdf) && scene[0].light_count > 0u;
        if (joins && pass.eta > 0.0f) last_kept = keep_vertex(path, s, last_kept);
        if (joins && pass.strategies == STRATEGIES_ALL) {
            if (strategy_wanted(1, path.walk.depth + 2)) {
                uint u_light = 0u;
                if (light_choice_needs_number())
                    u_light = sample_bits_1d_at(camera.numbers, dimension + BDPT_LIGHT_CHOICE);
                radiance += connect_to_light(path, s, v, u_light, uvec2(u.z, u.w));
            }
            if (pass.connections != 0) {
                uint bits = sample_bits_1d_at(camera.numbers, dimension + BDPT_CONNECTIONS);
                Spectrum found = connect_to_light_paths(path, s, v, light_path, bits);
                radiance += found;
                by_connections += found;
            }
        }
        BsdfSample next;
        float density;
        float u_lobe = 0.0f;
        if (bsdf_chooses_lobe(v.bsdf)) u_lobe = sample_1d_at(camera.numbers, dimension + BDPT_LOBE);
        vec2 u_direction = unit_floats(uvec2(u.x, u.y));
        if (!bsdf_sample_density(v.bsdf, v.wo, u_lobe, u_direction, TRANSPORT_RADIANCE, next, density)) break;
        if (!subpath_leaves(path, s, v, next, density, pass.rrdepth, camera.numbers, dimension + BDPT_ROULETTE)) break;
    }
    if (HAS(EFFECT_ENVIRONMENT) && path.walk.escaped && strategy_wanted(0, path.walk.depth + 2)) {
        Spectrum emitted = environment_radiance(path.walk.ray.direction);
        if (!is_black(emitted)) {
            float weight = weight_of_environment(path);
            radiance += path.walk.throughput * emitted * weight;
            PATH_LOG(log_environment(path.walk.ray.direction, path.walk.throughput * emitted, weight));
        }
    }
    seen[at] = slot_of(radiance, camera.weight);
    if (pass.shares != 0u) connected[at] = dot3(film_sensor(by_connections), vec3(1.0f / 3.0f));
    if (pass.eta > 0.0f) last_merged[at] = last_kept;
    if (pass.features != 0u) {
        FilmPixel pixel = film[at];
        film_add_first_hit(pixel, first);
        pixel.rays += traced_rays[0];
        film[at] = pixel;
    }
    ATOMIC_ADD_U32(counters[CONNECTIONS_TRIED], connections_tried[0]);
    ATOMIC_ADD_U32(counters[CONNECTIONS_VISIBLE], connections_visible[0]);
}
