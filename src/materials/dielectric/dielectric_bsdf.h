// Material "dielectric": glass with reflection and refraction, specular or with GGX microfacets (Walter et al. 2007;
// pbrt, 4th edition, sections 9.5 and 9.7).
//
// Both sides are treated equally: directions are flipped so that wo.z > 0, and eta is then the index on the -z side
// over that on wo's side. `lobes` restricts sampling (and its density) to LOBE_REFLECTION or LOBE_TRANSMISSION;
// LOBE_BOTH_SIDES allows both.
#ifndef LAMPYRIS_MATERIALS_DIELECTRIC
#define LAMPYRIS_MATERIALS_DIELECTRIC

// ---- The lobe, which is also the interface of coats ------------------------------------------------------------------

// A surface is specular if it is smooth, or if the index hardly changes, because microfacets then do not refract.
FN bool dielectric_lobe_is_specular(vec2 alpha, float eta) { return ggx_is_smooth(alpha) || abs(eta - 1.0f) < 1e-4f; }

// Probability of reflection under `lobes`, for the Fresnel reflectance r; negative if there is nothing to choose.
FN float dielectric_lobe_choice(float r, uint lobes) {
    if (lobes == LOBE_BOTH_SIDES) return r;
    if (lobes == LOBE_REFLECTION) return r > 0.0f ? 1.0f : -1.0f;
    return r < 1.0f ? 0.0f : -1.0f;
}

// Value and density of the rough refraction from o to i through the normal m, for o.z > 0 > i.z; do_m = dot(o, m) > 0 >
// di_m. Walter et al. 2007, equations 17 and 21. `length2` is |o + eta i|^2 = (do_m + eta di_m)^2. Radiance is scaled
// by 1/eta^2, which cancels the equation's eta^2; importance is not.
FN float rough_refraction_value(vec2 alpha, float eta, vec3 o, vec3 i, float d, float do_m, float di_m, float length2,
                                uint transport) {
    float value = 4.0f * d * ggx_visibility(o, i, alpha) * abs(do_m * di_m) / length2;
    return transport == TRANSPORT_RADIANCE ? value : value * eta * eta;
}
FN float rough_refraction_pdf(vec2 alpha, float eta, vec3 o, float d, float do_m, float di_m, float length2) {
    return ggx_visible_scale(o, alpha) * d * abs(do_m * di_m) * eta * eta / length2;
}

FN Spectrum dielectric_lobe_eval(vec2 alpha, float eta_up, vec3 wo, vec3 wi, uint transport, uint lobes,
                                 OUT(float) pdf) {
    pdf = 0.0f;
    if (dielectric_lobe_is_specular(alpha, eta_up)) return Spectrum(0.0f);
    bool below = wo.z < 0.0f;
    vec3 o = below ? -wo : wo;
    vec3 i = below ? -wi : wi;
    float eta = below ? 1.0f / eta_up : eta_up;
    bool reflected = i.z > 0.0f;
    vec3 h = reflected ? o + i : o + eta * i;
    float length2 = length_squared(h);
    if (!(length2 > 1e-20f)) return Spectrum(0.0f);
    vec3 m = (h.z < 0.0f ? -1.0f : 1.0f) / sqrt(length2) * h;
    float do_m = dot3(o, m);
    float di_m = dot3(i, m);
    // Microfacets seen from behind scatter nothing.
    if (!(do_m > 0.0f) || (di_m > 0.0f) != reflected) return Spectrum(0.0f);
    // Uses the known refracted cosine: near total reflection it is more accurate than one computed from the other
    // cosine.
    float r = reflected ? fresnel_dielectric(do_m, eta) : fresnel_of_cosines(do_m, -di_m, eta);
    float choice = dielectric_lobe_choice(r, lobes);
    float d = ggx_d(m, alpha);
    if (reflected) {
        pdf = max(choice, 0.0f) * 0.25f * ggx_visible_scale(o, alpha) * d;
        return Spectrum(r * d * ggx_visibility(o, i, alpha));
    }
    if (choice >= 0.0f) pdf = (1.0f - choice) * rough_refraction_pdf(alpha, eta, o, d, do_m, di_m, length2);
    return Spectrum((1.0f - r) * rough_refraction_value(alpha, eta, o, i, d, do_m, di_m, length2, transport));
}

