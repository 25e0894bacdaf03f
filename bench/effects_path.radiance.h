// `path` as it would be in a program that has only the effects of one scene: effects_bench compares the program's own variants
// with it. There is one build for each scene of bench/effects.py (CMakeLists.txt).
// Effects are not tested at run time either. (C++ only: no shader is made of this file.)
#include "core/kernel/bindings.h"
#undef CALLED_FOR
#define CALLED_FOR(effect) HAS(effect)
#include "integrators/path/path.radiance.h"
