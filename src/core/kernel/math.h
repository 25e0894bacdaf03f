// Arithmetic that gives the same bits on every backend: only + - * / and sqrt, no built-in transcendental functions.
//
// Polynomials of sin, cos, exp, log and atan are those of Cephes' single-precision library (S. Moshier, 1984-1992);
// their errors are a few units in the last place over the ranges stated.
#ifndef LAMPYRIS_KERNEL_MATH
#define LAMPYRIS_KERNEL_MATH

CONST float PI = 3.14159265358979f;
CONST float TWO_PI = 6.28318530717959f;
CONST float INV_PI = 0.318309886183791f;
CONST float INV_TWO_PI = 0.159154943091895f;
CONST float INV_FOUR_PI = 0.0795774715459477f;
CONST float PI_OVER_2 = 1.57079632679490f;
CONST float PI_OVER_4 = 0.785398163397448f;
CONST float MACHINE_EPSILON = 5.9604645e-8f;  // half a unit in the last place of 1
CONST float ONE_MINUS_EPSILON = 0.99999994f;

FN float sqr(float x) { return x * x; }
FN float safe_sqrt(float x) { return sqrt(max(x, 0.0f)); }
FN float lerp_of(float t, float a, float b) { return (1.0f - t) * a + t * b; }
FN vec3 lerp3_of(float t, vec3 a, vec3 b) { return (1.0f - t) * a + t * b; }
FN float copy_sign(float magnitude, float sign_of) {
    return uintBitsToFloat((floatBitsToUint(magnitude) & 0x7fffffffu) | (floatBitsToUint(sign_of) & 0x80000000u));
}
// Swaps a and b if `swapped` is true, without a branch: which of two random numbers is larger is unpredictable.
FN void swap_if(bool swapped, INOUT(float) a, INOUT(float) b) {
    uint difference = (floatBitsToUint(a) ^ floatBitsToUint(b)) & (0u - uint(swapped));
    a = uintBitsToFloat(floatBitsToUint(a) ^ difference);
    b = uintBitsToFloat(floatBitsToUint(b) ^ difference);
}
FN float max_component(vec3 v) { return max(v.x, max(v.y, v.z)); }
FN float min_component(vec3 v) { return min(v.x, min(v.y, v.z)); }
FN float dot3(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
FN float length_squared(vec3 v) { return v.x * v.x + v.y * v.y + v.z * v.z; }
FN float length_of(vec3 v) { return sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }
FN float distance_of(vec3 a, vec3 b) { return length_of(a - b); }
// Unit vector; v must not be zero.
FN vec3 unit(vec3 v) { return v * (1.0f / sqrt(v.x * v.x + v.y * v.y + v.z * v.z)); }
FN float abs_dot(vec3 a, vec3 b) { return abs(dot3(a, b)); }
FN vec3 cross3(vec3 a, vec3 b) { return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x); }
// v or -v, whichever is on the side of n.
FN vec3 face_forward(vec3 v, vec3 n) { return dot3(v, n) < 0.0f ? -v : v; }
FN float luminance(vec3 rgb) { return 0.2126f * rgb.x + 0.7152f * rgb.y + 0.0722f * rgb.z; }  // Rec. 709
FN bool is_finite(float x) { return (floatBitsToUint(x) & 0x7f800000u) != 0x7f800000u; }
FN bool is_finite3(vec3 v) { return is_finite(v.x) && is_finite(v.y) && is_finite(v.z); }
// Bound of the relative error of n operations (Higham 2002, section 3.1).
FN float gamma_bound(float n) { return (n * MACHINE_EPSILON) / (1.0f - n * MACHINE_EPSILON); }

// sin and cos for |x| up to pi/4; absolute error below 1e-7.
FN void sin_cos_of_octant(float x, OUT(float) s, OUT(float) c) {
    float z = x * x;
    s = ((-1.9515295891e-4f * z + 8.3321608736e-3f) * z - 1.6666654611e-1f) * z * x + x;
    c = ((2.443315711809948e-5f * z - 1.388731625493765e-3f) * z + 4.166664568298827e-2f) * z * z - 0.5f * z + 1.0f;
}

// The same for |x| up to a few thousand.
FN void sin_cos(float x, OUT(float) s, OUT(float) c) {
    int n = int(x * 0.636619772367581f + copy_sign(0.5f, x));  // rounds to nearest; floor is slow without SSE 4.1
    float q = float(n);
    float y = ((x - q * 1.5703125f) - q * 4.837512969970703125e-4f) - q * 7.549789954891882e-8f;
    float sine;
    float cosine;
    sin_cos_of_octant(y, sine, cosine);
    int quadrant = n & 3;
    float a = (quadrant & 1) != 0 ? cosine : sine;
    float b = (quadrant & 1) != 0 ? sine : cosine;
    s = (quadrant & 2) != 0 ? -a : a;
    c = (quadrant == 1 || quadrant == 2) ? -b : b;
}

