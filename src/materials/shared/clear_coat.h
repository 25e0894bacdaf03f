// The coated diffuse material without a random walk, if the walk's sum has a closed form: for a smooth coat with only
// absorption between coat and base. Of the light that the diffuse base scatters up, the coat's inner side reflects back
// the fraction
//   A = 2 int_0^1 F(mu) T(mu)^2 mu dmu,   T(mu) = exp(-thickness / mu),
// independently of earlier events. So the walk's events at the base are a geometric series:
//   f = (rho / pi) t(wo) t(wi) / eta^2 * sum_{k < K} (rho A)^k,   t(w) = (1 - F(w)) T(w inside),
// where K is the number of times that the walk reaches the base within max_depth. The value is the walk's expectation,
// without its noise.
#ifndef LAMPYRIS_MATERIALS_CLEAR_COAT
#define LAMPYRIS_MATERIALS_CLEAR_COAT

#include "materials/diffuse/diffuse_bsdf.h"

FN bool clear_coat_applies(IN(Bsdf) b) { return ggx_is_smooth(b.alpha) && is_black(b.albedo) && b.eta > 1.0001f; }

// The integrand of A for total reflection.
FN float clear_coat_total_term(float mu, float thickness) {
    return 2.0f * mu * exp_of(-min(2.0f * thickness / mu, 100.0f));
}

// The integrand of A otherwise, for integration over the cosine outside: eta^2 mu dmu = mu_o dmu_o.
FN float clear_coat_partial_term(float mu_o, float eta, float thickness) {
    float mu = sqrt(refracted_cosine_squared(mu_o, eta));
    return 2.0f * mu_o / (eta * eta) * fresnel_of_cosines(mu_o, mu, eta) * exp_of(-min(2.0f * thickness / mu, 100.0f));
}

// A for eta > 1, by Gauss-Legendre rules of 6 and 5 points on the two sides of the critical angle; the error is below
// 3e-4.
RARE_FN float clear_coat_inner_reflectance(float eta, float thickness) {
    float critical = sqrt((eta - 1.0f) * (eta + 1.0f)) / eta;
    float sum = 0.0f;
    sum += 0.0856622462f * clear_coat_total_term(0.0337652429f * critical, thickness) * critical;
    sum += 0.180380787f * clear_coat_total_term(0.169395307f * critical, thickness) * critical;
    sum += 0.233956967f * clear_coat_total_term(0.380690407f * critical, thickness) * critical;
    sum += 0.233956967f * clear_coat_total_term(0.619309593f * critical, thickness) * critical;
    sum += 0.180380787f * clear_coat_total_term(0.830604693f * critical, thickness) * critical;
    sum += 0.0856622462f * clear_coat_total_term(0.966234757f * critical, thickness) * critical;
    sum += 0.118463443f * clear_coat_partial_term(0.046910077f, eta, thickness);
    sum += 0.239314335f * clear_coat_partial_term(0.230765345f, eta, thickness);
    sum += 0.284444444f * clear_coat_partial_term(0.5f, eta, thickness);
    sum += 0.239314335f * clear_coat_partial_term(0.769234655f, eta, thickness);
    sum += 0.118463443f * clear_coat_partial_term(0.953089923f, eta, thickness);
    return sum;
}

// x^0 + ... + x^(count - 1) for 0 <= x <= 1.
FN float geometric_sum(float x, uint count) {
    if (count == 0u || x > 0.99999f) return float(count);
    return (1.0f - pow_of(x, float(count))) / (1.0f - x);
}

// Fraction of the light along w that crosses the coat's surface and its medium once.
FN float clear_coat_transmission(IN(Bsdf) b, float cos_theta) {
    float mu = sqrt(refracted_cosine_squared(cos_theta, b.eta));
    return (1.0f - fresnel_of_cosines(cos_theta, mu, b.eta)) * exp_of(-min(b.thickness / mu, 100.0f));
}

FN Spectrum clear_coat_value(IN(Bsdf) b, float cos_o, float cos_i) {
    uint count = (b.max_depth + 1u) / 2u;
    Spectrum x = b.color0 * b.inner;
#define SERIES(i) geometric_sum(x[i], count)
    Spectrum series = SPECTRUM_EACH(SERIES);
#undef SERIES
    float t = clear_coat_transmission(b, cos_o) * clear_coat_transmission(b, cos_i);
    return b.color0 * series * (t * INV_PI / (b.eta * b.eta));
}

FN Spectrum clear_coat_eval(IN(Bsdf) b, vec3 wo, vec3 wi, OUT(float) pdf) {
    pdf = 0.0f;
    if (!same_hemisphere(wo, wi)) return Spectrum(0.0f);
    pdf = (1.0f - fresnel_dielectric(abs(wo.z), b.eta)) * pdf_cosine_hemisphere(abs(wi.z));
    return clear_coat_value(b, abs(wo.z), abs(wi.z));
}

// Samples the coat's reflection, or the base with a cosine density; the densities are exact here.
FN bool clear_coat_sample(IN(Bsdf) b, vec3 wo, float uc, vec2 u, INOUT(BsdfSample) s) {
    float c = abs(wo.z);
    float r = fresnel_dielectric(c, b.eta);
    if (uc < r) {
        s.wi = vec3(-wo.x, -wo.y, wo.z);
        s.f = Spectrum(r / c);
        s.pdf = r;
        s.lobe = LOBE_REFLECTION | LOBE_SPECULAR;
        return true;
    }
    if (!diffuse_lobe_sample(b.color0, wo, u, s)) return false;
    s.f = clear_coat_value(b, c, abs(s.wi.z));
    s.pdf *= 1.0f - r;
    return true;
}

#endif
