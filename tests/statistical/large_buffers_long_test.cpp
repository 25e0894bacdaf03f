// large_buffers_test at sizes that occur in practice: films, scenes and photons beyond the largest binding of lavapipe (134
// MB), against the CPU. Up to 3 GB of memory, five to fifteen minutes.
#include "support/agreement.h"
#include "support/temporary_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

namespace lampyris::test {
namespace {

bool has_vulkan() {
    const auto names = usable_backends();
    return std::find(names.begin(), names.end(), "vulkan") != names.end();
}

// The effects that the backends' tests of small pictures need.
void expect_same(const std::string& text, RenderSettings settings, const std::string& directory = ".") {
    settings.backend = "cpu";
    const Rendered cpu = render_text(text, settings, directory);
    settings.backend = "vulkan";
    settings.device_settings["exact"] = "auto";
    const Rendered vulkan = render_text(text, settings, directory);
    EXPECT_GT(cpu.mean_luminance(), 0.0);
    const Agreement found = agreement(cpu, vulkan, 1e-5);
    fmt::print("{:.4f} % of {} pixels to the bit, largest difference {:.1e}\n",
               100.0 * double(found.identical) / double(found.pixels), found.pixels, found.largest);
    EXPECT_GE(found.share(), 0.999);
}

TEST(LargeBuffersLong, FilmsOf1080Lines) {
    if (!has_vulkan()) GTEST_SKIP() << "no Vulkan device";
    RenderSettings settings;
    settings.resolution = {{1920, 1080}};
    settings.samples = 1;
    settings.seed = 41;
    expect_agreement("coffee/scene", "vulkan", settings, 1e-5, 0.999);
    settings.integrator = "sppm";
    expect_agreement("kitchen/scene", "vulkan", settings, 1e-5, 0.999);
}

// A scene whose triangles, vertices and BVH are all too large to be bound.
TEST(LargeBuffersLong, TenMillionTriangles) {
    if (!has_vulkan()) GTEST_SKIP() << "no Vulkan device";
    constexpr uint32_t kSide = 2237;  // vertices; 2 * 2236^2 triangles
    const TemporaryFolder folder;
    {
        std::ofstream file(folder / "hills.ply", std::ios::binary);
        file << fmt::format(
            "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
            "property float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
            kSide * kSide, 2 * (kSide - 1) * (kSide - 1));
        for (uint32_t y = 0; y < kSide; ++y) {
            for (uint32_t x = 0; x < kSide; ++x) {
                const float u = float(x) / float(kSide - 1), v = float(y) / float(kSide - 1);
                const float place[3] = {10 * u - 5, 10 * v - 5, 0.5f * std::sin(15 * u) * std::cos(12 * v)};
                file.write(reinterpret_cast<const char*>(place), sizeof place);
            }
        }
        for (uint32_t y = 0; y + 1 < kSide; ++y) {
            for (uint32_t x = 0; x + 1 < kSide; ++x) {
                const uint32_t at = y * kSide + x;
                for (const auto& corners :
                     {std::array{at, at + 1, at + kSide + 1}, std::array{at, at + kSide + 1, at + kSide}}) {
                    file.put(3);
                    file.write(reinterpret_cast<const char*>(corners.data()), sizeof corners);
                }
            }
        }
    }
    RenderSettings settings;
    settings.samples = 4;
    settings.seed = 42;
    settings.integrator = "path:maxdepth=4";
    expect_same(R"(
Film "rgb" "integer xresolution" 160 "integer yresolution" 120
LookAt 0 -7 4.5  0 0 0  0 0 1
Camera "perspective" "float fov" 50
WorldBegin
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 8 8 8 ]
Shape "trianglemesh" "point3 P" [ -2 -2 6  -2 2 6  2 2 6  2 -2 6 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd
Material "diffuse" "rgb reflectance" [ 0.7 0.6 0.5 ]
Shape "plymesh" "string filename" "hills.ply"
)",
                settings, folder.string());
}

// 10^7 paths a pass leave some 2 * 10^7 photons of 32 bytes in this closed box, in every structure.
class LargePhotonMaps : public testing::TestWithParam<std::string> {};

TEST_P(LargePhotonMaps, TenMillionPathsAPass) {
    if (!has_vulkan()) GTEST_SKIP() << "no Vulkan device";
    RenderSettings settings;
    settings.samples = 1;
    settings.seed = 43;
    settings.integrator = "sppm:photonsperiteration=10000000,radius=0.01,maxdepth=4";
    settings.photon_map = GetParam();
    expect_same(R"(
Film "rgb" "integer xresolution" 48 "integer yresolution" 40
LookAt 0 1.5 -3.5  0 1 0  0 1 0
Camera "perspective" "float fov" 60
WorldBegin
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 9 8 7 ]
Shape "trianglemesh" "point3 P" [ -1 2.9 -1  1 2.9 -1  1 2.9 1  -1 2.9 1 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd
Material "diffuse" "rgb reflectance" [ 0.7 0.6 0.5 ]
Shape "trianglemesh" "point3 P" [ -2 0 -4  2 0 -4  2 0 2  -2 0 2  -2 3 -4  2 3 -4  2 3 2  -2 3 2 ]
  "integer indices" [ 0 1 2 0 2 3  4 5 6 4 6 7  3 2 6 3 6 7  0 3 7 0 7 4  1 2 6 1 6 5  0 1 5 0 5 4 ]
)",
                settings);
}

// Without brute force, which would test some 10^10 pairs.
std::vector<std::string> maps() {
    std::vector<std::string> names = photon_maps().names();
    std::erase(names, "brute_force");
    return names;
}
INSTANTIATE_TEST_SUITE_P(All, LargePhotonMaps, testing::ValuesIn(maps()), [](const auto& info) { return info.param; });

}  // namespace
}  // namespace lampyris::test
