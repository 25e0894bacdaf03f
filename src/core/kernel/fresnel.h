// Fresnel's equations and refraction, for unpolarised light.
//
// `eta` is the refractive index below the surface over that on the incident side; `cos_i` the cosine of incidence, in
// [0, 1].
#ifndef LAMPYRIS_KERNEL_FRESNEL
#define LAMPYRIS_KERNEL_FRESNEL

// Squared cosine of the refracted direction; not positive for total internal reflection. Written so that nothing
// cancels for eta near 1 or at grazing incidence: eta^2 cos_t^2 = (eta^2 - 1) + cos_i^2.
FN float refracted_cosine_squared(float cos_i, float eta) {
    return ((eta - 1.0f) * (eta + 1.0f) + cos_i * cos_i) / (eta * eta);
}

// Fraction of the power that a dielectric reflects, from the cosines on both sides, which must not both be 0 (pbrt, 4th
// edition, equation 9.6).
FN float fresnel_of_cosines(float cos_i, float cos_t, float eta) {
    float parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    float perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

// The same from the cosine of incidence; 1 for total internal reflection.
FN float fresnel_dielectric(float cos_i, float eta) {
    float c = clamp(cos_i, 0.0f, 1.0f);
    float cos2_t = refracted_cosine_squared(c, eta);
    return cos2_t > 0.0f ? fresnel_of_cosines(c, sqrt(cos2_t), eta) : 1.0f;
}

// Fraction of the power that a conductor of refractive index n + ik reflects, for one channel (Born and Wolf, section
// 14.2, with the effective index a + ib inside: a^2 - b^2 = n^2 - k^2 - sin^2, a b = n k).
FN float fresnel_conductor1(float cos_i, float n, float k) {
    float c = clamp(cos_i, 0.0f, 1.0f);
    float cos2 = c * c;
    float sin2 = (1.0f - c) * (1.0f + c);
    float k2 = k * k;
    float difference = (n - 1.0f) * (n + 1.0f) + cos2 - k2;  // n^2 - k^2 - sin^2 without cancellation

    float product = 2.0f * n * k;
    float sum = sqrt(difference * difference + product * product);  // a^2 + b^2
    // (sum + difference) / 2, expanded by its conjugate if the two would cancel.
    float a2 = difference >= 0.0f ? 0.5f * (sum + difference) : 0.5f * product * product / (sum - difference);
    float a = sqrt(a2);
    float t1 = sum + cos2;
    float t2 = 2.0f * c * a;
    if (!(t1 + t2 > 0.0f)) return 1.0f;
    float rs = (t1 - t2) / (t1 + t2);
    float t3 = cos2 * sum + sin2 * sin2;
    float t4 = t2 * sin2;
    float rp = t3 + t4 > 0.0f ? rs * ((t3 - t4) / (t3 + t4)) : rs;
    return clamp(0.5f * (rs + rp), 0.0f, 1.0f);
}

FN Spectrum fresnel_conductor(float cos_i, Spectrum n, Spectrum k) {
#define REFLECTED(i) fresnel_conductor1(cos_i, n[i], k[i])
    return SPECTRUM_EACH(REFLECTED);
#undef REFLECTED
}

// Direction of w (pointing away from the surface, dot(w, n) = cos_i > 0) after refraction through the surface with
// normal n; false for total internal reflection.
FN bool refract_direction(vec3 w, vec3 n, float cos_i, float eta, OUT(vec3) refracted) {
    refracted = vec3(0.0f, 0.0f, -1.0f);
    float cos2_t = refracted_cosine_squared(cos_i, eta);
    if (!(cos2_t > 0.0f)) return false;
    refracted = unit((cos_i / eta - sqrt(cos2_t)) * n - w / eta);
    return true;
}

// Reflectance of a pane, including all internal reflections, from that of one interface: R' = R + T^2 R / (1 - R^2)
// (pbrt, 4th edition, section 9.5.1).
FN float pane_reflectance(float r) { return r < 1.0f ? 2.0f * r / (1.0f + r) : 1.0f; }

#endif
