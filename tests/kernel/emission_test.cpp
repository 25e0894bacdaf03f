// Photons bring as much light to a surface as next-event estimation finds there, whatever the light: two estimators that share
// no density. The disk is not occluded, and receives both.
//
// False-alarm rate: 14 lights x 3 channels at 1e-7 each, fixed seeds. Power: both sides are known to about 0.5 %, so
// that a wrong factor (pi, 2, a missing cosine, a probability) of more than 4 % fails nearly always.
#include "support/build_text.h"
#include "support/device_run.h"
#include "support/statistics.h"

#include <gtest/gtest.h>

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace lampyris::test {
namespace {

constexpr double kAlpha = 1e-7;
constexpr uint32_t kSamples = 400000;

struct Probe {
    glm::uvec4 what;
    glm::vec4 centre, normal;
};

struct LightCase {
    const char* name;
    std::string text;
};

// The disk has radius 0.8 about the origin and faces +z, tilted; lights are above it.
std::vector<LightCase> cases() {
    const std::string matte = "Material \"diffuse\"\n";
    const auto area = [&](const std::string& shape, const std::string& light = "\"rgb L\" [ 3 2 1 ]") {
        return matte + "AttributeBegin\nAreaLightSource \"diffuse\" " + light + "\n" + shape + "\nAttributeEnd\n";
    };
    const std::string triangle =
        "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 2  1 -1 2.4  0 1.2 1.7 ] \"integer indices\" [ 0 2 1 ]";
    const std::string picture = std::string(LAMPYRIS_SOURCE_DIR) + "/scenes/reference/texture.png";
    const std::string sky = std::string(LAMPYRIS_SOURCE_DIR) + "/scenes/reference/sky.exr";
    const std::string far_shape = "Shape \"sphere\" \"float radius\" 0.01\n";  // gives the scene an extent
    return {
        {"triangle", area(triangle)},
        {"two-sided triangle", area(triangle, "\"rgb L\" [ 1 2 3 ] \"bool twosided\" true")},
        {"textured light", area(triangle, "\"string filename\" \"" + picture + "\"")},
        {"masked light",
         matte + "AttributeBegin\nAreaLightSource \"diffuse\"\n" + triangle + " \"float alpha\" 0.4\nAttributeEnd\n"},
        {"sphere", area("Translate 0.3 0 2\nScale 1 0.6 0.8\nShape \"sphere\" \"float radius\" 0.7")},
        {"disk", area("Translate 0 0.3 2\nReverseOrientation\nShape \"disk\" \"float radius\" 0.6")},
        {"cylinder", area("Translate 0 0 2\nRotate 80 1 0 0\nShape \"cylinder\" \"float radius\" 0.3")},
        {"patch", area("Shape \"bilinearmesh\" \"point3 P\" [ -1 -1 2  1 -1 2.3  -1 1 2.2  1 1 1.8 ]",
                       "\"bool twosided\" true")},
        {"several lights", area(triangle) + area("Translate -2 0 1\nShape \"sphere\" \"float radius\" 0.3") +
                               "LightSource \"point\" \"point3 from\" [ 1 1 1.5 ] \"rgb I\" [ 1 2 3 ]\n"},
        {"point", "LightSource \"point\" \"point3 from\" [ 0.5 0.2 1.2 ] \"rgb I\" [ 1 2 3 ]\n" + matte + far_shape},
        {"spot",
         "LightSource \"spot\" \"point3 from\" [ 0.5 0.2 1.5 ] \"point3 to\" [ 0 0 0 ] \"float coneangle\" 35 "
         "\"float conedeltaangle\" 20\n" +
             matte + far_shape},
        {"projection",
         "AttributeBegin\nTranslate 0 0 2\nRotate 180 1 0 0\nLightSource \"projection\" \"float fov\" 70 \"string "
         "filename\" \"" +
             picture + "\"\nAttributeEnd\n" + matte + far_shape},
        {"distant",
         "LightSource \"distant\" \"point3 from\" [ 1 0.5 3 ] \"point3 to\" [ 0 0 0 ] \"rgb L\" [ 1 2 3 ]\n" + matte +
             "Shape \"sphere\" \"float radius\" 2\n"},
        {"sky", "LightSource \"infinite\" \"string filename\" \"" + sky +
                    "\"\nLightSource \"infinite\" \"rgb L\" [ 0.3 0.2 0.1 ]\n" + matte +
                    "Shape \"sphere\" \"float radius\" 2\n"},
    };
}

using Samples = std::array<std::vector<glm::vec4>, 2>;  // of photons, and of lights

Samples samples_of(Device& device, const Scene& world, uint32_t count) {
    const DeviceSceneHandle scene = device.upload(world);
    const KernelHandle kernel = device.compile("kernel/emission_probe.kernel.h", world.effects.mask());
    const BufferHandle out = device.create_buffer(count * sizeof(glm::vec4), "results");
    Samples samples;
    for (uint32_t how : {0u, 1u}) {
        const Probe probe{
            {how, 17 + how, 0, 0}, {0, 0, 0, 0.8f}, glm::vec4(glm::normalize(glm::vec3(0.2f, -0.1f, 1.0f)), 0)};
        const NamedBuffer buffers[] = {{"probe", upload(device, std::vector{probe}, "probe")}, {"results", out}};
        device.run(*kernel, scene.get(), buffers, 0, count);
        samples[how] = download<glm::vec4>(out, count);
    }
    return samples;
}

TEST(Emission, PhotonsBringTheLightThatLightsSend) {
    const double limit = normal_threshold(kAlpha);
    const auto device = create_device("cpu");
    for (const LightCase& c : cases()) {
        SCOPED_TRACE(c.name);
        const BuiltText text = build_world(c.text);
        ASSERT_TRUE(text.errors.empty()) << text.all_errors();
        const Samples samples = samples_of(*device, text.scene(), kSamples);
        std::array<std::array<Mean, 3>, 2> flux;
        for (uint32_t how : {0u, 1u})
            for (const glm::vec4& r : samples[how])
                for (int channel = 0; channel < 3; ++channel) flux[how][size_t(channel)].add(double(r[channel]));
        for (size_t channel = 0; channel < 3; ++channel) {
            const Mean &photons = flux[0][channel], &lights = flux[1][channel];
            ASSERT_GT(lights.value(), 0);
            const double error = std::hypot(photons.error(), lights.error());
            EXPECT_LT(std::abs(photons.value() - lights.value()), limit * error)
                << "photons " << photons.value() << " +- " << photons.error() << ", lights " << lights.value() << " +- "
                << lights.error();
            EXPECT_LT(error, 0.015 * lights.value());  // the test can tell
        }
    }
}

// On other backends, the first ones of these samples are the same, up to those that diverge (docs/determinism.md): a wrong factor would
// change all of them.
// Lights of the same effects are left out, since a driver compiles for seconds for each.
const std::vector<std::string> kDifferent{"textured light", "masked light", "patch", "several lights",
                                          "spot",           "projection",   "sky"};

TEST(Emission, OtherBackendsHaveTheSameSamples) {
    constexpr uint32_t kFew = 10000;
    const auto cpu = create_device("cpu");
    for (const std::string& backend : kernel_backends()) {
        if (backend == "cpu") continue;
        const auto device = create_device(backend, exact_options(backend));
        for (const LightCase& c : cases()) {
            if (std::find(kDifferent.begin(), kDifferent.end(), c.name) == kDifferent.end()) continue;
            SCOPED_TRACE(backend + ", " + c.name);
            const BuiltText text = build_world(c.text);
            ASSERT_TRUE(text.errors.empty()) << text.all_errors();
            const Samples expected = samples_of(*cpu, text.scene(), kFew),
                          found = samples_of(*device, text.scene(), kFew);
            for (uint32_t how : {0u, 1u}) {
                uint32_t equal = 0, lit = 0;
                for (uint32_t i = 0; i < kFew; ++i) {
                    equal += expected[how][i] == found[how][i];
                    lit += expected[how][i].x > 0.0f;
                }
                EXPECT_GE(equal, kFew - kFew / 1000);
                EXPECT_GT(lit, kFew / 100);  // zeros show nothing
            }
        }
    }
}

}  // namespace
}  // namespace lampyris::test