FN float sin_of(float x) {
    float s;
    float c;
    sin_cos(x, s, c);
    return s;
}

FN float cos_of(float x) {
    float s;
    float c;
    sin_cos(x, s, c);
    return c;
}

FN float atan_of(float x) {
    float a = abs(x);
    float base = 0.0f;
    float y = a;
    if (a > 2.414213562373095f) {
        base = PI_OVER_2;
        y = -1.0f / a;
    } else if (a > 0.4142135623730950f) {
        base = PI_OVER_4;
        y = (a - 1.0f) / (a + 1.0f);
    }
    float z = y * y;
    float value =
        base +
        ((((8.05374449538e-2f * z - 1.38776856032e-1f) * z + 1.99777106478e-1f) * z - 3.33329491539e-1f) * z * y + y);
    return x < 0.0f ? -value : value;
}

// Angle of (x, y) in [-pi, pi]; 0 at the origin.
FN float atan2_of(float y, float x) {
    float ax = abs(x);
    float ay = abs(y);
    if (ax == 0.0f && ay == 0.0f) return 0.0f;
    float angle = ay > ax ? PI_OVER_2 - atan_of(ax / ay) : atan_of(ay / ax);
    if (x < 0.0f) angle = PI - angle;
    return y < 0.0f ? -angle : angle;
}

FN float acos_of(float x) {
    float y = clamp(x, -1.0f, 1.0f);
    return atan2_of(sqrt((1.0f - y) * (1.0f + y)), y);
}

FN float asin_of(float x) {
    float y = clamp(x, -1.0f, 1.0f);
    return atan2_of(y, sqrt((1.0f - y) * (1.0f + y)));
}

// exp; 0 below -87, the largest float above 88.
FN float exp_of(float x) {
    if (x < -87.0f) return 0.0f;
    if (x > 88.0f) return 3.4028234e38f;
    float n = floor(x * 1.44269504088896341f + 0.5f);
    float y = (x - n * 0.693359375f) + n * 2.12194440e-4f;
    float z = y * y;
    float p = ((((1.9875691500e-4f * y + 1.3981999507e-3f) * y + 8.3334519073e-3f) * y + 4.1665795894e-2f) * y +
               1.6666665459e-1f) *
                  y +
              5.0000001201e-1f;
    float value = p * z + y + 1.0f;
    // 2^n in two halves, each a normal float.
    int k = int(n);
    int h = k / 2;
    return value * intBitsToFloat((h + 127) << 23) * intBitsToFloat((k - h + 127) << 23);
}

// Natural logarithm of a normal positive float; -88 at and below the smallest one.
FN float log_of(float x) {
    if (!(x >= 1.17549435e-38f)) return -88.0f;
    uint bits = floatBitsToUint(x);
    float e = float(int(bits >> 23) - 126);
    float m = uintBitsToFloat((bits & 0x007fffffu) | 0x3f000000u);  // in [0.5, 1)
    if (m < 0.707106781186547524f) {
        e = e - 1.0f;
        m = m + m - 1.0f;
    } else {
        m = m - 1.0f;
    }
    float z = m * m;
    float p = (((7.0376836292e-2f * m - 1.1514610310e-1f) * m + 1.1676998740e-1f) * m - 1.2420140846e-1f) * m +
              1.4249322787e-1f;
    p = (((p * m - 1.6668057665e-1f) * m + 2.0000714765e-1f) * m - 2.4999993993e-1f) * m + 3.3333331174e-1f;
    float y = m * z * p - e * 2.12194440e-4f - 0.5f * z;
    return (m + y) + e * 0.693359375f;
}

// x^y for x >= 0.
FN float pow_of(float x, float y) { return x <= 0.0f ? 0.0f : exp_of(y * log_of(x)); }

// ---- Frames and transforms -------------------------------------------------------------------------------------------

struct Frame {
    vec3 x;
    vec3 y;
    vec3 z;
};

// Orthonormal frame with the given unit z (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
FN Frame frame_from_z(vec3 z) {
    float s = copy_sign(1.0f, z.z);
    float a = -1.0f / (s + z.z);
    float b = z.x * z.y * a;
    Frame frame;
    frame.x = vec3(1.0f + s * z.x * z.x * a, s * b, -s * z.x);
    frame.y = vec3(b, s + z.y * z.y * a, -z.y);
    frame.z = z;
    return frame;
}

// Frame with unit z whose x is the part of `x` orthogonal to z; an arbitrary x if they are parallel.
FN Frame frame_from_xz(vec3 x, vec3 z) {
    vec3 t = x - z * dot3(x, z);
    float l2 = length_squared(t);
    if (!(l2 > 1e-12f * length_squared(x)) || !(l2 > 1e-30f)) return frame_from_z(z);
    Frame frame;
    frame.x = t / sqrt(l2);
    frame.y = cross3(z, frame.x);
    frame.z = z;
    return frame;
}

