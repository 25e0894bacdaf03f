// Spectrum for C++: what light carries, and what surfaces and media leave of it, at several wavelengths at once.
#pragma once

namespace lampyris::kernel {

// N values. They can be added, scaled, and multiplied one by one, as light is. A position or a direction is a vec3, and neither
// converts to the other: GLSL, where Spectrum is a name for vec3, checks nothing, but all kernels are C++, too.
// core/kernel/spectrum.h has the functions.
template <int N>
struct SpectrumOf {
    static_assert(N == 3 || N == 4);

    SpectrumOf() = default;  // indeterminate, as in GLSL
    explicit constexpr SpectrumOf(float every) {
        for (float& value : values) value = every;
    }
    constexpr SpectrumOf(float first, float second, float third) requires(N == 3) : values{first, second, third} {}
    constexpr SpectrumOf(float first, float second, float third, float fourth) requires(N == 4)
        : values{first, second, third, fourth} {}

    constexpr float& operator[](int i) { return values[i]; }
    constexpr float operator[](int i) const { return values[i]; }

    float values[N];

 private:
    // Spelled out, since a loop over three values is not always unrolled.
    template <typename F>
    [[gnu::always_inline]] static constexpr SpectrumOf each(F value) {
        if constexpr (N == 3)
            return {value(0), value(1), value(2)};
        else
            return {value(0), value(1), value(2), value(3)};
    }
#define LAMPYRIS_SPECTRUM_OPERATOR(parameters, name, expression)                       \
    [[gnu::always_inline]] friend constexpr SpectrumOf operator name parameters {      \
        return each([&](int i) __attribute__((always_inline)) { return expression; }); \
    }
    LAMPYRIS_SPECTRUM_OPERATOR((SpectrumOf a, SpectrumOf b), +, a[i] + b[i])
    LAMPYRIS_SPECTRUM_OPERATOR((SpectrumOf a, SpectrumOf b), -, a[i] - b[i])
    LAMPYRIS_SPECTRUM_OPERATOR((SpectrumOf a, SpectrumOf b), *, a[i] * b[i])
    LAMPYRIS_SPECTRUM_OPERATOR((SpectrumOf a, SpectrumOf b), /, a[i] / b[i])
    LAMPYRIS_SPECTRUM_OPERATOR((SpectrumOf a, float s), *, a[i] * s)
    LAMPYRIS_SPECTRUM_OPERATOR((float s, SpectrumOf a), *, s* a[i])
    LAMPYRIS_SPECTRUM_OPERATOR((SpectrumOf a, float s), /, a[i] / s)
#undef LAMPYRIS_SPECTRUM_OPERATOR
    friend constexpr SpectrumOf& operator+=(SpectrumOf& a, SpectrumOf b) { return a = a + b; }
    friend constexpr SpectrumOf& operator*=(SpectrumOf& a, SpectrumOf b) { return a = a * b; }
    friend constexpr SpectrumOf& operator*=(SpectrumOf& a, float s) { return a = a * s; }
    friend constexpr bool operator==(const SpectrumOf& a, const SpectrumOf& b) {
        for (int i = 0; i < N; ++i)
            if (a[i] != b[i]) return false;
        return true;
    }
};

using Spectrum = SpectrumOf<3>;  // linear Rec. 709

}  // namespace lampyris::kernel
