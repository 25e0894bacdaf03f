// Direct light at a vertex from one sampled light: next-event estimation.
#ifndef LAMPYRIS_KERNEL_DIRECT_LIGHT
#define LAMPYRIS_KERNEL_DIRECT_LIGHT

// A light sample in the path log. `f`: the BSDF times the cosine; `through`: the share that arrives; `density`: of the BSDF.
RARE_FN void log_light(LightSample light, Spectrum f, Spectrum through, float weight, float density, uint seen) {
    PathLogRecord r = log_record(LOG_LIGHT);
    r.s = 1u;
    r.t = r.depth + 2u;
    r.light = light.light;
    r.direction = light.wi;
    r.distance = light.distance;
    r.pdf = light.pdf;
    r.extra = density;
    r.value = r.throughput * rgb_of(f * light.radiance * through / light.pdf);
    r.weight = weight;
    r.detail = seen;
    log_write(r);
}

// `weighted`: multiply by the weight of multiple importance sampling against bsdf_sample; paths that do not also sample
// the BSDF need the full value. `medium`: the medium through which the vertex at s was reached. u_choice and u: bits of
// random numbers.
FN Spectrum direct_light(IN(Surface) s, IN(Vertex) v, uint medium, uint u_choice, uvec2 u, bool weighted) {
    LightSample light;
    if (!light_sample(s.position, u_choice, u, weighted, light)) return Spectrum(0.0f);
    vec3 wi = to_local(v.frame, light.wi);
    float density;
    uint jobs = weighted ? LAYERED_VALUE | LAYERED_DENSITY : LAYERED_VALUE;
    Spectrum f = bsdf_eval_jobs(v.bsdf, v.wo, wi, TRANSPORT_RADIANCE, jobs, density) * abs(wi.z);
    if (is_black(f)) {
        PATH_LOG(log_light(light, f, f, 1.0f, 0.0f, LOG_SEEN_UNSCATTERED));
        return Spectrum(0.0f);
    }
    Spectrum arriving = scene_transmittance(s, light.wi, light.distance, light.end, medium);
    if (is_black(arriving)) {
        PATH_LOG(log_light(light, f, arriving, 1.0f, 0.0f, LOG_SEEN_OCCLUDED));
        return Spectrum(0.0f);
    }
    if (!weighted || light.is_delta != 0u) density = 0.0f;
    PATH_LOG(log_light(light, f, arriving, power_heuristic_over_pdf(light.pdf, density) * light.pdf, density,
                       LOG_SEEN_CLEARLY));
    Spectrum reflected = f * light.radiance * power_heuristic_over_pdf(light.pdf, density);
    return HAS(EFFECT_ALPHA | EFFECT_MEDIUM) ? reflected * arriving : reflected;
}

#endif
