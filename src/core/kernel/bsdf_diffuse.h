// Lambert's law: reflection, and for thin sheets transmission.
#ifndef LAMPYRIS_KERNEL_BSDF_DIFFUSE
#define LAMPYRIS_KERNEL_BSDF_DIFFUSE

FN vec3 diffuse_eval(vec3 reflectance, vec3 wo, vec3 wi, OUT(float) pdf) {
    pdf = 0.0f;
    if (!same_hemisphere(wo, wi)) return vec3(0.0f);
    pdf = pdf_cosine_hemisphere(abs(wi.z));
    return reflectance * INV_PI;
}

FN bool diffuse_sample(vec3 reflectance, vec3 wo, vec2 u, INOUT(BsdfSample) s) {
    vec3 wi = sample_cosine_hemisphere(u);
    s.pdf = pdf_cosine_hemisphere(wi.z);
    s.wi = wo.z < 0.0f ? vec3(wi.x, wi.y, -wi.z) : wi;
    s.f = reflectance * INV_PI;
    s.lobe = LOBE_REFLECTION | LOBE_DIFFUSE;
    return !is_grazing(wi);
}

// Probability of reflection rather than transmission: by the larger channel of each, as pbrt.
FN float diffuse_reflection_probability(vec3 reflectance, vec3 transmittance) {
    float r = max_component(reflectance);
    float t = max_component(transmittance);
    return r + t > 0.0f ? r / (r + t) : 1.0f;
}

FN vec3 diffuse_transmission_eval(vec3 reflectance, vec3 transmittance, vec3 wo, vec3 wi, OUT(float) pdf) {
    float p = diffuse_reflection_probability(reflectance, transmittance);
    bool reflected = same_hemisphere(wo, wi);
    pdf = pdf_cosine_hemisphere(abs(wi.z)) * (reflected ? p : 1.0f - p);
    return (reflected ? reflectance : transmittance) * INV_PI;
}

FN bool diffuse_transmission_sample(vec3 reflectance, vec3 transmittance, vec3 wo, float uc, vec2 u,
                                    INOUT(BsdfSample) s) {
    float p = diffuse_reflection_probability(reflectance, transmittance);
    bool reflected = uc < p;
    vec3 wi = sample_cosine_hemisphere(u);
    s.pdf = pdf_cosine_hemisphere(wi.z) * (reflected ? p : 1.0f - p);
    s.wi = (wo.z < 0.0f) == reflected ? vec3(wi.x, wi.y, -wi.z) : wi;
    s.f = (reflected ? reflectance : transmittance) * INV_PI;
    s.lobe = LOBE_DIFFUSE | (reflected ? LOBE_REFLECTION : LOBE_TRANSMISSION);
    return !is_grazing(wi);
}

#endif
