// Connections of a camera path's vertex to lights and to vertices of light paths, and of a light path's vertex to the lens.
#ifndef LAMPYRIS_CONNECT
#define LAMPYRIS_CONNECT

#include "integrators/bidirectional/subpath.h"

PRIVATE(uint, connections_tried, 1)
PRIVATE(uint, connections_visible, 1)

// The last vertex of a light path.
struct LightEnd {
    Surface surface;
    Vertex vertex;
    vec3 direction;  // in which the path arrived
    Spectrum throughput;
    MisSums mis;
};

// A connection in the path log, with log_partner and log_connects. `value`: without the weight.
RARE_FN void log_connection(vec3 to, float distance, Spectrum value, float weight, uint seen) {
    PathLogRecord r = log_record(LOG_CONNECTION);
    r.s = log_now[0].partner_depth + 1u;
    r.t = r.depth + 2u;
    r.partner = log_now[0].partner;
    r.position = to;
    r.distance = distance;
    r.value = rgb_of(value);
    r.weight = weight;
    r.factor = 1.0f / log_now[0].chance;
    r.detail = seen;
    log_write(r);
}

// Next-event estimation: strategy s = 1.
FN Spectrum connect_to_light(IN(Subpath) path, IN(Surface) s, IN(Vertex) v, uint u_choice, uvec2 u) {
    LightSample light;
    if (!light_sample(s.position, u_choice, u, false, light)) return Spectrum(0.0f);
    vec3 wi = to_local(v.frame, light.wi);
    float forward;
    float reverse;
    Spectrum f = bsdf_eval_pdfs(v.bsdf, v.wo, wi, TRANSPORT_RADIANCE, forward, reverse);
    if (is_black(f)) {
        PATH_LOG(log_light(light, f, f, 1.0f, forward, LOG_SEEN_UNSCATTERED));
        return Spectrum(0.0f);
    }
    Spectrum through = scene_transmittance(s, light.wi, light.distance, light.end, path.walk.medium);
    if (is_black(through)) {
        PATH_LOG(log_light(light, f, through, 1.0f, forward, LOG_SEEN_OCCLUDED));
        return Spectrum(0.0f);
    }
    // The density of emission over that of this strategy: both the cosine at the light and the squared distance cancel if it has a
    // surface.
    LightRecord record = lights[light.light];
    float emitted;
    if (HAS(EFFECT_AREA_LIGHTS) && record.kind <= LIGHT_GEOMETRY) {
        emitted = mis_area_density(area_emission_pdf(light.light, s.position, light.position, light.ng, light.wi)) *
                  INV_PI / (light_sides(record) * light.pdf);
    } else if (light.distance < INFINITE_DISTANCE) {
        emitted = point_emission_pdf(record, -light.wi) / mis_area(sqr(light.distance));
        if (HAS(EFFECT_LIGHT_TREE)) emitted *= choice_by_power(light.light) / light.pdf;  // as photons choose
    } else {
        emitted = mis_area_density(1.0f / distant_area());
    }
    uint h = heuristic();
    float others = mis_end(path.mis, emitted * abs_dot(light.wi, s.ng), reverse, passes[0].eta, h);
    if (light.is_delta == 0u) others += mis_term(forward / light.pdf, h);
    PATH_LOG(log_light(light, f * abs(wi.z), through, mis_weight(others), forward, LOG_SEEN_CLEARLY));
    return path.walk.throughput * f * light.radiance * through * (abs(wi.z) * mis_weight(others) / light.pdf);
}

// Connection to a vertex of a light path: strategies with s, t >= 2.
FN Spectrum connect_to_vertex(IN(Subpath) path, IN(Surface) s, IN(Vertex) v, IN(LightEnd) y) {
    vec3 way = y.surface.position - s.position;
    float d2 = length_squared(way);
    if (!(d2 > 0.0f) || !is_finite(d2)) return Spectrum(0.0f);
    float distance = sqrt(d2);
    vec3 w = way / distance;
    vec3 wi = to_local(v.frame, w);
    float forward;
    float reverse;
    Spectrum f = bsdf_eval_pdfs(v.bsdf, v.wo, wi, TRANSPORT_RADIANCE, forward, reverse);
    if (is_black(f)) {
        PATH_LOG(log_connection(y.surface.position, distance, f, 1.0f, LOG_SEEN_UNSCATTERED));
        return Spectrum(0.0f);
    }
    float forward_y;
    float reverse_y;
    Spectrum f_y = bsdf_eval_pdfs(y.vertex.bsdf, y.vertex.wo, to_local(y.vertex.frame, -w), TRANSPORT_IMPORTANCE,
                                  forward_y, reverse_y);
    if (is_black(f_y)) {
        PATH_LOG(log_connection(y.surface.position, distance, f_y, 1.0f, LOG_SEEN_UNSCATTERED));
        return Spectrum(0.0f);
    }
    connections_tried[0] += 1u;
    vec3 end = origin_beyond(y.surface.position, y.surface.way + (SHADOW_ROUNDING * distance) * y.surface.ng, -w);
    Spectrum through = scene_transmittance(s, w, distance, end, path.walk.medium);
    if (is_black(through)) {
        PATH_LOG(log_connection(y.surface.position, distance, through, 1.0f, LOG_SEEN_OCCLUDED));
        return Spectrum(0.0f);
    }
    connections_visible[0] += 1u;
    float inverse_d2 = 1.0f / mis_area(d2);
    uint h = heuristic();
    float others = mis_end(y.mis, forward * abs_dot(w, y.surface.ng) * inverse_d2, reverse_y, passes[0].eta, h) +
                   mis_end(path.mis, forward_y * abs_dot(w, s.ng) * inverse_d2, reverse, passes[0].eta, h);
    others = others / connection_samples();
    float cosine_y = importance_cosine(y.direction, y.surface, y.vertex, -w);
    PATH_LOG(log_connection(y.surface.position, distance,
                            path.walk.throughput * f * f_y * through * y.throughput * (abs(wi.z) * cosine_y / d2),
                            mis_weight(others), LOG_SEEN_CLEARLY));
    return path.walk.throughput * f * f_y * through * y.throughput * (abs(wi.z) * cosine_y * mis_weight(others) / d2);
}

// Connection of a light path's vertex to the lens: strategy t = 1. The radiance of the pixel without the pixel filter, times the number
// of light paths.
FN Spectrum connect_to_lens(IN(Subpath) path, IN(Surface) s, IN(Vertex) v, IN(CameraConnection) c) {
    float forward;
    float reverse;
    Spectrum f = bsdf_eval_pdfs(v.bsdf, v.wo, to_local(v.frame, c.wi), TRANSPORT_IMPORTANCE, forward, reverse);
    if (is_black(f)) return Spectrum(0.0f);
    Spectrum through = scene_transmittance(s, c.wi, c.distance, c.end, path.walk.medium);
    if (is_black(through)) return Spectrum(0.0f);
    float from_camera = mis_area_density(c.importance * abs_dot(c.wi, s.ng)) / lens_samples();
    float others = mis_end(path.mis, from_camera, reverse, passes[0].eta, heuristic());
    PATH_LOG(log_weighs(mis_weight(others)));
    float cosine = importance_cosine(path.walk.ray.direction, s, v, c.wi);
    return path.walk.throughput * f * through * (cosine * c.importance * mis_weight(others));
}

#endif
