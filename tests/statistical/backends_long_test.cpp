// backends_test at the full size of the pictures and with 512 samples per pixel, the larger scenes with one, and photon mapping
// and methods with light paths in all scenes: takes an hour where shaders are compiled anew.
#include "support/agreement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

namespace lampyris::test {
namespace {

class BackendsLongTest : public testing::TestWithParam<std::string> {};

TEST_P(BackendsLongTest, PixelsAreTheSameOnVulkan) {
    RenderSettings settings;
    settings.samples = 512;
    settings.seed = 22;
    expect_agreement(GetParam(), "vulkan", settings, 1e-3, 0.99);
}

INSTANTIATE_TEST_SUITE_P(Scenes, BackendsLongTest,
                         testing::Values("reference/diffuse", "reference/dielectric-smooth", "reference/textures"),
                         [](const auto& info) { return test_name(info.param); });

// Those that backends_test leaves out.
class OtherScenesTest : public testing::TestWithParam<std::string> {};

TEST_P(OtherScenesTest, OneSampleIsTheSameOnVulkan) {
    RenderSettings settings;
    settings.samples = 1;
    settings.seed = 20;
    expect_agreement(GetParam(), "vulkan", settings, 1e-5, 0.999);
}

std::vector<std::string> other_scenes() {
    const std::vector<std::string>& few = scenes_of_all_effects();
    std::vector<std::string> scenes = small_scenes();
    std::erase_if(scenes, [&](const auto& name) { return std::find(few.begin(), few.end(), name) != few.end(); });
    return scenes;
}

INSTANTIATE_TEST_SUITE_P(Scenes, OtherScenesTest, testing::ValuesIn(other_scenes()),
                         [](const auto& info) { return test_name(info.param); });

// Every quotient of a kernel with rough glass.
TEST(BackendsExactLongTest, QuotientsByIntegersAreTheSame) { expect_exact_agreement("reference/dielectric-rough"); }

class LargeScenesTest : public testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(LargeScenesTest, OneSampleIsTheSame) {
    const auto& [scene, backend] = GetParam();
    ASSERT_TRUE(std::filesystem::exists(scene_path(scene))) << scene << " is not in the tree";
    RenderSettings settings;
    settings.samples = 1;
    settings.seed = 23;
    expect_agreement(scene, backend, settings, 1e-5, 0.999);
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, LargeScenesTest,
    testing::Combine(testing::Values("cornell-box/scene", "veach-mis/scene", "veach-bidir/scene", "coffee/scene"),
                     testing::Values("cpu-bvh2", "vulkan")),
    [](const auto& info) { return test_name(std::get<0>(info.param) + "_" + std::get<1>(info.param)); });

// PhotonMappingTest of backends_test, for every effect.
class PhotonMappingLongTest : public testing::TestWithParam<std::string> {};

TEST_P(PhotonMappingLongTest, TwoPassesAreTheSameOnVulkan) {
    RenderSettings settings;
    settings.integrator = "sppm:maxdepth=12,photonsperiteration=20000";
    settings.resolution = {{64, 64}};
    settings.samples = 2;
    settings.seed = 24;
    expect_agreement(GetParam(), "vulkan", settings, 1e-5, 0.999);
}

INSTANTIATE_TEST_SUITE_P(Scenes, PhotonMappingLongTest, testing::ValuesIn(small_scenes()),
                         [](const auto& info) { return test_name(info.param); });

// The same for methods with light paths: one that takes another way at an edge may reach many pixels, and a chain never comes back.
class LightPathsLongTest : public testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(LightPathsLongTest, TwoPassesAreTheSameOnVulkan) {
    const auto& [scene, integrator] = GetParam();
    RenderSettings settings;
    settings.integrator = integrator;
    settings.resolution = {{32, 32}};
    settings.samples = 2;
    settings.seed = 25;
    expect_agreement(scene, "vulkan", settings, 1e-5, integrator.starts_with("mlt") ? 0.95 : 0.99);
}

INSTANTIATE_TEST_SUITE_P(Scenes, LightPathsLongTest,
                         testing::Combine(testing::ValuesIn(small_scenes()),
                                          testing::Values("light:maxdepth=8", "bdpt:maxdepth=8", "vcm:maxdepth=8",
                                                          "mlt:maxdepth=8,chains=64")),
                         [](const auto& info) {
                             const std::string& integrator = std::get<1>(info.param);
                             return test_name(std::get<0>(info.param) + "_" +
                                              integrator.substr(0, integrator.find(':')));
                         });
INSTANTIATE_TEST_SUITE_P(ChosenCounts, LightPathsLongTest,
                         testing::Combine(testing::Values("reference/dielectric-smooth"),
                                          testing::Values("bdpt:maxdepth=5,counts=auto")),
                         [](const auto&) { return "bdpt"; });

}  // namespace
}  // namespace lampyris::test
