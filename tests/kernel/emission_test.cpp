// Photons bring as much light to a surface as next-event estimation finds there, whatever the light: two estimators that share
// no density. The disk is not occluded, and receives both.
//
// False-alarm rate: 14 lights x backends x 3 channels at 1e-7 each, fixed seeds. Power: both sides are known to about 0.5 %, so
// that a wrong factor (pi, 2, a missing cosine, a probability) of more than 4 % fails nearly always.
#include "support/build_text.h"
#include "support/device_run.h"
#include "support/statistics.h"

#include <gtest/gtest.h>

#include <glm/glm.hpp>

#include <array>
#include <cmath>

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

TEST(Emission, PhotonsBringTheLightThatLightsSend) {
    const double limit = normal_threshold(kAlpha);
    for (const std::string& backend : usable_backends()) {
        const auto device = create_device(backend);
        for (const LightCase& c : cases()) {
            SCOPED_TRACE(backend + ", " + c.name);
            const BuiltText text = build_world(c.text);
            ASSERT_TRUE(text.errors.empty()) << text.all_errors();
            const DeviceSceneHandle scene = device->upload(text.scene());
            const KernelHandle kernel = device->compile("kernel/emission_probe.kernel.h", text.scene().effects.mask());
            const BufferHandle out = device->create_buffer(kSamples * sizeof(glm::vec4), "results");
            std::array<std::array<Mean, 3>, 2> flux;
            for (uint32_t how : {0u, 1u}) {
                const Probe probe{
                    {how, 17 + how, 0, 0}, {0, 0, 0, 0.8f}, glm::vec4(glm::normalize(glm::vec3(0.2f, -0.1f, 1.0f)), 0)};
                const NamedBuffer buffers[] = {{"probe", upload(*device, std::vector{probe}, "probe")},
                                               {"results", out}};
                device->run(*kernel, scene.get(), buffers, 0, kSamples);
                for (const glm::vec4& r : download<glm::vec4>(out, kSamples))
                    for (int channel = 0; channel < 3; ++channel) flux[how][size_t(channel)].add(double(r[channel]));
            }
            for (size_t channel = 0; channel < 3; ++channel) {
                const Mean &photons = flux[0][channel], &lights = flux[1][channel];
                ASSERT_GT(lights.value(), 0);
                const double error = std::hypot(photons.error(), lights.error());
                EXPECT_LT(std::abs(photons.value() - lights.value()), limit * error)
                    << "photons " << photons.value() << " +- " << photons.error() << ", lights " << lights.value()
                    << " +- " << lights.error();
                EXPECT_LT(error, 0.015 * lights.value());  // the test can tell
            }
        }
    }
}

}  // namespace
}  // namespace lampyris::test
