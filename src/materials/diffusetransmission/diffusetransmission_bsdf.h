// Material "diffusetransmission": Lambert's law on both sides, for paper and leaves.
#ifndef LAMPYRIS_MATERIALS_DIFFUSETRANSMISSION
#define LAMPYRIS_MATERIALS_DIFFUSETRANSMISSION

FN Bsdf diffusetransmission_make(IN(MaterialRecord) m) {
    Bsdf b = no_bsdf();
    b.color0 = bounded_share(m.scale * m.color0);
    b.color1 = bounded_share(m.scale * m.color1);
    return b;
}

FN bool diffusetransmission_is_specular(IN(Bsdf) b) { return false; }
FN bool diffusetransmission_chooses_lobe(IN(Bsdf) b) { return true; }
FN bool diffusetransmission_transmits(IN(Bsdf) b) { return true; }
FN Spectrum diffusetransmission_albedo(IN(Bsdf) b) { return bounded_share(b.color0 + b.color1); }
FN uint diffusetransmission_visible_action(IN(Bsdf) b, float roughness) { return VISIBLE_GATHER; }

// Probability of reflection instead of transmission, in proportion to the largest channel of each, as in pbrt.
FN float diffusetransmission_reflects(IN(Bsdf) b) {
    float r = max_value(b.color0);
    float t = max_value(b.color1);
    return r + t > 0.0f ? r / (r + t) : 1.0f;
}

FN Spectrum diffusetransmission_eval(IN(Bsdf) b, vec3 wo, vec3 wi, uint transport, OUT(float) pdf) {
    float p = diffusetransmission_reflects(b);
    bool reflected = same_hemisphere(wo, wi);
    pdf = pdf_cosine_hemisphere(abs(wi.z)) * (reflected ? p : 1.0f - p);
    return (reflected ? b.color0 : b.color1) * INV_PI;
}

FN bool diffusetransmission_sample(IN(Bsdf) b, vec3 wo, float uc, vec2 u, uint transport, INOUT(BsdfSample) s) {
    float p = diffusetransmission_reflects(b);
    bool reflected = uc < p;
    vec3 wi = sample_cosine_hemisphere(u);
    s.pdf = pdf_cosine_hemisphere(wi.z) * (reflected ? p : 1.0f - p);
    s.wi = (wo.z < 0.0f) == reflected ? vec3(wi.x, wi.y, -wi.z) : wi;
    s.f = (reflected ? b.color0 : b.color1) * INV_PI;
    s.lobe = LOBE_DIFFUSE | (reflected ? LOBE_REFLECTION : LOBE_TRANSMISSION);
    return !is_grazing(wi);
}

#endif
