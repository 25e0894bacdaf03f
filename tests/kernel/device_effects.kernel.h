// For device_test: code for an effect that was not requested is removed.
#include "core/kernel/prelude.h"
#ifndef __cplusplus
#include "core/kernel/effects.h"
#endif
#include "core/kernel/math.h"

BUFFER_RW(0, float, results)

KERNEL(device_effects) {
    float x = float(index);
    if (HAS(EFFECT_LAYERED_COAT)) {
        for (uint i = 0u; i < 8u; ++i) x = exp_of(sin_of(x) + log_of(x + 1.0f));
    }
    results[index] = x;
}
