// Division and square root rounded as IEEE 754 requires, for devices that round otherwise: Vulkan allows errors of 2.5
// units in the last place, and GPUs make them. With `--set backend.exact=on` (docs/decisions/exact-arithmetic.md),
// backends/shaders/exact_arithmetic.cpp replaces every quotient and square root of a shader by calls to these functions;
// the C++ build does not need them. exact_arithmetic_test compiles this file as C++ and tests the hardest cases.
//
// The device's result is a guess, off by a few units. Significands are integers of 24 bits. The remainder of the guess
// is small, and therefore exact in 32 bits although higher bits are lost; it tells which integer is nearest. Neither a
// quotient nor a root is halfway between two. Denormals are zero, as on the CPU backend. There is no fused
// multiply-add, because Vulkan does not guarantee that fma is one operation (on lavapipe it is two).
#ifndef EXACT_GUESS
#define EXACT_GUESS(x) (x)
#endif

float exact_quotient(const float a, const float b) {
    uint a_bits = floatBitsToUint(a);
    uint b_bits = floatBitsToUint(b);
    int a_exponent = int((a_bits >> 23u) & 255u);
    int b_exponent = int((b_bits >> 23u) & 255u);
    // Zeros, infinities and NaNs.
    if (a_exponent == 0 || a_exponent == 255 || b_exponent == 0 || b_exponent == 255)
        return uintBitsToFloat(a_exponent == 0 ? a_bits & 0x80000000u : a_bits) /
               uintBitsToFloat(b_exponent == 0 ? b_bits & 0x80000000u : b_bits);
    uint n = (a_bits & 0x7fffffu) | 0x800000u;
    uint d = (b_bits & 0x7fffffu) | 0x800000u;
    uint less = uint(n < d);
    float inverse = EXACT_GUESS(1.0f / float(d));
    n <<= 23u + less;
    uint q = uint(float((a_bits & 0x7fffffu) | 0x800000u) * inverse * (less != 0u ? 16777216.0f : 8388608.0f));
    q += uint(int(floor(float(int(n - q * d)) * inverse + 0.5f)));
    int rest = int(n - q * d);
    q += uint(2 * rest > int(d)) - uint(2 * rest < -int(d));
    int exponent = a_exponent - b_exponent + 127 - int(less);
    uint sign = (a_bits ^ b_bits) & 0x80000000u;
    if (exponent <= 0) return uintBitsToFloat(sign);
    return uintBitsToFloat(sign | (exponent < 255 ? (uint(exponent) << 23u) | (q & 0x7fffffu) : 0x7f800000u));
}
float exact_root(const float x) {
    uint bits = floatBitsToUint(x);
    uint exponent = (bits >> 23u) & 255u;
    if (exponent == 0u) return uintBitsToFloat(bits & 0x80000000u);
    if (bits >= 0x7f800000u) return bits == 0x7f800000u ? x : uintBitsToFloat(0x7fc00000u);
    uint odd = ~exponent & 1u;  // 1 if the power of two is odd (the exponent's bias is odd, too)
    uint n = (bits & 0x7fffffu) | 0x800000u;
    float significand = float(n << odd);
    float inverse = EXACT_GUESS(inversesqrt(significand));
    n <<= 23u + odd;
    uint q = uint(significand * inverse * 2896.309375740099f);  // sqrt(2^23)
    q += uint(int(floor(float(int(n - q * q)) * inverse * 0.000172633491498701f + 0.5f)));  // 1 / (2 sqrt(2^23))
    int rest = int(n - q * q);
    q += uint(rest > int(q)) - uint(rest <= -int(q));
    return uintBitsToFloat((q & 0x7fffffu) | (((exponent - odd + 127u) >> 1u) << 23u));
}

vec2 exact_quotient(const vec2 a, const vec2 b) { return vec2(exact_quotient(a.x, b.x), exact_quotient(a.y, b.y)); }
vec3 exact_quotient(const vec3 a, const vec3 b) {
    return vec3(exact_quotient(a.x, b.x), exact_quotient(a.y, b.y), exact_quotient(a.z, b.z));
}
vec4 exact_quotient(const vec4 a, const vec4 b) {
    return vec4(exact_quotient(a.x, b.x), exact_quotient(a.y, b.y), exact_quotient(a.z, b.z), exact_quotient(a.w, b.w));
}

vec2 exact_root(const vec2 x) { return vec2(exact_root(x.x), exact_root(x.y)); }
vec3 exact_root(const vec3 x) { return vec3(exact_root(x.x), exact_root(x.y), exact_root(x.z)); }
vec4 exact_root(const vec4 x) {
    return vec4(exact_root(x.x), exact_root(x.y), exact_root(x.z), exact_root(x.w));
}
