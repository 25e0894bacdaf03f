#include "core/device/effects.h"

namespace lampyris {

const std::vector<EffectInfo>& known_effects() {
    static const std::vector<EffectInfo> effects = {
#define LAMPYRIS_EFFECT_INFO(constant, bit, name, cost) {kernel::constant, name, cost},
        LAMPYRIS_EFFECTS(LAMPYRIS_EFFECT_INFO)
#undef LAMPYRIS_EFFECT_INFO
    };
    return effects;
}

}  // namespace lampyris
