// Only what the scene calls for: the set of effects, each with who asked for it.
#pragma once

#include "core/kernel_types.h"

#include <concepts>
#include <string>
#include <string_view>
#include <vector>

namespace lampyris {

struct EffectRequest {
    uint64_t effect = 0;   // one bit (kernel::EFFECT_*)
    std::string asked_by;  // "scene.pbrt:12:1 (Material \"dielectric\")"; the first directive that asks
};

// A set computed from the description, not a user's switch.
class Effects {
 public:
    // One effect or several. The first one to ask for each is remembered. Where who asks is a function, it is called for new effects
    // alone: to find a place in a file takes time.
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
// Every effect that Lampyris knows, in order of their bits; generated from core/kernel/effects.h.
const std::vector<EffectInfo>& known_effects();

}  // namespace lampyris
