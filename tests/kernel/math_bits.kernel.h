// For math_bits_test: every function of math.h, so that backends can be compared to the bit.
#include "core/kernel/prelude.h"
#include "core/kernel/math.h"

BUFFER_RO(0, vec4, inputs)
BUFFER_RO(1, uvec4, choices)
BUFFER_RW(2, vec4, results)

KERNEL(math_bits) {
    vec4 p = inputs[index];
    vec3 v = vec3(p);
    uint which = choices[0].x;
    vec4 r = vec4(0.0f);
    if (which == 0u) {
        r = vec4(p.x + p.y, p.x - p.y, p.x * p.y, p.x / p.y);
    } else if (which == 1u) {
        r = vec4(sqrt(abs(p.x)), floor(p.y), min(p.x, p.y), max(p.z, p.w));
    } else if (which == 2u) {
        float s;
        float c;
        sin_cos(p.x, s, c);
        r = vec4(s, c, atan_of(p.y), atan2_of(p.z, p.w));
    } else if (which == 3u) {
        r = vec4(exp_of(p.x), log_of(abs(p.y)), pow_of(abs(p.z), p.w), acos_of(p.x));
    } else if (which == 4u) {
        r = vec4(unit(v), length_of(v));
    } else if (which == 5u) {
        r = vec4(cross3(v, vec3(p.w, p.x, p.y)), dot3(v, vec3(p.w, p.z, p.y)));
    } else if (which == 6u) {
        r = vec4(lerp3_of(p.w, v, vec3(p.w, p.x, p.y)), lerp_of(p.x, p.y, p.z));
    } else if (which == 7u) {
        Frame f = frame_from_z(unit(v));
        r = vec4(to_world(f, vec3(p.y, p.z, p.w)), f.x.y);
    } else if (which == 8u) {
        r = vec4(offset_origin(v, abs(v) * 1e-6f, unit(v), vec3(p.w, p.x, p.y)), gamma_bound(3.0f));
    } else if (which == 9u) {
        vec2 square = square_from_direction(dot3(v, v) > 0.0f ? unit(v) : vec3(0.0f, 0.0f, 1.0f));
        r = vec4(direction_from_square(square), square.x + square.y * 2.0f);
    } else if (which == 10u) {
        r = vec4(p.x * p.y + p.z, (p.x + p.y) + p.z - p.x, p.x * (1.0f / 3.0f), p.x / 3.0f);
    } else if (which == 11u) {
        r = vec4(1.0f / p.x, p.x / sqrt(abs(p.y)), p.z * 2.0f / 2.0f, (p.w - p.w) + p.x);
    } else {
        r = vec4(luminance(v), TWO_PI * p.x * INV_PI, PI * PI * p.y, float(int(clamp(p.z, -1e6f, 1e6f))));
    }
    results[index] = r;
}
