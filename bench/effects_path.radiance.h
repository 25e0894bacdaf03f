// `path` as a program would have it that knows the effects of one scene and never heard of the others: what effects_bench
// compares the program's own variants with. One build for each scene of bench/effects.py.
// CMake reads this list, which is one line; the compiler reads path.radiance.h's own.
// clang-format off
#if 0
#define KERNEL_CPU_VARIANTS EFFECT_QUADRICS | EFFECT_AREA_LIGHTS, EFFECT_QUADRICS | EFFECT_DIELECTRIC | EFFECT_AREA_LIGHTS, EFFECT_TEXTURES | EFFECT_IMAGES | EFFECT_AREA_LIGHTS, EFFECT_QUADRICS | EFFECT_DIELECTRIC | EFFECT_ROUGH | EFFECT_LAYERED_COAT | EFFECT_AREA_LIGHTS, EFFECT_QUADRICS | EFFECT_IMAGES | EFFECT_CONDUCTOR | EFFECT_ROUGH | EFFECT_ENVIRONMENT | EFFECT_ENVIRONMENT_IMAGE
#endif
// clang-format on
// Nor does it ask at run time. (C++ only: no shader is made of this file.)
#include "core/kernel/bindings.h"
#undef CALLED_FOR
#define CALLED_FOR(effect) HAS(effect)
#include "integrators/path/path.radiance.h"
