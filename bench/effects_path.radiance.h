// `path` as it would be in a program that has only the effects of one scene: effects_bench compares the program's own variants
// with it. There is one build for each scene of bench/effects.py.
// CMake reads this list, which is one line; the compiler reads path.radiance.h's own.
// clang-format off
#if 0
#define KERNEL_CPU_VARIANTS EFFECT_QUADRICS | EFFECT_AREA_LIGHTS, EFFECT_QUADRICS | EFFECT_DIELECTRIC | EFFECT_AREA_LIGHTS, EFFECT_TEXTURES | EFFECT_IMAGES | EFFECT_AREA_LIGHTS, EFFECT_QUADRICS | EFFECT_DIELECTRIC | EFFECT_ROUGH | EFFECT_LAYERED_COAT | EFFECT_AREA_LIGHTS, EFFECT_QUADRICS | EFFECT_IMAGES | EFFECT_CONDUCTOR | EFFECT_ROUGH | EFFECT_ENVIRONMENT | EFFECT_ENVIRONMENT_IMAGE
#endif
// clang-format on
// Effects are not tested at run time either. (C++ only: no shader is made of this file.)
#include "core/kernel/bindings.h"
#undef CALLED_FOR
#define CALLED_FOR(effect) HAS(effect)
#include "integrators/path/path.radiance.h"
