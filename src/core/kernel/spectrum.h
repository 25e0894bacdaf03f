// Functions of a Spectrum (core/device/spectrum.h). No other kernel file depends on the number or meaning of its values.
#ifndef LAMPYRIS_KERNEL_SPECTRUM
#define LAMPYRIS_KERNEL_SPECTRUM

// SPECTRUM_EACH(F) is the spectrum of F(0), F(1), ...; F is a macro.
#ifdef SPECTRUM_OF_FOUR
SPECTRUM_TYPE(4)
// Values at four wavelengths of a path. Not yet used by an integrator: docs/decisions/spectrum-type.md says what is missing.
#define SPECTRUM_EACH(F) Spectrum(F(0), F(1), F(2), F(3))
FN float max_value(Spectrum s) { return max(max(s[0], s[1]), max(s[2], s[3])); }
FN bool is_black(Spectrum s) { return s[0] == 0.0f && s[1] == 0.0f && s[2] == 0.0f && s[3] == 0.0f; }
#else
// Linear Rec. 709.
#define SPECTRUM_EACH(F) Spectrum(F(0), F(1), F(2))
FN float max_value(Spectrum s) { return max(s[0], max(s[1], s[2])); }
FN bool is_black(Spectrum s) { return s[0] == 0.0f && s[1] == 0.0f && s[2] == 0.0f; }

// The film adds up linear Rec. 709.
FN vec3 rgb_of(Spectrum s) { return vec3(s[0], s[1], s[2]); }
FN Spectrum spectrum_of_rgb(vec3 rgb) { return Spectrum(rgb.x, rgb.y, rgb.z); }

// A spectrum in a vec4 of a record, whose fourth number has another meaning.
FN Spectrum spectrum_of(vec4 slot) { return Spectrum(slot.x, slot.y, slot.z); }
FN vec4 slot_of(Spectrum s, float fourth) { return vec4(s[0], s[1], s[2], fourth); }
#endif

FN Spectrum clamp_each(Spectrum s, float least, float most) {
#define CLAMPED(i) clamp(s[i], least, most)
    return SPECTRUM_EACH(CLAMPED);
#undef CLAMPED
}
// exp(-s) of each value.
FN Spectrum exp_of_minus(Spectrum s) {
#define EXP_OF_MINUS(i) exp_of(-s[i])
    return SPECTRUM_EACH(EXP_OF_MINUS);
#undef EXP_OF_MINUS
}

#endif
