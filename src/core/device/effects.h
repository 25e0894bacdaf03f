// The set of effects that a scene needs, each with the directive that needs it, so that nothing else is compiled.
#pragma once

#include "core/device/kernel_types.h"

#include <concepts>
#include <string>
#include <string_view>
#include <vector>

namespace lampyris {

struct EffectRequest {
    uint64_t effect = 0;   // one bit (kernel::EFFECT_*)
    std::string asked_by;  // "scene.pbrt:12:1 (Material \"dielectric\")"; the first directive that needs it
};

// The set is computed from the description; users cannot switch effects.
class Effects {
 public:
    // Adds one effect or several. The first directive to need an effect is recorded with it. If `asked_by` is a function, it is
    // called only for effects that are new, because finding a location in a file takes time.
    template <typename AskedBy>
    void ask(kernel::EffectSet effects, const AskedBy& asked_by) {
        for (kernel::EffectSet left = effects & ~mask_; left != 0; left &= left - 1) {
            const kernel::EffectSet lowest = left & (~left + 1);
            if constexpr (std::invocable<const AskedBy&>)
                requests_.push_back({lowest, asked_by()});
            else
                requests_.push_back({lowest, asked_by});
        }
        mask_ |= effects;
    }
    // Not an effect of the scene, so no request.
    void ask_path_log() { mask_ |= kernel::EFFECT_PATH_LOG; }
    uint64_t mask() const { return mask_; }
    bool has(uint64_t effect) const { return (mask_ & effect) != 0; }
    const std::vector<EffectRequest>& requests() const { return requests_; }

 private:
    uint64_t mask_ = 0;
    std::vector<EffectRequest> requests_;
};

struct EffectInfo {
    uint64_t effect;
    const char* name;
    const char* cost;
};
// All effects that Lampyris knows, in order of their bits; generated from core/kernel/effects.h.
const std::vector<EffectInfo>& known_effects();

}  // namespace lampyris
