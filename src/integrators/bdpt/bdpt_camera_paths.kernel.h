// Follows a camera path, and connects each vertex to a light (strategies s = 1) and to the vertices of a light path.
#include "core/kernel/scene.h"

#include "core/kernel/film.h"
#include "integrators/bidirectional/bidirectional_layout.h"

BUFFER_RO(0, FilmWindow, window)
BUFFER_RO(1, BidirectionalPass, passes)
BUFFER_RW(2, FilmPixel, film)
BUFFER_RW(3, uint, counters)
BUFFER_RO(4, LightVertexRecord, vertices)
BUFFER_RO(5, uint, last_vertices)
BUFFER_RW(6, vec4, seen)  // of each pixel: what its camera path contributes

#include "core/kernel/camera_connect.h"
#include "integrators/bidirectional/light_vertex.h"
#include "integrators/bidirectional/subpath.h"

// Dimensions of a vertex, as those of `path`, and one for the choice of vertices to connect to.
CONST uint BDPT_DIRECTION_AND_LIGHT = 0u;
CONST uint BDPT_LIGHT_CHOICE = 4u;
CONST uint BDPT_LOBE = 5u;
CONST uint BDPT_ROULETTE = 6u;
CONST uint BDPT_CONNECTIONS = 7u;
CONST uint BDPT_VERTEX_DIMENSIONS = 8u;

PRIVATE(uint, connections_tried, 1)
PRIVATE(uint, connections_visible, 1)

// Next-event estimation: strategy s = 1.
FN Spectrum connect_to_light(IN(Subpath) path, IN(Surface) s, IN(Vertex) v, uint u_choice, uvec2 u) {
    LightSample light;
    if (!light_sample(s.position, u_choice, u, light)) return Spectrum(0.0f);
    vec3 wi = to_local(v.frame, light.wi);
    float forward;
    float reverse;
    Spectrum f = bsdf_eval_pdfs(v.bsdf, v.wo, wi, TRANSPORT_RADIANCE, forward, reverse);
    if (is_black(f)) return Spectrum(0.0f);
    Spectrum through = scene_transmittance(s, light.wi, light.distance, light.end, path.walk.medium);
    if (is_black(through)) return Spectrum(0.0f);
    // The density of emission over that of this strategy: both the cosine at the light and the squared distance cancel if it has a
    // surface.
    LightRecord record = lights[light.light];
    float emitted;
    if (HAS(EFFECT_AREA_LIGHTS) && record.kind <= LIGHT_GEOMETRY) {
        emitted = mis_area_density(area_emission_pdf(light.light, s.position, light.position, light.ng, light.wi)) *
                  INV_PI / (light_sides(record) * light.pdf);
    } else if (light.distance < INFINITE_DISTANCE) {
        emitted = point_emission_pdf(record, -light.wi) / mis_area(sqr(light.distance));
    } else {
        emitted = mis_area_density(1.0f / distant_area());
    }
    uint h = heuristic();
    float others = mis_end(path.mis, emitted * abs_dot(light.wi, s.ng), reverse, h);
    if (light.is_delta == 0u) others += mis_term(forward / light.pdf, h);
    return path.walk.throughput * f * light.radiance * through * (abs(wi.z) * mis_weight(others) / light.pdf);
}

// Connection to a vertex of a light path: strategies with s, t >= 2.
FN Spectrum connect_to_vertex(IN(Subpath) path, IN(Surface) s, IN(Vertex) v, IN(LightVertexRecord) y) {
    Surface at_y;
    Vertex vertex_y = light_vertex(y, at_y);
    vec3 way = at_y.position - s.position;
    float d2 = length_squared(way);
    if (!(d2 > 0.0f) || !is_finite(d2)) return Spectrum(0.0f);
    float distance = sqrt(d2);
    vec3 w = way / distance;
    vec3 wi = to_local(v.frame, w);
    float forward;
    float reverse;
    Spectrum f = bsdf_eval_pdfs(v.bsdf, v.wo, wi, TRANSPORT_RADIANCE, forward, reverse);
    if (is_black(f)) return Spectrum(0.0f);
    float forward_y;
    float reverse_y;
    Spectrum f_y = bsdf_eval_pdfs(vertex_y.bsdf, vertex_y.wo, to_local(vertex_y.frame, -w), TRANSPORT_IMPORTANCE,
                                  forward_y, reverse_y);
    if (is_black(f_y)) return Spectrum(0.0f);
    connections_tried[0] += 1u;
    vec3 end = origin_beyond(at_y.position, at_y.way + (SHADOW_ROUNDING * distance) * at_y.ng, -w);
    Spectrum through = scene_transmittance(s, w, distance, end, path.walk.medium);
    if (is_black(through)) return Spectrum(0.0f);
    connections_visible[0] += 1u;
    float inverse_d2 = 1.0f / mis_area(d2);
    uint h = heuristic();
    float others = mis_end(light_vertex_sums(y), forward * abs_dot(w, at_y.ng) * inverse_d2, reverse_y, h) +
                   mis_end(path.mis, forward_y * abs_dot(w, s.ng) * inverse_d2, reverse, h);
    float cosine_y = importance_cosine(light_vertex_direction(y), at_y, vertex_y, -w);
    return path.walk.throughput * f * f_y * through * light_vertex_throughput(y) *
           (abs(wi.z) * cosine_y * mis_weight(others) / d2);
}

