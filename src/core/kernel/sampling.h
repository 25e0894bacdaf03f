// Maps from the unit square to the domains that light transport samples, each with its density.
//
// Densities of directions are per solid angle (1/sr), of points on a unit disk or triangle per area, of numbers per unit.
#ifndef LAMPYRIS_KERNEL_SAMPLING
#define LAMPYRIS_KERNEL_SAMPLING

// ---- Multiple importance sampling (Veach 1997, section 9.2), one sample of each technique -------------------------------

FN float balance_heuristic(float a, float b) { return a > 0.0f ? a / (a + b) : 0.0f; }

// Power heuristic with exponent 2, as a ratio, so that large densities do not overflow.
FN float power_heuristic(float a, float b) {
    if (!(a > 0.0f)) return 0.0f;
    float r = b / a;
    return 1.0f / (1.0f + r * r);
}

// power_heuristic(a, b) / a.
FN float power_heuristic_over_pdf(float a, float b) { return 1.0f / (a + b * (b / a)); }

// ---- Numbers ---------------------------------------------------------------------------------------------------------

// x in [0, 1) with density proportional to (1 - x) a + x b; a, b >= 0, not both zero.
FN float sample_linear(float u, float a, float b) {
    if (u == 0.0f && a == 0.0f) return 0.0f;
    // The stable root of the quadratic CDF.
    float x = u * (a + b) / (a + safe_sqrt((1.0f - u) * a * a + u * b * b));
    return min(x, ONE_MINUS_EPSILON);
}
FN float pdf_linear(float x, float a, float b) {
    if (x < 0.0f || x > 1.0f) return 0.0f;
    return 2.0f * ((1.0f - x) * a + x * b) / (a + b);
}

// Point of the unit square with the bilinear density of the four corner weights w = (w00, w10, w01, w11).
FN vec2 sample_bilinear(vec2 u, vec4 w) {
    float y = sample_linear(u.y, w.x + w.y, w.z + w.w);
    float x = sample_linear(u.x, (1.0f - y) * w.x + y * w.z, (1.0f - y) * w.y + y * w.w);
    return vec2(x, y);
}
FN float pdf_bilinear(vec2 p, vec4 w) {
    if (p.x < 0.0f || p.x > 1.0f || p.y < 0.0f || p.y > 1.0f) return 0.0f;
    float sum = w.x + w.y + w.z + w.w;
    if (sum == 0.0f) return 1.0f;
    float low = (1.0f - p.x) * w.x + p.x * w.y;
    float high = (1.0f - p.x) * w.z + p.x * w.w;
    return 4.0f * ((1.0f - p.y) * low + p.y * high) / sum;
}

// x in (-r, r) with density proportional to r - |x|.
FN float sample_tent(float u, float r) {
    if (u < 0.5f) return r * (sqrt(2.0f * u) - 1.0f);
    return r * (1.0f - sqrt(2.0f * (1.0f - u)));
}
FN float pdf_tent(float x, float r) { return abs(x) >= r ? 0.0f : (1.0f - abs(x) / r) / r; }

// x >= 0 with density a exp(-a x).
FN float sample_exponential(float u, float a) { return -log_of(1.0f - u) / a; }
FN float pdf_exponential(float x, float a) { return a * exp_of(-a * x); }

// ---- Disk and triangle -----------------------------------------------------------------------------------------------

// Uniform on the unit disk; maps concentric squares to concentric circles (Shirley and Chiu 1997).
FN vec2 sample_concentric_disk(vec2 u) {
    float x = 2.0f * u.x - 1.0f;
    float y = 2.0f * u.y - 1.0f;
    bool high = abs(y) >= abs(x);
    swap_if(high, x, y);
    if (x == 0.0f) return vec2(0.0f, 0.0f);
    float s;
    float c;
    sin_cos_of_octant(PI_OVER_4 * (y / x), s, c);
    s = x * s;
    c = x * c;
    swap_if(high, c, s);
    return vec2(c, s);
}
FN float pdf_concentric_disk() { return INV_PI; }

// Uniform barycentric coordinates (b0, b1, b2) with little distortion (Heitz 2019, "A Low-Distortion Map Between
// Triangle and Square"). Density 1 / area of the triangle.
FN vec3 sample_uniform_triangle(vec2 u) {
    // Subtracts half of the smaller number from both; halving is exact.
    float half_of_smaller = 0.5f * min(u.x, u.y);
    float b0 = u.x - half_of_smaller;
    float b1 = u.y - half_of_smaller;
    return vec3(b0, b1, max(0.0f, 1.0f - b0 - b1));
}

// ---- Directions ------------------------------------------------------------------------------------------------------

// Around +z, with density proportional to the cosine (Malley's method).
FN vec3 sample_cosine_hemisphere(vec2 u) {
    vec2 d = sample_concentric_disk(u);
    return vec3(d.x, d.y, safe_sqrt(1.0f - d.x * d.x - d.y * d.y));
}
FN float pdf_cosine_hemisphere(float cos_theta) { return max(cos_theta, 0.0f) * INV_PI; }

FN vec3 spherical_direction(float sin_theta, float cos_theta, float phi) {
    float s;
    float c;
    sin_cos(phi, s, c);
    return vec3(sin_theta * c, sin_theta * s, cos_theta);
}

FN vec3 sample_uniform_hemisphere(vec2 u) {
    return spherical_direction(safe_sqrt(1.0f - u.x * u.x), u.x, TWO_PI * u.y);
}
FN float pdf_uniform_hemisphere() { return INV_TWO_PI; }

FN vec3 sample_uniform_sphere(vec2 u) {
    // z = 1 - 2u, and 1 - z^2 = 4u(1 - u) without cancellation at the poles.
    return spherical_direction(2.0f * safe_sqrt(u.x * (1.0f - u.x)), 1.0f - 2.0f * u.x, TWO_PI * u.y);
}
FN float pdf_uniform_sphere() { return INV_FOUR_PI; }

// Uniform in the cone around +z with the given 1 - cos(half angle), which keeps its precision for small cones.
FN vec3 sample_uniform_cone(vec2 u, float one_minus_cos_max) {
    float h = u.x * one_minus_cos_max;
    return spherical_direction(safe_sqrt(h * (2.0f - h)), 1.0f - h, TWO_PI * u.y);
}
FN float pdf_uniform_cone(float one_minus_cos_max) { return INV_TWO_PI / one_minus_cos_max; }

// ---- Henyey and Greenstein's phase function (1941), for |g| <= 0.99 ----------------------------------------------------

// Directions point away from the scattering event, so that `cos_theta` = dot(wo, wi) is -1 straight ahead. The value
// (1/sr) is also the density of sample_henyey_greenstein.
FN float henyey_greenstein(float cos_theta, float g) {
    float d = 1.0f + g * g + 2.0f * g * cos_theta;
    return INV_FOUR_PI * (1.0f - g * g) / (d * safe_sqrt(d));
}

FN vec3 sample_henyey_greenstein(vec3 wo, float g, vec2 u) {
    float cos_theta = 2.0f * u.x - 1.0f;
    if (abs(g) >= 1e-3f) {
        float q = (1.0f - g * g) / (1.0f + g - 2.0f * g * u.x);
        cos_theta = clamp((q * q - 1.0f - g * g) / (2.0f * g), -1.0f, 1.0f);
    }
    vec3 local = spherical_direction(safe_sqrt((1.0f - cos_theta) * (1.0f + cos_theta)), cos_theta, TWO_PI * u.y);
    return to_world(frame_from_z(wo), local);
}

#endif
