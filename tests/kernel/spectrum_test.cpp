// Spectrum has as many values as a kernel says, at no cost to kernels that have three: the same functions with four wavelengths compute
// in each what they compute in each of three.
#include "core/device/device.h"
#include "support/device_run.h"

#include <gtest/gtest.h>

#include <glm/vec4.hpp>

#include <cstring>
#include <random>

namespace lampyris::test {
namespace {

constexpr uint32_t kWalks = 64;

std::vector<glm::vec4> run(Device& device, const char* file, const std::vector<glm::vec4>& inputs) {
    const auto kernel = device.compile(file, 0);
    const BufferHandle in = upload(device, inputs, "inputs");
    const BufferHandle out = device.create_buffer(kWalks * sizeof(glm::vec4), "results");
    const NamedBuffer buffers[] = {{"inputs", in}, {"results", out}};
    device.run(*kernel, nullptr, buffers, 0, kWalks);
    return download<glm::vec4>(out, kWalks);
}

// Each input's components, moved by one: the fourth wavelength becomes the first.
std::vector<glm::vec4> turned(std::vector<glm::vec4> inputs) {
    for (size_t i = 0; i < inputs.size(); ++i)
        if (i % 4 != 3) inputs[i] = {inputs[i].w, inputs[i].x, inputs[i].y, inputs[i].z};
    return inputs;
}

class SpectrumOn : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, SpectrumOn, testing::ValuesIn(kernel_backends()), [](const auto& info) {
    return info.param == "cpu-bvh2" ? std::string("cpu_bvh2") : info.param;
});

TEST_P(SpectrumOn, FourWavelengthsAreAsThree) {
    std::mt19937 rng(7);
    std::uniform_real_distribution<float> index(0.1f, 4.0f), absorption(0.0f, 2.0f), cosine(0.05f, 1.0f);
    std::vector<glm::vec4> inputs;
    for (uint32_t i = 0; i < kWalks; ++i) {
        inputs.emplace_back(index(rng), index(rng), index(rng), index(rng));
        inputs.emplace_back(index(rng), index(rng), index(rng), index(rng));
        inputs.emplace_back(absorption(rng), absorption(rng), absorption(rng), absorption(rng));
        inputs.emplace_back(cosine(rng));
    }
    const auto device = create_device(GetParam(), exact_options(GetParam()));
    const std::vector<glm::vec4> three = run(*device, "kernel/spectrum_three.kernel.h", inputs);
    const std::vector<glm::vec4> moved = run(*device, "kernel/spectrum_three.kernel.h", turned(inputs));
    const std::vector<glm::vec4> four = run(*device, "kernel/spectrum_four.kernel.h", inputs);
    for (uint32_t i = 0; i < kWalks; ++i) {
        SCOPED_TRACE(i);
        for (int c = 0; c < 3; ++c) EXPECT_EQ(four[i][c], three[i][c]);
        EXPECT_EQ(four[i].w, moved[i].x);
        EXPECT_EQ(three[i].w, std::max({three[i].x, three[i].y, three[i].z}));
        // No two of the random indices are alike, nor what they reflect, unless both are clamped to 0.9.
        const auto differ = [](float a, float b) { return a != b || a == 0.9f; };
        EXPECT_TRUE(differ(three[i].x, three[i].y) && differ(three[i].y, three[i].z) && differ(three[i].z, four[i].w));
        EXPECT_GT(three[i].x, 0.0f);
    }
}

}  // namespace
}  // namespace lampyris::test