FN bool dielectric_lobe_sample(vec2 alpha, float eta_up, vec3 wo, float uc, vec2 u, uint transport, uint lobes,
                               INOUT(BsdfSample) s) {
    bool below = wo.z < 0.0f;
    vec3 o = below ? -wo : wo;
    float eta = below ? 1.0f / eta_up : eta_up;
    bool specular = dielectric_lobe_is_specular(alpha, eta_up);
    vec3 m = specular ? vec3(0.0f, 0.0f, 1.0f) : ggx_sample_visible(o, alpha, u);
    float do_m = dot3(o, m);
    if (!(do_m > 0.0f)) return false;
    float r = fresnel_dielectric(do_m, eta);
    float choice = dielectric_lobe_choice(r, lobes);
    if (choice < 0.0f) return false;
    bool reflected = uc < choice;
    vec3 i = 2.0f * do_m * m - o;
    if (!reflected && !refract_direction(o, m, do_m, eta, i)) return false;
    if (!(abs(i.z) >= MIN_COSINE) || (i.z > 0.0f) != reflected) return false;
    float share = reflected ? r : 1.0f - r;
    s.wi = below ? -i : i;
    s.eta = reflected ? 1.0f : eta;
    s.pdf = reflected ? choice : 1.0f - choice;
    s.lobe = (reflected ? LOBE_REFLECTION : LOBE_TRANSMISSION) | (specular ? LOBE_SPECULAR : LOBE_GLOSSY);
    float value = 0.0f;
    if (specular) {
        value = share / abs(i.z);
        if (!reflected && transport == TRANSPORT_RADIANCE) value /= eta * eta;
    } else {
        float d = ggx_d(m, alpha);
        if (reflected) {
            value = share * d * ggx_visibility(o, i, alpha);
            s.pdf *= 0.25f * ggx_visible_scale(o, alpha) * d;
        } else {
            float di_m = dot3(i, m);
            float length2 = sqr(do_m + eta * di_m);
            if (!(di_m < 0.0f) || !(length2 > 1e-20f)) return false;
            value = share * rough_refraction_value(alpha, eta, o, i, d, do_m, di_m, length2, transport);
            s.pdf *= rough_refraction_pdf(alpha, eta, o, d, do_m, di_m, length2);
        }
    }
    s.f = Spectrum(value);
    return s.pdf > 0.0f;
}

// ---- The material ----------------------------------------------------------------------------------------------------

FN Bsdf dielectric_make(IN(MaterialRecord) m) {
    Bsdf b = no_bsdf();
    b.eta = bounded_eta(m.eta);
    b.alpha = record_alpha(m);
    return b;
}

FN bool dielectric_is_specular(IN(Bsdf) b) { return dielectric_lobe_is_specular(b.alpha, b.eta); }
FN bool dielectric_chooses_lobe(IN(Bsdf) b) { return true; }
FN bool dielectric_transmits(IN(Bsdf) b) { return true; }
FN Spectrum dielectric_albedo(IN(Bsdf) b) { return Spectrum(1.0f); }

FN uint dielectric_visible_action(IN(Bsdf) b, float roughness) {
    if (dielectric_is_specular(b)) return VISIBLE_FOLLOW;
    return max(b.alpha.x, b.alpha.y) < roughness ? VISIBLE_FOLLOW : VISIBLE_GATHER;
}

FN Spectrum dielectric_eval(IN(Bsdf) b, vec3 wo, vec3 wi, uint transport, OUT(float) pdf) {
    return dielectric_lobe_eval(b.alpha, b.eta, wo, wi, transport, LOBE_BOTH_SIDES, pdf);
}

FN bool dielectric_sample(IN(Bsdf) b, vec3 wo, float uc, vec2 u, uint transport, INOUT(BsdfSample) s) {
    return dielectric_lobe_sample(b.alpha, b.eta, wo, uc, u, transport, LOBE_BOTH_SIDES, s);
}

#endif