// Connects to all vertices of the light path that leave the path at most maxdepth scattering vertices, or to `connections` of them,
// each with the same probability.
FN Spectrum connect_to_path(IN(Subpath) path, IN(Surface) s, IN(Vertex) v, uint last, float u) {
    BidirectionalPass pass = passes[0];
    Spectrum sum = Spectrum(0.0f);
    uint slot = last;
    uint count = 0u;
    float chance = 1.0f;
    int depth = path.walk.depth + 1;
    for (uint turn = 0u; slot != NONE && turn < 65536u; ++turn) {
        LightVertexRecord y = vertices[slot];
        slot = light_vertex_previous(y);
        if (light_vertex_depth(y) + depth > pass.maxdepth) continue;
        if (!strategy_wanted(light_vertex_depth(y) + 1, depth + 1)) continue;
        uint rank = light_vertex_rank(y);
        if (count == 0u) {
            count = rank;
            if (pass.connections > 0 && uint(pass.connections) < count) chance = float(pass.connections) / float(count);
        }
        // Systematic sampling: of `count` vertices, those at which floor(rank chance + u) grows.
        if (chance < 1.0f && floor(float(rank) * chance + u) == floor(float(rank - 1u) * chance + u)) continue;
        sum += connect_to_vertex(path, s, v, y);
    }
    return sum / chance;
}

KERNEL(bdpt_camera_paths) {
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
    connections_tried[0] = 0u;
    connections_visible[0] = 0u;
    Surface s;
    while (walk_next(path.walk, s)) {
        if (HAS(EFFECT_AREA_LIGHTS) && s.light != NONE && strategy_wanted(0, path.walk.depth + 2)) {
            Spectrum emitted = light_emission(s, -path.walk.ray.direction);
            if (!is_black(emitted)) radiance += path.walk.throughput * emitted * weight_of_hit_light(path, s);
        }
        if (walk_crosses(path.walk, s)) continue;
        if (path.walk.depth == 0) camera_path_meets_first(path, s);
        subpath_arrives(path, s);
        Vertex v = walk_vertex(path.walk, s);
        if (path.walk.depth == 0) first = first_hit(s, bsdf_albedo(v.bsdf), distance_of(s.position, camera.ray.origin));
        if (path.walk.depth >= path.walk.maxdepth) break;
        uint dimension = CAMERA_DIMENSIONS + uint(path.walk.depth) * BDPT_VERTEX_DIMENSIONS;
        uvec4 u = sample_bits_2d_2d_at(camera.numbers, dimension + BDPT_DIRECTION_AND_LIGHT);
        if (!bsdf_is_specular(v.bsdf) && scene[0].light_count > 0u) {
            if (strategy_wanted(1, path.walk.depth + 2)) {
                uint u_light = 0u;
                if (light_choice_needs_number())
                    u_light = sample_bits_1d_at(camera.numbers, dimension + BDPT_LIGHT_CHOICE);
                radiance += connect_to_light(path, s, v, u_light, uvec2(u.z, u.w));
            }
            if (pass.connections != 0) {
                float u_connections = sample_1d_at(camera.numbers, dimension + BDPT_CONNECTIONS);
                radiance += connect_to_path(path, s, v, last_vertices[light_path - pass.first_path], u_connections);
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
        if (!is_black(emitted)) radiance += path.walk.throughput * emitted * weight_of_environment(path);
    }
    vec3 value = film_sensor(radiance) * camera.weight;
    seen[at] = vec4(value.x, value.y, value.z, 0.0f);
    FilmPixel pixel = film[at];
    film_add_first_hit(pixel, first);
    pixel.rays += traced_rays[0];
    film[at] = pixel;
    ATOMIC_ADD_U32(counters[CONNECTIONS_TRIED], connections_tried[0]);
    ATOMIC_ADD_U32(counters[CONNECTIONS_VISIBLE], connections_visible[0]);
}
