// Buffers that a device cannot bind are accessed by their addresses: with a lower limit, small scenes access the film, the
// scene and all copies of photons like this, and make the same image to the bit as with all buffers bound.
#include "backends/vulkan/addresses.h"
#include "backends/shaders/shader_compiler.h"
#include "core/base/error.h"
#include "support/photon_sets.h"
#include "support/runs.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <spirv-tools/libspirv.hpp>

#include <algorithm>
#include <cstring>

namespace lampyris {
namespace {

// Diffuse walls, a lamp, and enough triangles that the BVH is larger than the limits below.
std::string scene() {
    std::string text = R"(
Film "rgb" "integer xresolution" 20 "integer yresolution" 18
LookAt 0 1.5 -5  0 0.5 0  0 1 0
Camera "perspective" "float fov" 45
WorldBegin
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 9 8 7 ]
Shape "trianglemesh" "point3 P" [ -1 4 -1  1 4 -1  1 4 1  -1 4 1 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd
Material "diffuse" "rgb reflectance" [ 0.6 0.5 0.4 ]
Shape "trianglemesh" "point3 P" [ -4 0 -4  4 0 -4  4 0 4  -4 0 4 ] "integer indices" [ 0 2 1 0 3 2 ]
Shape "trianglemesh" "point3 P" [ )";
    std::string indices;
    constexpr int kSteps = 24;
    for (int i = 0; i < kSteps; ++i) {
        const double x = -2.0 + 4.0 * i / kSteps;
        text += fmt::format("{} 0 0 {} {} 0.3 {} 0 0.8 ", x, x + 0.1, 0.4 + 0.05 * (i % 7), x + 0.2);
        indices += fmt::format("{} {} {} ", 3 * i, 3 * i + 1, 3 * i + 2);
    }
    return text + "] \"integer indices\" [ " + indices + "]\n";
}

bool has_vulkan() {
    const auto names = test::usable_backends();
    return std::find(names.begin(), names.end(), "vulkan") != names.end();
}

struct Case {
    std::string integrator, map;
};

class LargeBuffers : public testing::TestWithParam<Case> {};

TEST_P(LargeBuffers, ImagesAreThoseOfBoundBuffers) {
    if (!has_vulkan()) GTEST_SKIP() << "no Vulkan device";
    test::RenderSettings s;
    s.backend = "vulkan";
    s.integrator = GetParam().integrator;
    if (!GetParam().map.empty()) s.photon_map = GetParam().map;
    s.samples = 2;
    const test::Rendered bound = test::render_text(scene(), s);
    s.device_settings["max_binding"] = "2000";
    const test::Rendered addressed = test::render_text(scene(), s);
    ASSERT_EQ(addressed.pixels.size(), bound.pixels.size());
    for (size_t i = 0; i < bound.pixels.size(); ++i)
        ASSERT_EQ(std::memcmp(&addressed.pixels[i], &bound.pixels[i], sizeof bound.pixels[i]), 0) << "pixel " << i;
    EXPECT_GT(addressed.mean_luminance(), 0.0);
}

std::string name_of_case(const testing::TestParamInfo<Case>& info) {
    const std::string& integrator = info.param.integrator;
    return test::name_of(integrator.substr(0, integrator.find(':')) + "_" + info.param.map);
}
const char* const kPhotons = "sppm:maxdepth=3,photonsperiteration=2000,radius=0.4";
INSTANTIATE_TEST_SUITE_P(Some, LargeBuffers,
                         testing::Values(Case{"path:maxdepth=3", ""}, Case{kPhotons, "sorted_grid"}), name_of_case);
INSTANTIATE_TEST_SUITE_P(LongRest, LargeBuffers,
                         testing::Values(Case{"ao:rays=2", ""}, Case{kPhotons, "splat"},
                                         Case{"photon_map:photons=2000,nearest=8,gather=1", "kd_tree"}),
                         name_of_case);

// Each structure, including those with atomics, finds the same photons; to the bit if their order is fixed.
TEST(LargeBuffersOfMaps, HoldTheSamePhotons) {
    if (!has_vulkan()) GTEST_SKIP() << "no Vulkan device";
    const test::PhotonCase photon_case = test::make_photon_case("random", 3000, 300);
    for (const std::string& name : photon_maps().names()) {
        SCOPED_TRACE(name);
        std::vector<std::vector<test::CollectResult>> results;
        PhotonMapCapabilities can;
        for (const char* largest : {"1000000000", "1000"}) {
            DeviceOptions options;
            options.settings["max_binding"] = largest;
            const auto device = create_device("vulkan", options);
            const auto map = create_photon_map(name);
            can = map->capabilities();
            if (!test::can_run(*device, *map)) break;
            map->open(*device);
            results.push_back(test::collect(*device, *map, test::upload_case(*device, photon_case)));
        }
        if (results.empty()) continue;
        ASSERT_EQ(results[0].size(), results[1].size());
        uint32_t found = 0;
        for (size_t i = 0; i < results[0].size(); ++i) {
            const test::CollectResult &bound = results[0][i], &addressed = results[1][i];
            found += addressed.found.x;
            if (can.exact) {
                ASSERT_TRUE(test::same_photons(addressed, bound, can.sums_only)) << "query " << i;
            }
            if (can.fixed_order) {
                ASSERT_EQ(std::memcmp(&addressed, &bound, sizeof bound), 0) << "query " << i;
            }
        }
        EXPECT_GT(found, 100u) << "queries that find nothing show nothing";
    }
}

// With every buffer of a kernel accessed by address, the SPIR-V is valid, before and after the optimizer.
TEST(LargeBuffersCode, IsValid) {
    spvtools::SpirvTools tools(SPV_ENV_VULKAN_1_2);
    std::string said;
    tools.SetMessageConsumer([&](spv_message_level_t, const char*, const spv_position_t&, const char* message) {
        said += std::string(message) + "\n";
    });
    for (const bool optimize : {false, true}) {
        for (const char* file : {"integrators/path/path.radiance.h", "accel/photons/cuckoo/cuckoo_insert.kernel.h",
                                 "accel/photons/collect/collect.consumer.h+accel/photons/kd_tree/kd_tree.gather.h"}) {
            SCOPED_TRACE(file);
            shaders::ShaderOptions options;
            options.effects = kernel::kDiffuseEffects | kernel::EFFECT_TEXTURES | kernel::EFFECT_IMAGES;
            options.optimize = optimize;
            options.wide_reads = true;
            const shaders::Spirv spirv = shaders::compile_shader(file, options, shaders::ShaderCache({})).spirv;
            std::vector<shaders::ShaderBinding> bindings = shaders::used_bindings(spirv);
            std::erase_if(bindings, [](const auto& binding) { return binding.acceleration_structure; });
            ASSERT_FALSE(bindings.empty());
            const shaders::Spirv changed = vulkan::address_buffers(spirv, bindings);
            EXPECT_TRUE(tools.Validate(changed)) << said;
            EXPECT_TRUE(shaders::used_bindings(changed).empty()) << "a buffer is still bound";
        }
    }
}

TEST(LargeBuffersSetting, IsANumberOfBytes) {
    if (!has_vulkan()) GTEST_SKIP() << "no Vulkan device";
    for (const char* wrong : {"", "15", "-1", "4096x", "much", "99999999999999999999999"}) {
        DeviceOptions options;
        options.settings["max_binding"] = wrong;
        EXPECT_THROW(create_device("vulkan", options), InputError) << wrong;
    }
}

// In a buffer larger than the device's own limit, the last word and one beyond the limit can be accessed. If there is not
// enough memory for it, addresses have not failed; but lavapipe's limit is small.
TEST(LargeBuffersOfDevices, ReachTheLastWord) {
    if (!has_vulkan()) GTEST_SKIP() << "no Vulkan device";
    const auto device = create_device("vulkan");
    if (device->description().find("llvmpipe") == std::string::npos) GTEST_SKIP() << "binds gigabytes";
    constexpr uint32_t kWords = 40'000'000;  // 160 MB, above 134
    const auto in = device->create_buffer(size_t(kWords) * 4, "inputs"),
               out = device->create_buffer(size_t(kWords) * 4, "results"),
               counter = device->create_buffer(4, "counter");
    const float values[] = {3.0f, 5.0f};
    in->upload(values, 8, size_t(kWords - 2) * 4);
    const auto kernel = device->compile("kernel/device_square.kernel.h", 0);
    const NamedBuffer buffers[] = {{"inputs", in}, {"results", out}, {"counters", counter}};
    device->run(*kernel, nullptr, buffers, kWords - 2, 2);
    float results[3];
    out->download(results, 12, size_t(kWords - 3) * 4);
    EXPECT_EQ(results[0], 0.0f);
    EXPECT_EQ(results[1], 9.0f + float(kWords - 2));
    EXPECT_EQ(results[2], 25.0f + float(kWords - 1));
}

}  // namespace
}  // namespace lampyris
