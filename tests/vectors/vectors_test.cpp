// Kernels that run in vectors give what the scalar builds give, to the bit. Nothing is random: seeds are fixed.
#include "support/agreement.h"
#include "support/device_run.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <random>
#include <string>

namespace lampyris::test {
namespace {

DeviceOptions in_vectors() {
    DeviceOptions options;
    options.settings["vectors"] = "on";  // a kernel that is not translated is an error
    return options;
}

TEST(Vectors, InvocationsGoDifferentWays) {
    std::mt19937 random(3);
    std::vector<uint32_t> numbers;
    for (uint32_t i = 0; i < 3001; ++i) numbers.push_back(i < 200 ? i : uint32_t(random()) >> (random() % 31));
    std::vector<uint32_t> found[2];
    for (const bool vectors : {false, true}) {
        const auto device = create_device("cpu", vectors ? in_vectors() : DeviceOptions());
        const BufferHandle in = upload(*device, numbers, "numbers");
        const BufferHandle results = upload(*device, std::vector<uint32_t>(8 * numbers.size() + 4, 7u), "results");
        const NamedBuffer buffers[] = {{"numbers", in},
                                       {"results", results},
                                       {"sums", device->create_buffer(16, "sums")},
                                       {"wide_sums", device->create_buffer(64, "wide_sums")}};
        const auto kernel = device->compile("vectors/vectors_probe.kernel.h", 0);
        // Ranges that are no multiples of eight, one at a time.
        for (const auto& [begin, count] : {std::pair{0u, 5u}, {5u, 2900u}, {2905u, 96u}})
            device->run(*kernel, nullptr, buffers, begin, count);
        found[vectors] = download<uint32_t>(results, 8 * numbers.size() + 4);
        for (const uint32_t sum : download<uint32_t>(buffers[2].buffer, 4)) found[vectors].push_back(sum);
    }
    EXPECT_EQ(found[0][8 * 6], 8u);  // 6 3 10 5 16 8 4 2 1
    for (size_t i = 0; i < found[0].size(); ++i)
        ASSERT_EQ(found[0][i], found[1][i])
            << "result " << i % 8 << " of " << (i / 8 < numbers.size() ? numbers[i / 8] : 0);
}

// Once the scalar build has run for a while.
TEST(Vectors, TakeOver) {
    std::vector<uint32_t> numbers(1u << 16);
    for (uint32_t i = 0; i < numbers.size(); ++i) numbers[i] = i;
    const auto always = create_device("cpu", in_vectors());
    always->compile("vectors/vectors_probe.kernel.h", 0);  // so that nothing has to be compiled in the background
    const auto device = create_device("cpu");
    const BufferHandle in = upload(*device, numbers, "numbers");
    const BufferHandle results = device->create_buffer(4 * (8 * numbers.size() + 4), "results");
    const NamedBuffer buffers[] = {{"numbers", in},
                                   {"results", results},
                                   {"sums", device->create_buffer(16, "sums")},
                                   {"wide_sums", device->create_buffer(64, "wide_sums")}};
    const auto kernel = device->compile("vectors/vectors_probe.kernel.h", 0);
    std::vector<uint32_t> first;
    const auto share = [&] { return device->statistics().invocations.at("vectors/vectors_probe.kernel.h"); };
    const auto start = std::chrono::steady_clock::now();
    do {
        results->fill_zero();
        device->run(*kernel, nullptr, buffers, 0, uint32_t(numbers.size()));
        const std::vector<uint32_t> found = download<uint32_t>(results, 8 * numbers.size());
        if (first.empty()) first = found;
        ASSERT_EQ(found, first);
        ASSERT_LT(std::chrono::steady_clock::now() - start, std::chrono::minutes(5)) << "no vectors took over";
    } while (share().in_vectors < 3 * numbers.size());
    EXPECT_GT(share().all, share().in_vectors) << "they were there before they could be";
}

RenderSettings in_vectors(RenderSettings settings) {
    settings.device_settings["vectors"] = "on";
    return settings;
}

void expect_same(const Rendered& scalar, const Rendered& vectors) {
    ASSERT_EQ(scalar.pixels.size(), vectors.pixels.size());
    size_t different = 0;
    for (size_t i = 0; i < scalar.pixels.size(); ++i)
        different += std::memcmp(&scalar.pixels[i], &vectors.pixels[i], sizeof(scalar.pixels[i])) != 0;
    EXPECT_EQ(different, 0u);
    EXPECT_EQ(scalar.summary.rays, vectors.summary.rays);
}

// Which of several surfaces in the same place a ray finds depends on the order in which it is traced: it must be one order.
TEST(Vectors, FindTheSameOfSurfacesInOnePlace) {
    std::string scene = R"(LookAt 0 0 5  0 0 0  0 1 0
Camera "perspective" "float fov" 45
WorldBegin
LightSource "infinite" "rgb L" [1 1 1]
)";
    const char* colours[] = {"1 0 0", "0 1 0", "0 0 1", "1 1 0", "0 1 1"};
    const char* corners[] = {"0 1 2 0 2 3", "0 1 3 1 2 3", "2 3 0 2 0 1", "0 1 2 0 2 3", "0 1 3 1 2 3"};
    for (int i = 0; i < 5; ++i) {
        scene += fmt::format("Material \"diffuse\" \"rgb reflectance\" [{}]\n", colours[i]);
        scene += fmt::format(
            "Shape \"trianglemesh\" \"point3 P\" [-1 -1 0  1 -1 0  1 1 0  -1 1 0] \"integer indices\" [{}]\n",
            corners[i]);
        scene += "AttributeBegin Translate 1 1 0 Shape \"sphere\" \"float radius\" .5 AttributeEnd\n";
        scene += "AttributeBegin Translate -1 1 0 Shape \"disk\" \"float radius\" .5 AttributeEnd\n";
        scene +=
            "AttributeBegin ObjectBegin \"o" + std::to_string(i) +
            "\" Shape \"trianglemesh\" \"point3 P\" [-1 -1 0  1 -1 0  1 1 0  -1 1 0] \"integer indices\" [0 1 2 0 2 3] "
            "Shape \"sphere\" \"float radius\" .5 ObjectEnd Scale .5 .5 .5 Translate -2 -2 .1 ObjectInstance \"o" +
            std::to_string(i) + "\" AttributeEnd\n";
    }
    RenderSettings settings;
    settings.integrator = "path:maxdepth=4";
    settings.samples = 4;
    settings.resolution = {64, 64};
    expect_same(render_text(scene, settings), render_text(scene, in_vectors(settings)));
}

struct SmallImage {
    std::string scene, integrator, photon_map;
};
using Images = std::vector<SmallImage>;
class VectorImages : public testing::TestWithParam<SmallImage> {};

Images by_path(const std::vector<std::string>& scenes) {
    Images all;
    for (const std::string& scene : scenes) all.push_back({scene, "path:maxdepth=8", ""});
    return all;
}

Images by_every_integrator(const std::vector<std::string>& scenes) {
    Images all;
    for (const std::string& scene : scenes)
        for (const char* integrator : {"bdpt:maxdepth=5", "vcm:maxdepth=5", "bpm:maxdepth=5", "light:maxdepth=5",
                                       "mlt:maxdepth=5,bootstrapsamples=1000", "sppm:photonsperiteration=2000",
                                       "ppm:photonsperiteration=2000", "photon_map:photons=2000,gather=4", "ao"})
            all.push_back({scene, integrator, ""});
    return all;
}

// But for brute_force, whose sums depend on the order in which photons are stored: vectors store those of eight paths by turns.
Images by_every_photon_map(const std::string& scene) {
    Images all;
    for (const std::string& map : photon_maps().names())
        if (map != "brute_force") all.push_back({scene, "sppm:photonsperiteration=2000", map});
    return all;
}

std::vector<std::string> other_small_scenes() {
    std::vector<std::string> others;
    for (const std::string& scene : small_scenes())
        if (std::ranges::find(scenes_of_all_effects(), scene) == scenes_of_all_effects().end()) others.push_back(scene);
    return others;
}

std::string name_of(const testing::TestParamInfo<SmallImage>& info) {
    const SmallImage& image = info.param;
    return test_name(image.scene + " " + image.integrator.substr(0, image.integrator.find(':')) + " " +
                     image.photon_map);
}

INSTANTIATE_TEST_SUITE_P(Scenes, VectorImages, testing::ValuesIn(by_path(scenes_of_all_effects())), name_of);
INSTANTIATE_TEST_SUITE_P(LongScenes, VectorImages, testing::ValuesIn(by_path(other_small_scenes())), name_of);
INSTANTIATE_TEST_SUITE_P(Integrators, VectorImages, testing::ValuesIn(by_every_integrator({"reference/instances"})),
                         name_of);
INSTANTIATE_TEST_SUITE_P(LongIntegrators, VectorImages,
                         testing::ValuesIn(by_every_integrator({"reference/dielectric-rough", "reference/textures"})),
                         name_of);
INSTANTIATE_TEST_SUITE_P(PhotonMaps, VectorImages, testing::ValuesIn(by_every_photon_map("reference/point-spot")),
                         name_of);

TEST_P(VectorImages, AreTheSame) {
    RenderSettings settings;
    settings.integrator = GetParam().integrator;
    settings.photon_map = GetParam().photon_map;
    settings.samples = 3;
    settings.resolution = {37, 23};
    const std::string scene = scene_path(GetParam().scene);
    expect_same(render_file(scene, settings), render_file(scene, in_vectors(settings)));
}

}  // namespace
}  // namespace lampyris::test
