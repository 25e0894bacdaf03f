// Lights at a point, distant lights, pictures of light, emission textures and masks, and the choice between lights.
#include "core/scene/lights/common.h"
#include "support/light_probe.h"
#include "support/statistics.h"

#include <gtest/gtest.h>

#include <numbers>

namespace lampyris::test {
namespace {

using glm::dmat4;
using glm::dvec3;
using glm::vec3;
using glm::vec4;

constexpr double kPi = std::numbers::pi;

kernel::LightRecord record(uint32_t kind, uint32_t image = kernel::NONE, uint32_t transform = kernel::NONE) {
    kernel::LightRecord light{};
    light.kind = kind;
    light.image = image;
    light.transform = transform;
    return light;
}

// The only sample of a light at a point.
LightAnswer only_sample(Device& device, TestScene& scene, vec3 ref_p) {
    constexpr uint64_t kEffects =
        kernel::EFFECT_POINT_LIGHTS | kernel::EFFECT_DISTANT_LIGHTS | kernel::EFFECT_PROJECTION_LIGHTS;
    LightAsker asker(device, light_probe(device, kEffects), scene.finish());
    return asker.sample(ref_p, 1)[0];
}

TEST(Lights, PointsShineByTheInverseSquare) {
    for (const std::string& backend : kernel_backends()) {
        SCOPED_TRACE(backend);
        const auto device = create_device(backend);
        TestScene scene;
        auto light = record(kernel::LIGHT_POINT);
        light.p0 = vec3(1, 2, 3);
        scene.add_light(light, vec3(5));
        const auto s = only_sample(*device, scene, vec3(1, -1, 7));
        EXPECT_NEAR(s.radiance, 5.0 / 25, 1e-6);
        EXPECT_NEAR(s.distance, 5, 1e-6);
        EXPECT_EQ(s.pdf, 1);
        EXPECT_LT(glm::length(s.wi - vec3(0, 0.6f, -0.8f)), 1e-6f);
    }
}

// pbrt's spot: full inside conedelta, nothing outside the cone, a smoothstep in the cosine between (section 12.2.1). Narrow beams,
// whose cosines are all 1 as floats, are like others.
TEST(Lights, SpotsFallOffSmoothly) {
    for (const std::string& backend : kernel_backends()) {
        SCOPED_TRACE(backend);
        const auto device = create_device(backend);
        for (const double cone : {30.0, 1.0, 0.01, 0.001}) {
            const auto one_minus_cos = [](double degrees) { return 2 * std::pow(std::sin(degrees * kPi / 360), 2); };
            const double outer = one_minus_cos(cone), inner = one_minus_cos(2 * cone / 3);
            for (const double part : {0.0, 0.66, 0.74, 0.83, 0.96, 1.01, 3.0, 6.0}) {
                SCOPED_TRACE(cone * part);
                TestScene scene;
                auto light = record(kernel::LIGHT_SPOT);
                set_spot(light, vec3(0, 0, -1), float(inner), float(outer));
                scene.add_light(light, vec3(3));
                const double a = cone * part * kPi / 180;
                const auto s = only_sample(*device, scene, 2.0f * vec3(std::sin(a), 0, -std::cos(a)));
                const double t = std::clamp((outer - one_minus_cos(cone * part)) / (outer - inner), 0.0, 1.0);
                const double expected = 3.0 / 4 * t * t * (3 - 2 * t);
                EXPECT_NEAR(s.pdf > 0 ? s.radiance : 0.0f, expected, 1e-5);
            }
        }
    }
}

TEST(Lights, DistantLightsComeFromTheirDirection) {
    for (const std::string& backend : kernel_backends()) {
        SCOPED_TRACE(backend);
        const auto device = create_device(backend);
        TestScene scene;
        auto light = record(kernel::LIGHT_DISTANT);
        light.p0 = vec3(0.6f, 0, 0.8f);
        scene.add_light(light, vec3(7));
        const auto s = only_sample(*device, scene, vec3(100, -50, 3));
        EXPECT_EQ(s.radiance, 7);
        EXPECT_EQ(s.pdf, 1);
        EXPECT_EQ(s.wi, vec3(0.6f, 0, 0.8f));
        EXPECT_GE(s.distance, 3e38f);
    }
}

// A picture of 2 x 2: its first row is on top (+y of light space), its first column at -x; nothing falls beside or behind.
TEST(Lights, ProjectionsShowThePictureUpright) {
    struct Place {
        vec3 direction;  // in light space
        float expected;
    };
    const std::vector<Place> places = {{{-0.2f, 0.1f, 1}, 1}, {{0.2f, 0.1f, 1}, 2},  {{-0.2f, -0.1f, 1}, 3},
                                       {{0.2f, -0.1f, 1}, 4}, {{0.55f, 0.1f, 1}, 0}, {{0.2f, -0.3f, 1}, 0},
                                       {{0.2f, 0.1f, -1}, 0}, {{0.4f, 0.2f, 2}, 2}};
    for (const std::string& backend : kernel_backends()) {
        SCOPED_TRACE(backend);
        const auto device = create_device(backend);
        const dmat4 to_world =
            glm::rotate(glm::translate(dmat4(1.0), dvec3(1, 2, 3)), 1.1, glm::normalize(dvec3(1, 1, 0)));
        for (const Place& place : places) {
            SCOPED_TRACE(place.expected);
            TestScene scene;
            const uint32_t image = scene.add_image({1, 2, 3, 4}, 2, 2, kernel::WRAP_BLACK);
            scene.scene.transforms.push_back(transform_of(to_world));
            auto light = record(kernel::LIGHT_PROJECTION, image, 1);
            light.p0 = vec3(1, 2, 3);
            set_projection_window(light, vec4(-0.5f, -0.25f, 0.5f, 0.25f));
            scene.add_light(light, vec3(10));
            const dvec3 p = to_world * glm::dvec4(dvec3(place.direction), 1.0);
            const auto s = only_sample(*device, scene, vec3(p));
            const double d2 = glm::dot(dvec3(place.direction), dvec3(place.direction));
            EXPECT_NEAR(s.pdf > 0 ? s.radiance : 0.0f, 10 * place.expected / d2, 2e-5 * 10 * place.expected);
        }
    }
}

// The pole of a goniometric image is the light's y axis (pbrt swaps y and z); the octants about it are the image's quarters.
TEST(Lights, GoniometricImagesHaveTheirPoleUp) {
    // Equal-area octahedral map of 4 x 4: the inner diamond is the upper hemisphere, the corners the lower one.
    std::vector<float> picture(16);
    for (int i = 0; i < 16; ++i) picture[size_t(i)] = float(i + 1);
    struct Place {
        vec3 direction;
        int x, y;
    };
    // (d.x, d.z, d.y) near the pole is the square's middle, x to the right, the image's y downwards along the map's v.
    const std::vector<Place> places = {{{0.1f, 1, 0.1f}, 2, 2},   {{-0.1f, 1, 0.1f}, 1, 2},  {{0.1f, 1, -0.1f}, 2, 1},
                                       {{-0.1f, 1, -0.1f}, 1, 1}, {{0.1f, -1, 0.1f}, 3, 3},  {{-0.1f, -1, 0.1f}, 0, 3},
                                       {{0.1f, -1, -0.1f}, 3, 0}, {{-0.1f, -1, -0.1f}, 0, 0}};
    for (const std::string& backend : kernel_backends()) {
        SCOPED_TRACE(backend);
        const auto device = create_device(backend);
        for (const Place& place : places) {
            TestScene scene;
            const uint32_t image = scene.add_image(picture, 4, 4, kernel::WRAP_OCTAHEDRAL);
            scene.add_light(record(kernel::LIGHT_GONIOMETRIC, image, 0), vec3(2));
            const auto s = only_sample(*device, scene, place.direction);
            const float d2 = glm::dot(place.direction, place.direction);
            EXPECT_NEAR(s.radiance, 2 * picture[size_t(4 * place.y + place.x)] / d2, 1e-4);
        }
    }
}

// Lights of different power and kind together give the sum of what each gives, and each is chosen with its stated probability.
TEST(Lights, ManyLightsAddUp) {
    for (const std::string& backend : kernel_backends()) {
        SCOPED_TRACE(backend);
        const auto device = create_device(backend);
        TestScene scene;
        auto environment = record(kernel::LIGHT_INFINITE);
        scene.add_light(environment, vec3(0.25f), 5);
        scene.scene.record.infinite_lights = 1;
        scene.add_area_light(scene.add_quadric(kernel::GEOMETRY_DISK, {2, 1, 0, float(2 * kPi)}), vec3(3),
                             kernel::LIGHT_TWO_SIDED);
        auto point = record(kernel::LIGHT_POINT);
        point.p0 = vec3(0, 0, 2);
        scene.add_light(point, vec3(1), 0.1f);
        auto dark = record(kernel::LIGHT_POINT);
        scene.add_light(dark, vec3(1), 0.0f);  // no power: never chosen
        LightAsker asker(*device,
                         light_probe(*device, kernel::EFFECT_ENVIRONMENT | kernel::EFFECT_AREA_LIGHTS |
                                                  kernel::EFFECT_QUADRIC_LIGHTS | kernel::EFFECT_QUADRICS |
                                                  kernel::EFFECT_POINT_LIGHTS),
                         scene.finish());
        float sum = 0;
        for (const auto& light : scene.scene.lights) sum += light.choice_probability;
        EXPECT_NEAR(sum, 1, 1e-6);
        EXPECT_EQ(scene.scene.lights[3].choice_probability, 0);
        EXPECT_GT(scene.scene.lights[2].choice_probability, 0.01f);
        Mean mean;
        constexpr int kSamples = 200000;
        std::array<double, 3> chosen{};
        for (const LightAnswer& s : asker.sample(vec3(0), kSamples, 5)) {
            mean.add(s.pdf > 0 ? s.radiance * std::max(0.0f, s.wi.z) / s.pdf : 0.0);
            chosen[s.distance >= 3e38f ? 0 : s.distance == 2.0f ? 2 : 1] += 1;
        }
        const double expected = 0.25 * kPi + 3 * kPi / 5 + 0.25;
        EXPECT_LT(std::abs(mean.value() - expected), normal_threshold(1e-7) * mean.error());
        EXPECT_LT(mean.error(), 0.01 * expected);
        std::array<double, 3> counts{};
        for (size_t i = 0; i < 3; ++i) counts[i] = kSamples * double(scene.scene.lights[i].choice_probability);
        EXPECT_GT(chi_squared_test(chosen, counts).p, 1e-7);
    }
}

// A picture as emission: the left half of a square shines, and a mask takes half of it.
TEST(Lights, EmissionHasTexturesAndMasks) {
    for (const std::string& backend : kernel_backends()) {
        SCOPED_TRACE(backend);
        const auto device = create_device(backend);
        TestScene scene;
        const uint32_t image = scene.add_image({4, 0}, 2, 1, kernel::WRAP_CLAMP);
        kernel::TextureOp op{};
        op.operation = kernel::TEXTURE_IMAGE;
        op.flags = 1 | kernel::MAPPING_UV << 8;
        op.image = image;
        op.a = vec4(1);
        op.m0 = vec4(1, 1, 0, 0);
        scene.scene.texture_ops.push_back(op);
        const uint32_t patch = scene.add_polygon<4>({vec3(-1, -1, 1), vec3(1, -1, 1), vec3(-1, 1, 1), vec3(1, 1, 1)});
        scene.scene.geometries[patch].alpha = 0.5f;
        scene.add_area_light(patch, vec3(0.5f), kernel::LIGHT_TWO_SIDED);
        scene.scene.lights[0].image = 0;
        LightAsker asker(
            *device,
            light_probe(*device, kernel::EFFECT_AREA_LIGHTS | kernel::EFFECT_QUADRIC_LIGHTS | kernel::EFFECT_BILINEAR |
                                     kernel::EFFECT_LIGHT_TEXTURES | kernel::EFFECT_IMAGES | kernel::EFFECT_ALPHA),
            scene.finish());
        Mean mean;
        for (const LightAnswer& s : asker.sample(vec3(0), 100000, 5)) {
            if (s.pdf > 0) {
                EXPECT_LT(s.wi.x, 1e-5f);
            }
            mean.add(s.pdf > 0 ? s.radiance * s.wi.z / s.pdf : 0.0);
        }
        // Corner form factor of a 1 x 1 square at height 1, twice.
        const double corner = (1 / std::sqrt(2.0) * std::atan(1 / std::sqrt(2.0)) * 2) / (2 * kPi);
        const double expected = kPi * corner * 2 * (0.5 * 4 * 0.5);
        EXPECT_LT(std::abs(mean.value() - expected), normal_threshold(1e-7) * mean.error());
        EXPECT_LT(mean.error(), 0.01 * expected);
        // Seen directly, it is bright on the left; masks are handled by the tracer.
        const auto seen = asker.look(vec3(0), {vec4(-0.5f, 0, 1, 0), vec4(0.5f, 0, 1, 0)});
        EXPECT_NEAR(seen[0].radiance, 2, 1e-6);
        EXPECT_EQ(seen[1].radiance, 0);
    }
}

// A light that is far, tiny or huge is sampled at its real position, with finite densities.
TEST(Lights, ExtremeSizesStayFinite) {
    for (const std::string& backend : kernel_backends()) {
        const auto device = create_device(backend);
        const KernelHandle probe = light_probe(*device, kernel::EFFECT_QUADRICS | kernel::EFFECT_BILINEAR |
                                                            kernel::EFFECT_AREA_LIGHTS | kernel::EFFECT_QUADRIC_LIGHTS);
        for (const double distance : {1e-3, 1.0, 1e6}) {
            for (const double ratio : {1e-4, 1.0, 1e3}) {
                for (int kind = 0; kind < 4; ++kind) {
                    SCOPED_TRACE(::testing::Message()
                                 << backend << " distance " << distance << " ratio " << ratio << " kind " << kind);
                    const auto r = float(ratio * distance);
                    const auto z = float(distance + (kind == 0 ? r : 0));
                    TestScene scene;
                    const dmat4 to = glm::translate(dmat4(1.0), dvec3(0, 0, z));
                    uint32_t geometry = 0;
                    if (kind == 0)
                        geometry = scene.add_quadric(kernel::GEOMETRY_SPHERE, {r, -r, r, float(2 * kPi)}, to);
                    if (kind == 1) geometry = scene.add_quadric(kernel::GEOMETRY_DISK, {0, r, 0, float(2 * kPi)}, to);
                    if (kind == 2)
                        geometry =
                            scene.add_polygon<4>({vec3(-r, -r, z), vec3(r, -r, z), vec3(-r, r, z), vec3(r, r, z)});
                    if (kind == 3) geometry = scene.add_polygon<3>({vec3(-r, -r, z), vec3(r, -r, z), vec3(0, r, z)});
                    scene.add_area_light(geometry, vec3(1), kernel::LIGHT_TWO_SIDED);
                    LightAsker asker(*device, probe, scene.finish());
                    int found = 0;
                    for (const LightAnswer& s : asker.sample(vec3(0), 200, 5)) {
                        if (!(s.pdf > 0)) continue;
                        ++found;
                        EXPECT_TRUE(std::isfinite(s.pdf));
                        EXPECT_NEAR(glm::length(s.wi), 1, 1e-5);
                        EXPECT_GT(s.wi.z, 0);
                        EXPECT_GT(s.distance, 0.99 * distance);
                        EXPECT_LT(s.distance, 1.01 * std::hypot(distance, 1.5 * r));
                    }
                    EXPECT_GT(found, 150);
                }
            }
        }
    }
}

}  // namespace
}  // namespace lampyris::test
