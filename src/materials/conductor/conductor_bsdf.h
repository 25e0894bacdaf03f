// Material "conductor": a metal with complex Fresnel reflection, specular or with GGX microfacets (single scattering;
// Cook and Torrance's form, pbrt, 4th edition, section 9.6.5). Both sides of the surface reflect equally.
#ifndef LAMPYRIS_MATERIALS_CONDUCTOR
#define LAMPYRIS_MATERIALS_CONDUCTOR

// ---- The lobe, which is also the base of coatedconductor -------------------------------------------------------------

// D F G2 / (4 cos_o cos_i), for wo.z and wi.z > 0, at the microfacet normal m with density d.
FN Spectrum conductor_lobe_value(Spectrum n, Spectrum k, vec2 alpha, uint flags, vec3 wo, vec3 wi, vec3 m, float d) {
    Spectrum f = fresnel_conductor(max(dot3(wo, m), 0.0f), n, k) * (d * ggx_visibility(wo, wi, alpha));
    if ((flags & MATERIAL_ENERGY_COMPENSATION) != 0u) {
        f = f * ggx_energy_compensation(fresnel_conductor(1.0f, n, k), wo.z, alpha);
    }
    return f;
}

FN Spectrum conductor_lobe_eval(Spectrum n, Spectrum k, vec2 alpha, uint flags, vec3 wo, vec3 wi, OUT(float) pdf) {
    pdf = 0.0f;
    if (ggx_is_smooth(alpha) || !same_hemisphere(wo, wi)) return Spectrum(0.0f);
    vec3 o = wo.z < 0.0f ? -wo : wo;
    vec3 i = wo.z < 0.0f ? -wi : wi;
    vec3 m = unit(o + i);
    float d = ggx_d(m, alpha);
    // The density of visible normals over the Jacobian 4 dot(wo, m) of the reflection.
    pdf = 0.25f * ggx_visible_scale(o, alpha) * d;
    return conductor_lobe_value(n, k, alpha, flags, o, i, m, d);
}

FN bool conductor_lobe_sample(Spectrum n, Spectrum k, vec2 alpha, uint flags, vec3 wo, vec2 u, INOUT(BsdfSample) s) {
    if (ggx_is_smooth(alpha)) {
        float c = abs(wo.z);
        s.wi = vec3(-wo.x, -wo.y, wo.z);
        s.f = fresnel_conductor(c, n, k) / c;
        s.pdf = 1.0f;
        s.lobe = LOBE_REFLECTION | LOBE_SPECULAR;
        return true;
    }
    vec3 o = wo.z < 0.0f ? -wo : wo;
    vec3 m = ggx_sample_visible(o, alpha, u);
    vec3 i = 2.0f * dot3(o, m) * m - o;
    if (!(i.z >= MIN_COSINE)) return false;
    float d = ggx_d(m, alpha);
    s.wi = wo.z < 0.0f ? -i : i;
    s.f = conductor_lobe_value(n, k, alpha, flags, o, i, m, d);
    s.pdf = 0.25f * ggx_visible_scale(o, alpha) * d;
    s.lobe = LOBE_REFLECTION | LOBE_GLOSSY;
    return true;
}

// k for which a conductor with n = 1 has the given normal reflectance (pbrt, 4th edition, section 9.3.6).
FN Spectrum conductor_k_of_reflectance(Spectrum reflectance) {
    Spectrum r = clamp_each(reflectance, 0.0f, 0.9999f);
#define INDEX_K(i) 2.0f * sqrt(r[i] / (1.0f - r[i]))
    return SPECTRUM_EACH(INDEX_K);
#undef INDEX_K
}

// n + ik of a record, relative to the outside.
FN void conductor_index(IN(MaterialRecord) m, OUT(Spectrum) n, OUT(Spectrum) k) {
    n = m.color0;
    k = m.color1;
    if ((m.flags & MATERIAL_USES_REFLECTANCE) != 0u) {
        k = conductor_k_of_reflectance(n);
        n = Spectrum(1.0f);
    }
}

// ---- The material ----------------------------------------------------------------------------------------------------

FN Bsdf conductor_make(IN(MaterialRecord) m) {
    Bsdf b = no_bsdf();
    b.flags = m.flags & MATERIAL_ENERGY_COMPENSATION;
    Spectrum n;
    Spectrum k;
    conductor_index(m, n, k);
    b.color0 = bounded_index(n);
    b.color1 = bounded_index(k);
    b.alpha = record_alpha(m);
    return b;
}

FN bool conductor_is_specular(IN(Bsdf) b) { return ggx_is_smooth(b.alpha); }
FN bool conductor_chooses_lobe(IN(Bsdf) b) { return false; }
FN bool conductor_transmits(IN(Bsdf) b) { return false; }
FN Spectrum conductor_albedo(IN(Bsdf) b) { return fresnel_conductor(1.0f, b.color0, b.color1); }

FN uint conductor_visible_action(IN(Bsdf) b, float roughness) {
    if (ggx_is_smooth(b.alpha)) return VISIBLE_FOLLOW;
    return max(b.alpha.x, b.alpha.y) < roughness ? VISIBLE_FOLLOW : VISIBLE_GATHER;
}

FN Spectrum conductor_eval(IN(Bsdf) b, vec3 wo, vec3 wi, uint transport, OUT(float) pdf) {
    return conductor_lobe_eval(b.color0, b.color1, b.alpha, b.flags, wo, wi, pdf);
}

FN bool conductor_sample(IN(Bsdf) b, vec3 wo, float uc, vec2 u, uint transport, INOUT(BsdfSample) s) {
    return conductor_lobe_sample(b.color0, b.color1, b.alpha, b.flags, wo, u, s);
}

#endif
