// Metals: complex Fresnel reflection, specular or by GGX microfacets (single scattering; Cook and Torrance's form, pbrt,
// 4th edition, section 9.6.5). Both sides of the surface reflect alike.
#ifndef LAMPYRIS_KERNEL_BSDF_CONDUCTOR
#define LAMPYRIS_KERNEL_BSDF_CONDUCTOR

// D F G2 / (4 cos_o cos_i), for wo.z and wi.z > 0, at the microfacet normal m.
FN vec3 conductor_value(vec3 n, vec3 k, vec2 alpha, uint flags, vec3 wo, vec3 wi, vec3 m, float d) {
    vec3 f = fresnel_conductor(max(dot3(wo, m), 0.0f), n, k) * (d * ggx_visibility(wo, wi, alpha));
    if ((flags & MATERIAL_ENERGY_COMPENSATION) != 0u) {
        f = f * ggx_energy_compensation(fresnel_conductor(1.0f, n, k), wo.z, alpha);
    }
    return f;
}

FN vec3 conductor_eval(vec3 n, vec3 k, vec2 alpha, uint flags, vec3 wo, vec3 wi, OUT(float) pdf) {
    pdf = 0.0f;
    if (ggx_is_smooth(alpha) || !same_hemisphere(wo, wi)) return vec3(0.0f);
    vec3 o = wo.z < 0.0f ? -wo : wo;
    vec3 i = wo.z < 0.0f ? -wi : wi;
    vec3 m = unit(o + i);
    float d = ggx_d(m, alpha);
    // Visible normals' density over the Jacobian 4 dot(wo, m) of the reflection.
    pdf = 0.25f * ggx_visible_scale(o, alpha) * d;
    return conductor_value(n, k, alpha, flags, o, i, m, d);
}

FN bool conductor_sample(vec3 n, vec3 k, vec2 alpha, uint flags, vec3 wo, vec2 u, INOUT(BsdfSample) s) {
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
    s.f = conductor_value(n, k, alpha, flags, o, i, m, d);
    s.pdf = 0.25f * ggx_visible_scale(o, alpha) * d;
    s.lobe = LOBE_REFLECTION | LOBE_GLOSSY;
    return true;
}

#endif
