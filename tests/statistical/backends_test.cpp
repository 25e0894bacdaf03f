// The same scene with the same seed on different backends: one kernel source, one image. docs/determinism.md explains which
// differences are possible, and why. Nothing is random: seeds are fixed.
#include "support/agreement.h"

#include <gtest/gtest.h>

namespace lampyris::test {
namespace {

std::vector<std::string> other_backends() {
    std::vector<std::string> names;
    for (const std::string& name : usable_backends())
        if (name != "cpu") names.push_back(name);
    return names;
}

// On Vulkan, a compiler is at work for seconds for each scene: those that have all effects of the reference scenes are enough here,
// and backends_long_test has the others.
std::vector<std::pair<std::string, std::string>> scenes_and_backends() {
    const std::vector<std::string>& few = scenes_of_all_effects();
    std::vector<std::pair<std::string, std::string>> all;
    for (const std::string& backend : other_backends())
        for (const std::string& scene : small_scenes())
            if (backend != "vulkan" || std::find(few.begin(), few.end(), scene) != few.end())
                all.emplace_back(scene, backend);
    return all;
}

TEST(BackendsScenes, HaveAllEffects) {
    uint64_t all = 0, chosen = 0;
    for (const std::string& scene : small_scenes())
        if (scene.starts_with("reference/")) all |= effects_of(scene);
    for (const std::string& scene : scenes_of_all_effects()) chosen |= effects_of(scene);
    EXPECT_NE(all, 0u);
    EXPECT_EQ(chosen, all);
}

class BackendsTest : public testing::TestWithParam<std::pair<std::string, std::string>> {};

TEST_P(BackendsTest, OneSampleIsTheSame) {
    const auto& [scene, backend] = GetParam();
    RenderSettings settings;
    settings.samples = 1;
    settings.seed = 20;
    expect_agreement(scene, backend, settings, 1e-5, 0.999);
}

INSTANTIATE_TEST_SUITE_P(Scenes, BackendsTest, testing::ValuesIn(scenes_and_backends()),
                         [](const auto& info) { return test_name(info.param.first + "_" + info.param.second); });

// Many samples, so that the few that diverge change a pixel only a little. The scenes are some of those above, whose shaders a driver
// has compiled then.
class ManySamplesTest : public testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(ManySamplesTest, PixelsAreTheSame) {
    const auto& [scene, backend] = GetParam();
    RenderSettings settings;
    settings.resolution = {{20, 20}};
    settings.samples = 512;
    settings.seed = 21;
    expect_agreement(scene, backend, settings, 1e-3, 0.99);
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, ManySamplesTest,
    testing::Combine(testing::Values("reference/distant", "reference/sds-lamp", "reference/conductor-gold"),
                     testing::ValuesIn(other_backends())),
    [](const auto& info) { return test_name(std::get<0>(info.param) + "_" + std::get<1>(info.param)); });

// Photon mapping stores photons in a different order on each backend, and sums them in the order of their keys. A photon that
// takes a different path at an edge changes the hit points around it.
class PhotonMappingTest : public testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(PhotonMappingTest, TwoPassesAreTheSame) {
    const auto& [scene, backend] = GetParam();
    RenderSettings settings;
    settings.integrator = "sppm:maxdepth=12,photonsperiteration=20000";
    settings.resolution = {{64, 64}};
    settings.samples = 2;
    settings.seed = 24;
    expect_agreement(scene, backend, settings, 1e-5, 0.999);
}

// Other integrators (light, bdpt, mlt, vcm and bpm: in their own tests): a light path that takes another way at an edge may reach
// many pixels.
class OtherMethodsTest : public testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(OtherMethodsTest, TwoPassesAreTheSame) {
    const auto& [integrator, backend] = GetParam();
    RenderSettings settings;
    settings.integrator = integrator;
    settings.resolution = {{32, 32}};
    settings.samples = 2;
    settings.seed = 25;
    expect_agreement("reference/diffuse", backend, settings, 1e-5, 0.99);
}

INSTANTIATE_TEST_SUITE_P(
    Integrators, OtherMethodsTest,
    testing::Combine(testing::Values("ao", "ppm:photonsperiteration=5000", "photon_map:photons=20000"),
                     testing::ValuesIn(other_backends())),
    [](const auto& info) {
        const std::string& integrator = std::get<0>(info.param);
        return test_name(integrator.substr(0, integrator.find(':')) + "_" + std::get<1>(info.param));
    });

// The option that makes a GPU's images equal must not change those of a device that divides exactly by itself.
TEST(BackendsExactTest, QuotientsByIntegersAreTheSame) {
    const auto others = other_backends();
    if (std::find(others.begin(), others.end(), "vulkan") == others.end()) GTEST_SKIP() << "no Vulkan device";
    expect_exact_agreement("reference/diffuse");
}

// (On Vulkan one scene, for its effects; backends_long_test has all.)
std::vector<std::tuple<std::string, std::string>> photon_scenes() {
    std::vector<std::tuple<std::string, std::string>> all;
    for (const char* scene : {"reference/coated-diffuse", "reference/infinite-image", "reference/textures"})
        for (const std::string& backend : other_backends())
            if (backend != "vulkan" || scene == std::string("reference/coated-diffuse"))
                all.emplace_back(scene, backend);
    return all;
}

INSTANTIATE_TEST_SUITE_P(Scenes, PhotonMappingTest, testing::ValuesIn(photon_scenes()), [](const auto& info) {
    return test_name(std::get<0>(info.param) + "_" + std::get<1>(info.param));
});

}  // namespace
}  // namespace lampyris::test
