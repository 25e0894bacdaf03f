#include "core/effects.h"

namespace lampyris {

void Effects::ask(uint32_t effect, const std::string& asked_by) {
    if (mask_ & effect) return;
    mask_ |= effect;
    requests_.push_back({effect, asked_by});
}

const std::vector<EffectInfo>& known_effects() {
    static const std::vector<EffectInfo> effects = {
#define LAMPYRIS_EFFECT_INFO(constant, bit, name, cost) {kernel::constant, name, cost},
        LAMPYRIS_EFFECTS(LAMPYRIS_EFFECT_INFO)
#undef LAMPYRIS_EFFECT_INFO
    };
    return effects;
}

}  // namespace lampyris
