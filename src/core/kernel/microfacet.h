// The GGX (Trowbridge-Reitz) microfacet distribution with Smith's height-correlated masking and visible-normal sampling.
//
// Everything is in the local frame with the macroscopic normal +z. `alpha` is the roughness along x and y, from
// ggx_alpha. Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces"; Heitz 2014, "Understanding
// the Masking-Shadowing Function in Microfacet-Based BRDFs".
#ifndef LAMPYRIS_KERNEL_MICROFACET
#define LAMPYRIS_KERNEL_MICROFACET

// If both alphas are below this, a surface is specular, as in pbrt.
CONST float GGX_SMOOTH = 1e-3f;

// pbrt's remapping of the user's roughness to alpha.
FN float ggx_roughness_to_alpha(float roughness) { return safe_sqrt(roughness); }

FN bool ggx_is_smooth(vec2 alpha) {
    if (!HAS(EFFECT_ROUGH)) return true;
    return max(alpha.x, alpha.y) < GGX_SMOOTH;
}

// Alpha as the functions below need it: zero for smooth surfaces; as in pbrt, a rough surface has at least 1e-4 along
// its smoother axis.
FN vec2 ggx_alpha(float alpha_x, float alpha_y) {
    if (!(max(alpha_x, alpha_y) >= GGX_SMOOTH)) return vec2(0.0f, 0.0f);
    return vec2(clamp(alpha_x, 1e-4f, 1e3f), clamp(alpha_y, 1e-4f, 1e3f));
}

// Density of normals D(m), 1/sr (Heitz 2014, equation 85, rewritten without tangents, which would diverge); m is a unit
// vector.
FN float ggx_d(vec3 m, vec2 alpha) {
    float x = m.x / alpha.x;
    float y = m.y / alpha.y;
    float e = x * x + y * y + m.z * m.z;
    return 1.0f / (PI * alpha.x * alpha.y * e * e);
}

// Length of w stretched by alpha: Smith's Lambda(w) = (s(w) / |w.z| - 1) / 2. In terms of s, and with z = |w.z|,
//   G1(w) = 2 z / (z + s),   G2(wo, wi) = 2 zo zi / (so zi + si zo),
// so that the cosines cancel in the functions below, and nothing diverges at grazing angles.
FN float ggx_stretch(vec3 w, vec2 alpha) {
    float x = w.x * alpha.x;
    float y = w.y * alpha.y;
    return sqrt(x * x + y * y + w.z * w.z);
}

// G2(wo, wi) / (4 |cos_o cos_i|), dimensionless (Heitz 2014, equation 99).
FN float ggx_visibility(vec3 wo, vec3 wi, vec2 alpha) {
    float d = ggx_stretch(wo, alpha) * abs(wi.z) + ggx_stretch(wi, alpha) * abs(wo.z);
    return 0.5f / max(d, 1e-12f);
}

// The density of the normals visible from w is G1(w) D(m) |dot(w, m)| / |w.z|. This is G1(w) / |w.z|, for w.z >= 0.
FN float ggx_visible_scale(vec3 w, vec2 alpha) { return 2.0f / (w.z + ggx_stretch(w, alpha)); }
FN float ggx_visible_pdf(vec3 w, vec3 m, vec2 alpha) {
    return ggx_visible_scale(w, alpha) * ggx_d(m, alpha) * max(dot3(w, m), 0.0f);
}

// Samples a normal with density ggx_visible_pdf, for w.z > 0 (Dupuy and Benyoub 2023, "Sampling Visible GGX Normals
// with Spherical Caps"). Written in terms of h = 1 - z of the cap's point, which is accurate at grazing angles.
FN vec3 ggx_sample_visible(vec3 w, vec2 alpha, vec2 u) {
    vec3 s = unit(vec3(w.x * alpha.x, w.y * alpha.y, w.z));
    float h = u.x * (1.0f + s.z);
    float sine;
    float cosine;
    sin_cos(TWO_PI * u.y, sine, cosine);
    float r = safe_sqrt(h * (2.0f - h));
    // The cap's point plus s: its z is (1 - h) + s.z.
    vec3 m = vec3(r * cosine + s.x, r * sine + s.y, (1.0f - u.x) * (1.0f + s.z));
    return unit(vec3(m.x * alpha.x, m.y * alpha.y, max(m.z, 1e-7f)));
}

// 1 - E(mu, alpha): the fraction of energy that single scattering loses on a lossless surface, seen at cosine mu >= 0.
// A polynomial in alpha and t = mu / (mu + alpha), fitted for this project to numerical integrals of E over alpha in
// [0.001, 1]; its error is at most 0.0065.
FN float ggx_missing_energy(float mu, float alpha) {
    float a = clamp(alpha, 1e-3f, 1.0f);
    float t = mu / (mu + a);
    float c0 = (((0.63180f * t + 0.61094f) * t - 2.81930f) * t + 1.54266f) * t + 0.03597f;
    float c1 = (((9.29391f * t - 29.22836f) * t + 31.61132f) * t - 12.60540f) * t + 1.46749f;
    float c2 = (((32.89682f * t - 79.88595f) * t + 43.57527f) * t - 8.25547f) * t + 3.14203f;
    float c3 = (((93.71417f * t - 82.16355f) * t + 26.58709f) * t - 5.28901f) * t - 0.39540f;
    return clamp(t * (((c3 * a + c2) * a + c1) * a + c0), 0.0f, 0.9f);
}

// Factor that restores the energy of multiple scattering to a conductor of normal reflectance f0: 1 + f0 (1 - E) / E
// (Turquin 2019, "Practical multiple scattering compensation for microfacet models", equation 16).
FN Spectrum ggx_energy_compensation(Spectrum f0, float mu, vec2 alpha) {
    float missing = ggx_missing_energy(mu, sqrt(alpha.x * alpha.y));
    return Spectrum(1.0f) + f0 * (missing / (1.0f - missing));
}

#endif
