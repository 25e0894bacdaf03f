// Every function of math.h gives the same bits on the CPU and on Vulkan.
#include "core/base/error.h"
#include "core/device/device.h"

#include <fmt/format.h>
#include <glm/vec4.hpp>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

namespace lampyris {
namespace {

constexpr uint32_t kFunctions = 13;
constexpr uint32_t kCount = 100'000;

// Numbers of order one, of many exponents, zeros and exact integers. Nothing so small that a result is denormal: those are
// flushed on the CPU backend and by some drivers (Mesa 25), but not by all (Mesa 22).
std::vector<glm::vec4> make_inputs() {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> near_one(-4.0f, 4.0f);
    std::uniform_int_distribution<uint32_t> bits;
    std::vector<glm::vec4> inputs(kCount);
    for (uint32_t i = 0; i < kCount; ++i) {
        for (int c = 0; c < 4; ++c) {
            float& x = inputs[i][c];
            switch (i % 8) {
                case 0:
                case 1:
                case 2: x = near_one(random); break;
                case 3: x = std::bit_cast<float>((bits(random) & 0x87ffffffu) | 0x38000000u); break;  // about 3e-5 to 2
                case 4:
                case 5: x = std::ldexp(near_one(random), int(bits(random) % 60) - 30); break;
                case 6: x = float(int(bits(random) % 17) - 8); break;
                default: x = near_one(random) * 100.0f;
            }
        }
    }
    return inputs;
}

std::vector<glm::vec4> evaluate(Device& device, const std::vector<glm::vec4>& inputs, uint32_t function) {
    const auto in = device.create_buffer(inputs.size() * sizeof(inputs[0]), "inputs");
    const auto choice = device.create_buffer(16, "choice");
    const auto out = device.create_buffer(inputs.size() * sizeof(inputs[0]), "results");
    in->upload(inputs.data(), in->size());
    const uint32_t words[4] = {function, 0, 0, 0};
    choice->upload(words, sizeof words);
    const auto kernel = device.compile("kernel/math_bits.kernel.h", 0);
    const NamedBuffer buffers[] = {{"inputs", in}, {"choices", choice}, {"results", out}};
    device.run(*kernel, nullptr, buffers, 0, uint32_t(inputs.size()));
    std::vector<glm::vec4> results(inputs.size());
    out->download(results.data(), out->size());
    return results;
}

// A canonical form: a zero, a NaN whatever its payload, or a number; these can be compared by their bits.
uint32_t canonical(float x) {
    const uint32_t bits = std::bit_cast<uint32_t>(x);
    if ((bits & 0x7fffffffu) > 0x7f800000u) return 0x7fc00000u;
    if ((bits & 0x7f800000u) == 0) return 0;  // denormals are flushed, and the sign of a flushed zero decides nothing
    return bits;
}

// Whether a device's own quotients are exact or those of exact.glsl: `exact` is the setting.
class MathBits : public testing::TestWithParam<const char*> {};

TEST_P(MathBits, AgreeAcrossBackends) {
    const auto cpu = create_device("cpu");
    std::unique_ptr<Device> vulkan;
    DeviceOptions options;
    options.settings["exact"] = GetParam();
    try {
        vulkan = create_device("vulkan", options);
    } catch (const MachineError& error) {
        GTEST_SKIP() << error.what();
    }
    const auto inputs = make_inputs();
    for (uint32_t function = 0; function < kFunctions; ++function) {
        const auto a = evaluate(*cpu, inputs, function), b = evaluate(*vulkan, inputs, function);
        uint32_t different = 0;
        std::string first;
        for (uint32_t i = 0; i < kCount; ++i) {
            for (int c = 0; c < 4; ++c) {
                if (canonical(a[i][c]) == canonical(b[i][c])) continue;
                if (different++ < 3) {
                    first += fmt::format("\n  of ({:a}, {:a}, {:a}, {:a}) component {}: {:a} and {:a}", inputs[i].x,
                                         inputs[i].y, inputs[i].z, inputs[i].w, c, a[i][c], b[i][c]);
                }
            }
        }
        EXPECT_EQ(different, 0u) << "function " << function << first;
    }
}

INSTANTIATE_TEST_SUITE_P(Exact, MathBits, testing::Values("auto", "on"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace lampyris
