// The set of effects, and the directive that needs each.
#include "core/device/effects.h"

#include <gtest/gtest.h>

#include <bit>

namespace lampyris {
namespace {

using kernel::EFFECT_CONDUCTOR;
using kernel::EFFECT_ROUGH;
using kernel::EFFECT_TEXTURES;

TEST(Effects, TheFirstToAskIsRemembered) {
    Effects effects;
    effects.ask(EFFECT_ROUGH, "the first");
    effects.ask(EFFECT_ROUGH, "the second");
    ASSERT_EQ(effects.requests().size(), 1u);
    EXPECT_EQ(effects.requests()[0].asked_by, "the first");
}

TEST(Effects, OfSeveralEffectsThoseThatAreNewAreAdded) {
    Effects effects;
    effects.ask(EFFECT_ROUGH, "a material");
    effects.ask(EFFECT_CONDUCTOR | EFFECT_ROUGH | EFFECT_TEXTURES, "a test");
    EXPECT_EQ(effects.mask(), EFFECT_CONDUCTOR | EFFECT_ROUGH | EFFECT_TEXTURES);
    ASSERT_EQ(effects.requests().size(), 3u);
    for (const EffectRequest& request : effects.requests()) {
        EXPECT_TRUE(std::has_single_bit(request.effect));
        EXPECT_EQ(request.asked_by, request.effect == EFFECT_ROUGH ? "a material" : "a test");
    }
}

TEST(Effects, AllOfThemHaveNames) {
    Effects effects;
    effects.ask(EFFECT_TEXTURES, "a texture");
    effects.ask(kernel::kAllEffects, "a test");
    EXPECT_EQ(effects.mask(), kernel::kAllEffects);
    EXPECT_EQ(effects.requests().size(), known_effects().size());
}

TEST(Effects, APlaceIsLookedUpForNewEffectsOnly) {
    Effects effects;
    int looked_up = 0;
    const auto place = [&] { return std::to_string(++looked_up); };
    effects.ask(EFFECT_ROUGH, place);
    effects.ask(EFFECT_ROUGH, place);
    EXPECT_EQ(looked_up, 1);
}

}  // namespace
}  // namespace lampyris
