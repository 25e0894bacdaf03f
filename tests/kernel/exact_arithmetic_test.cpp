// core/kernel/exact.glsl, compiled as C++: quotients and roots round like the processor's, whatever a device's first guess is.
#include <gtest/gtest.h>

#include "core/device/cpp_kernel.h"

#include <bit>
#include <cmath>
#include <random>

namespace lampyris::kernel {
namespace {

int guess_off_by = 0;  // units in the last place
float guess(float x) { return std::bit_cast<float>(std::bit_cast<uint32_t>(x) + uint32_t(guess_off_by)); }
float inversesqrt(float x) { return 1.0f / std::sqrt(x); }

#define EXACT_GUESS(x) guess(x)
#include "core/kernel/exact.glsl"

// Vulkan's reciprocal and inversesqrt are right to 2.5 and 2 units.
constexpr int kGuesses[] = {-4, -1, 0, 1, 4};

bool same(float a, float b) { return std::bit_cast<uint32_t>(a) == std::bit_cast<uint32_t>(b); }
float significand(uint32_t fraction) { return std::bit_cast<float>(0x3f800000u | fraction); }

uint64_t wrong_quotients(float a, float b) {
    uint64_t wrong = 0;
    for (guess_off_by = -4; guess_off_by <= 4; ++guess_off_by) wrong += !same(exact_quotient(a, b), a / b);
    return wrong;
}

// 2^-exponent modulo an odd number.
uint64_t inverse_power_of_two(int exponent, uint64_t odd) {
    uint64_t power = 1;
    for (int i = 0; i < exponent; ++i) power = power * ((odd + 1) / 2) % odd;
    return power;
}

// A quotient of 24-bit numbers A / B is hard to round where A 2^25 (or 2^24) lies within a few of an odd multiple of B: solved for A.
TEST(ExactArithmetic, QuotientsNearAMidpoint) {
    uint64_t tried = 0, wrong = 0;
    for (uint64_t b = (1u << 23) + 1; b < 1u << 24; b += 254) {
        for (const int shift : {24, 25}) {
            const uint64_t inverse = inverse_power_of_two(shift, b);
            for (int64_t rest = -3; rest <= 3; ++rest) {
                for (uint64_t a = uint64_t(rest + int64_t(b)) % b * inverse % b; a < 1u << 24; a += b) {
                    if (a < 1u << 23) continue;
                    ++tried;
                    wrong += wrong_quotients(float(a), float(b));
                }
            }
        }
    }
    EXPECT_GT(tried, 200'000u);
    EXPECT_EQ(wrong, 0u);
}

TEST(ExactArithmetic, QuotientsByTheLargestSignificand) {
    uint64_t wrong = 0;
    for (uint32_t i = 0; i < 1u << 23; i += 37) wrong += wrong_quotients(significand(i), significand(0x7fffff));
    wrong += wrong_quotients(1, significand(0x7fffff)) + wrong_quotients(1, significand(0x7ffffe));
    EXPECT_EQ(wrong, 0u);
}

TEST(ExactArithmetic, Roots) {
    uint64_t wrong = 0;
    for (const int off : kGuesses) {
        guess_off_by = off;
        for (uint32_t bits = 0x3f800000u; bits < 0x40800000u; bits += 13) {  // [1, 4)
            const float x = std::bit_cast<float>(bits);
            wrong += !same(exact_root(x), std::sqrt(x));
        }
    }
    EXPECT_EQ(wrong, 0u);
}

TEST(ExactArithmetic, VectorsComponentByComponent) {
    guess_off_by = 0;
    const vec4 a(1, 2, 3, 5), b(7, 11, 13, 17);
    EXPECT_EQ(exact_quotient(vec2(a), vec2(b)), vec2(a) / vec2(b));
    EXPECT_EQ(exact_quotient(vec3(a), vec3(b)), vec3(a) / vec3(b));
    EXPECT_EQ(exact_quotient(a, b), a / b);
    EXPECT_EQ(exact_root(vec2(a)), glm::sqrt(vec2(a)));
    EXPECT_EQ(exact_root(vec3(a)), glm::sqrt(vec3(a)));
    EXPECT_EQ(exact_root(a), glm::sqrt(a));
}

// Random bits; occasionally a zero or an infinity; no denormals, which both backends flush.
float any_number(std::mt19937& random) {
    const float x = std::bit_cast<float>(uint32_t(random()));
    if (random() % 32 == 0) return std::copysign(random() % 2 ? 0.0f : HUGE_VALF, x);
    return std::fpclassify(x) == FP_SUBNORMAL ? std::copysign(0.0f, x) : x;
}

bool same_or_nan(float a, float b) { return std::isnan(a) ? std::isnan(b) : same(a, b); }

// Results that overflow are infinite, and those that are too small to be normal are zero.
TEST(ExactArithmetic, AnyNumbers) {
    guess_off_by = 0;
    std::mt19937 random(7);
    uint64_t underflows = 0;
    for (int i = 0; i < 2'000'000; ++i) {
        const float a = any_number(random), b = any_number(random);
        float quotient = a / b;
        if (quotient != 0 && std::abs(quotient) <= 0x1p-126f) {
            // Rounded to 24 bits as if there were no smallest exponent; x86 then flushes tiny results.
            const bool is_tiny = float(std::abs(double(a)) * 0x1p64 / std::abs(double(b))) < 0x1p-62f;
            quotient = std::copysign(is_tiny ? 0.0f : 0x1p-126f, quotient);
            ++underflows;
        }
        ASSERT_TRUE(same_or_nan(exact_quotient(a, b), quotient)) << std::hexfloat << a << " / " << b;
        ASSERT_TRUE(same_or_nan(exact_root(a), std::sqrt(a))) << std::hexfloat << a;
    }
    EXPECT_GT(underflows, 1000u);
    EXPECT_TRUE(same(exact_quotient(4.0f, 0x1p-149f), HUGE_VALF)) << "a denormal is zero";
    EXPECT_TRUE(same(exact_root(-0x1p-149f), -0.0f));
}

}  // namespace
}  // namespace lampyris::kernel