FN vec3 to_local(IN(Frame) f, vec3 v) { return vec3(dot3(v, f.x), dot3(v, f.y), dot3(v, f.z)); }
FN vec3 to_world(IN(Frame) f, vec3 v) { return f.x * v.x + f.y * v.y + f.z * v.z; }

FN vec3 transform_point(vec4 r0, vec4 r1, vec4 r2, vec3 p) {
    return vec3(r0.x * p.x + r0.y * p.y + r0.z * p.z + r0.w, r1.x * p.x + r1.y * p.y + r1.z * p.z + r1.w,
                r2.x * p.x + r2.y * p.y + r2.z * p.z + r2.w);
}
FN vec3 transform_vector(vec4 r0, vec4 r1, vec4 r2, vec3 v) {
    return vec3(r0.x * v.x + r0.y * v.y + r0.z * v.z, r1.x * v.x + r1.y * v.y + r1.z * v.z,
                r2.x * v.x + r2.y * v.y + r2.z * v.z);
}
// Transforms a normal, given the rows of the transform's *inverse*: multiplies by the inverse's transpose. The result
// is not of unit length.
FN vec3 transform_normal(vec4 i0, vec4 i1, vec4 i2, vec3 n) {
    return vec3(i0.x * n.x + i1.x * n.y + i2.x * n.z, i0.y * n.x + i1.y * n.y + i2.y * n.z,
                i0.z * n.x + i1.z * n.y + i2.z * n.z);
}
// Bound of the error of transform_point for p with error e (pbrt, 4th edition, section 6.8.6).
FN vec3 transform_error(vec4 r0, vec4 r1, vec4 r2, vec3 p, vec3 e) {
    float g = gamma_bound(3.0f);
    vec3 a = abs(p);
    vec3 from_rounding = vec3(abs(r0.x) * a.x + abs(r0.y) * a.y + abs(r0.z) * a.z + abs(r0.w),
                              abs(r1.x) * a.x + abs(r1.y) * a.y + abs(r1.z) * a.z + abs(r1.w),
                              abs(r2.x) * a.x + abs(r2.y) * a.y + abs(r2.z) * a.z + abs(r2.w));
    vec3 carried =
        vec3(abs(r0.x) * e.x + abs(r0.y) * e.y + abs(r0.z) * e.z, abs(r1.x) * e.x + abs(r1.y) * e.y + abs(r1.z) * e.z,
             abs(r2.x) * e.x + abs(r2.y) * e.y + abs(r2.z) * e.z);
    return (g + 1.0f) * carried + g * from_rounding;
}

// Offset along the normal ng that leads out of p's error box (pbrt, 4th edition, section 6.8.6). It is longer than the
// box requires, by four times the rounding error of its sum with p. It depends on the float error at the hit, not on a
// scene-wide epsilon.
FN vec3 way_out(vec3 p, vec3 error, vec3 ng) { return dot3(abs(ng), error + (4.0f * MACHINE_EPSILON) * abs(p)) * ng; }

// The origin of a ray from p in `direction`: on the direction's side of the surface. `way` is from way_out.
FN vec3 origin_beyond(vec3 p, vec3 way, vec3 direction) { return p + copy_sign(1.0f, dot3(direction, way)) * way; }
FN vec3 offset_origin(vec3 p, vec3 error, vec3 ng, vec3 direction) {
    return origin_beyond(p, way_out(p, error, ng), direction);
}

// ---- Equal-area octahedral map (Clarberg 2008), as pbrt-v4's environment images use it: the pole is +z ------------------

FN vec3 direction_from_square(vec2 p) {
    float u = 2.0f * p.x - 1.0f;
    float v = 2.0f * p.y - 1.0f;
    float up = abs(u);
    float vp = abs(v);
    float signed_distance = 1.0f - (up + vp);
    float r = 1.0f - abs(signed_distance);
    float phi = (r == 0.0f ? 1.0f : (vp - up) / r + 1.0f) * PI_OVER_4;
    float s;
    float c;
    sin_cos(phi, s, c);
    float radius = r * safe_sqrt(2.0f - r * r);
    return vec3(copy_sign(c, u) * radius, copy_sign(s, v) * radius, copy_sign(1.0f - r * r, signed_distance));
}

FN vec2 square_from_direction(vec3 d) {
    float x = abs(d.x);
    float y = abs(d.y);
    float r = safe_sqrt(1.0f - abs(d.z));
    float a = max(x, y);
    float b = a == 0.0f ? 0.0f : min(x, y) / a;
    float phi = atan_of(b) * 0.636619772367581f;
    if (x < y) phi = 1.0f - phi;
    float v = phi * r;
    float u = r - v;
    if (d.z < 0.0f) {
        float t = u;
        u = 1.0f - v;
        v = 1.0f - t;
    }
    return vec2((copy_sign(u, d.x) + 1.0f) * 0.5f, (copy_sign(v, d.y) + 1.0f) * 0.5f);
}

#endif
