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

// On Vulkan, a compiler is at work for seconds for each scene: those in analytic/ are left to backends_long_test there. Their effects
// are those of the others.
std::vector<std::pair<std::string, std::string>> scenes_and_backends() {
    std::vector<std::pair<std::string, std::string>> all;
    for (const std::string& backend : other_backends())
        for (const std::string& scene : small_scenes())
            if (backend != "vulkan" || !scene.starts_with("analytic/")) all.emplace_back(scene, backend);
    return all;
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

// Many samples, so that the few that diverge change a pixel only a little.
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
    testing::Combine(testing::Values("reference/diffuse", "reference/dielectric-smooth", "reference/conductor-rough"),
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

// Other integrators (light, bdpt and mlt: in their own tests): a light path that takes another way at an edge may reach many pixels.
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

INSTANTIATE_TEST_SUITE_P(Integrators, OtherMethodsTest,
                         testing::Combine(testing::Values("ao", "vcm:maxdepth=8", "bpm:maxdepth=8",
                                                          "ppm:photonsperiteration=5000", "photon_map:photons=20000"),
                                          testing::ValuesIn(other_backends())),
                         [](const auto& info) {
                             const std::string& integrator = std::get<0>(info.param);
                             return test_name(integrator.substr(0, integrator.find(':')) + "_" +
                                              std::get<1>(info.param));
                         });

// The option that makes a GPU's images equal must not change those of a device that divides exactly by itself.
TEST(BackendsExactTest, QuotientsByIntegersAreTheSame) {
    const auto others = other_backends();
    if (std::find(others.begin(), others.end(), "vulkan") == others.end()) GTEST_SKIP() << "no Vulkan device";
    RenderSettings settings;
    settings.samples = 1;
    settings.seed = 25;
    settings.device_settings["exact"] = "on";
    settings.device_settings["staging"] = "on";  // as on a GPU
    expect_agreement("reference/dielectric-rough", "vulkan", settings, 1e-5, 0.999);
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, PhotonMappingTest,
    testing::Combine(testing::Values("reference/coated-diffuse", "reference/infinite-image", "reference/textures"),
                     testing::ValuesIn(other_backends())),
    [](const auto& info) { return test_name(std::get<0>(info.param) + "_" + std::get<1>(info.param)); });

}  // namespace
}  // namespace lampyris::test
