// Kernels that run in vectors give what the scalar builds give, to the bit. Nothing is random: seeds are fixed.
#include "support/agreement.h"
#include "support/device_run.h"

#include <gtest/gtest.h>

#include <random>

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
        const NamedBuffer buffers[] = {
            {"numbers", in}, {"results", results}, {"sums", device->create_buffer(16, "sums")}};
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

class VectorImages : public testing::TestWithParam<std::pair<std::string, std::string>> {};

std::vector<std::pair<std::string, std::string>> images() {
    std::vector<std::pair<std::string, std::string>> all;
    for (const std::string& scene : small_scenes()) all.emplace_back(scene, "path:maxdepth=8");
    for (const char* scene : {"reference/dielectric-rough", "reference/textures", "reference/instances"})
        for (const char* integrator : {"bdpt:maxdepth=5", "vcm:maxdepth=5", "bpm:maxdepth=5", "light:maxdepth=5",
                                       "mlt:maxdepth=5,bootstrapsamples=1000", "sppm:photonsperiteration=2000",
                                       "ppm:photonsperiteration=2000", "photon_map:photons=2000,gather=4", "ao"})
            all.emplace_back(scene, integrator);
    return all;
}

INSTANTIATE_TEST_SUITE_P(Scenes, VectorImages, testing::ValuesIn(images()), [](const auto& info) {
    return test_name(info.param.first + " " + info.param.second.substr(0, info.param.second.find(':')));
});

TEST_P(VectorImages, AreTheSame) {
    RenderSettings settings;
    settings.integrator = GetParam().second;
    settings.samples = 3;
    settings.resolution = {37, 23};
    const std::string file = scene_path(GetParam().first);
    const Rendered scalar = render_file(file, settings);
    settings.device_settings["vectors"] = "on";
    const Rendered vectors = render_file(file, settings);
    ASSERT_EQ(scalar.pixels.size(), vectors.pixels.size());
    size_t different = 0;
    for (size_t i = 0; i < scalar.pixels.size(); ++i)
        different += std::memcmp(&scalar.pixels[i], &vectors.pixels[i], sizeof(scalar.pixels[i])) != 0;
    EXPECT_EQ(different, 0u);
    EXPECT_EQ(scalar.summary.rays, vectors.summary.rays);
}

}  // namespace
}  // namespace lampyris::test
