// Material "thindielectric": a pane of glass as a single surface, which reflects or transmits straight on.
#ifndef LAMPYRIS_MATERIALS_THINDIELECTRIC
#define LAMPYRIS_MATERIALS_THINDIELECTRIC

FN Bsdf thindielectric_make(IN(MaterialRecord) m) {
    Bsdf b = no_bsdf();
    b.eta = bounded_eta(m.eta);
    return b;
}

FN bool thindielectric_is_specular(IN(Bsdf) b) { return true; }
FN bool thindielectric_chooses_lobe(IN(Bsdf) b) { return true; }
FN bool thindielectric_transmits(IN(Bsdf) b) { return true; }
FN Spectrum thindielectric_albedo(IN(Bsdf) b) { return Spectrum(1.0f); }
FN uint thindielectric_visible_action(IN(Bsdf) b, float roughness) { return VISIBLE_FOLLOW; }

FN Spectrum thindielectric_eval(IN(Bsdf) b, vec3 wo, vec3 wi, uint transport, OUT(float) pdf) {
    pdf = 0.0f;
    return Spectrum(0.0f);
}

FN bool thindielectric_sample(IN(Bsdf) b, vec3 wo, float uc, vec2 u, uint transport, INOUT(BsdfSample) s) {
    float c = abs(wo.z);
    float r = pane_reflectance(fresnel_dielectric(c, b.eta));
    bool reflected = uc < r;
    s.wi = reflected ? vec3(-wo.x, -wo.y, wo.z) : -wo;
    s.pdf = reflected ? r : 1.0f - r;
    s.f = Spectrum(s.pdf / c);
    s.lobe = (reflected ? LOBE_REFLECTION : LOBE_TRANSMISSION) | LOBE_SPECULAR;
    return s.pdf > 0.0f;
}

#endif
