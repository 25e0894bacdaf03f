// Material "diffuse": Lambert's law.
#ifndef LAMPYRIS_MATERIALS_DIFFUSE
#define LAMPYRIS_MATERIALS_DIFFUSE

// ---- The lobe, which is also the base of coateddiffuse ---------------------------------------------------------------

FN Spectrum diffuse_lobe_eval(Spectrum reflectance, vec3 wo, vec3 wi, OUT(float) pdf) {
    pdf = 0.0f;
    if (!same_hemisphere(wo, wi)) return Spectrum(0.0f);
    pdf = pdf_cosine_hemisphere(abs(wi.z));
    return reflectance * INV_PI;
}

FN bool diffuse_lobe_sample(Spectrum reflectance, vec3 wo, vec2 u, INOUT(BsdfSample) s) {
    vec3 wi = sample_cosine_hemisphere(u);
    s.pdf = pdf_cosine_hemisphere(wi.z);
    s.wi = wo.z < 0.0f ? vec3(wi.x, wi.y, -wi.z) : wi;
    s.f = reflectance * INV_PI;
    s.lobe = LOBE_REFLECTION | LOBE_DIFFUSE;
    return !is_grazing(wi);
}

// ---- The material ----------------------------------------------------------------------------------------------------

FN Bsdf diffuse_make(IN(MaterialRecord) m) {
    Bsdf b = no_bsdf();
    b.color0 = bounded_share(m.color0);
    return b;
}

FN bool diffuse_is_specular(IN(Bsdf) b) { return false; }
FN bool diffuse_chooses_lobe(IN(Bsdf) b) { return false; }
FN bool diffuse_transmits(IN(Bsdf) b) { return false; }
FN Spectrum diffuse_albedo(IN(Bsdf) b) { return b.color0; }
FN uint diffuse_visible_action(IN(Bsdf) b, float roughness) { return VISIBLE_GATHER; }

FN Spectrum diffuse_eval(IN(Bsdf) b, vec3 wo, vec3 wi, uint transport, OUT(float) pdf) {
    return diffuse_lobe_eval(b.color0, wo, wi, pdf);
}

FN bool diffuse_sample(IN(Bsdf) b, vec3 wo, float uc, vec2 u, uint transport, INOUT(BsdfSample) s) {
    return diffuse_lobe_sample(b.color0, wo, u, s);
}

#endif
