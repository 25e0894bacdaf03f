// The tree by which kernels choose one of many lights (core/kernel/light_tree.h).
//
// False alarms: 1e-7 a chi-squared test, 12 of them; fixed seeds.
#include "support/build_text.h"
#include "support/device_run.h"
#include "support/statistics.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <random>

namespace lampyris::test {
namespace {

// Binary layout of LightTreeProbe in the kernel.
struct LightTreeProbe {
    glm::uvec4 what;
    glm::vec4 ref_p;
};

class TreeAsker {
 public:
    TreeAsker(const std::string& backend, const Scene& scene)
        : device_(create_device(backend, exact_options(backend))),
          scene_(device_->upload(scene)),
          kernel_(device_->compile("kernel/light_tree_probe.kernel.h", kernel::kAllEffects)),
          lights_(uint32_t(scene.lights.size())) {}

    std::vector<double> probabilities(glm::vec3 p) {
        std::vector<double> found;
        for (const glm::vec2 v : run({0, 0, 0, 0}, p, lights_)) found.push_back(v.x);
        return found;
    }
    struct Choice {
        uint32_t light;
        float probability;
    };
    std::vector<Choice> choices(glm::vec3 p, uint32_t count, uint32_t seed) {
        std::vector<Choice> found;
        for (const glm::vec2 v : run({1, 0, seed, 0}, p, count)) found.push_back({std::bit_cast<uint32_t>(v.x), v.y});
        return found;
    }
    bool arrives(uint32_t light, glm::vec3 p) {
        for (const glm::vec2 v : run({2, light, 7, 0}, p, 16))
            if (v.x != 0) return true;
        return false;
    }

 private:
    std::vector<glm::vec2> run(glm::uvec4 what, glm::vec3 p, uint32_t count) {
        const BufferHandle in = upload(*device_, std::vector{LightTreeProbe{what, glm::vec4(p, 0)}}, "probe");
        const BufferHandle out = device_->create_buffer(size_t(count) * sizeof(glm::vec2), "results");
        const NamedBuffer buffers[] = {{"probe", in}, {"results", out}};
        device_->run(*kernel_, scene_.get(), buffers, 0, count);
        return download<glm::vec2>(out, count);
    }

    std::unique_ptr<Device> device_;
    DeviceSceneHandle scene_;
    KernelHandle kernel_;
    uint32_t lights_;
};

// Lights of every kind, or those of surfaces alone, at random, in [-1, 1]^3 times `size`.
std::string random_lights(int count, uint32_t seed, double size = 1.0, bool surfaces = false) {
    std::mt19937 random(seed);
    const auto number = [&](double low, double high) { return low + (high - low) * (random() / 4294967296.0); };
    std::string text = fmt::format(
        "LightSource \"distant\" \"rgb L\" [ .1 .1 .1 ]\nLightSource \"infinite\" \"rgb L\" [ .01 .01 .01 ]\n"
        "Shape \"sphere\" \"float radius\" {}\n",
        3 * size);
    const std::array<std::string, 7> kinds = {
        "LightSource \"point\" \"rgb I\" [ {0} {0} {0} ]\n",
        "LightSource \"spot\" \"rgb I\" [ {0} {0} {0} ] \"float coneangle\" {1} \"float conedeltaangle\" 5\n",
        "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 {2} 0 0 0 {2} 0 ]\n",
        "Shape \"sphere\" \"float radius\" {2}\n",
        "Shape \"disk\" \"float radius\" {2}\n",
        "Shape \"cylinder\" \"float radius\" {2} \"float zmin\" 0 \"float zmax\" {2}\n",
        "Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0 {2} 0 0 0 {2} 0 {2} {2} {2} ]\n",
    };
    for (int i = 0; i < count; ++i) {
        const double emission = std::pow(10.0, number(-2, 2));
        text += fmt::format("AttributeBegin\nTranslate {} {} {}\nRotate {} {} {} {}\n", size * number(-1, 1),
                            size * number(-1, 1), size * number(-1, 1), number(0, 360), number(-1, 1), number(-1, 1),
                            number(-1, 1));
        if (i % 5 == 4) text += "Scale 1 1 -2\n";
        const size_t kind = surfaces ? 2 + size_t(i) % (kinds.size() - 2) : size_t(i) % kinds.size();
        if (kind >= 2)
            text += fmt::format("AreaLightSource \"diffuse\" \"rgb L\" [ {0} {0} {0} ] \"bool twosided\" {1}\n",
                                emission, i % 3 == 0);
        text += fmt::format(fmt::runtime(kinds[kind]), emission, number(10, 120),
                            size * number(0.02, 0.6) / std::sqrt(count));
        text += "AttributeEnd\n";
    }
    return text;
}

std::vector<glm::vec3> places(uint32_t seed, float size = 1.0f) {
    std::mt19937 random(seed);
    std::vector<glm::vec3> found;
    for (int i = 0; i < 24; ++i) {
        glm::vec3 p;
        for (int axis = 0; axis < 3; ++axis) p[axis] = size * 4.0f * (float(random()) / 4294967296.0f - 0.5f);
        found.push_back(p);
    }
    return found;
}

const Scene& checked(const BuiltText& built) {
    EXPECT_TRUE(built.errors.empty()) << built.all_errors();
    EXPECT_TRUE(built.scene().effects.has(kernel::EFFECT_LIGHT_TREE));
    return built.scene();
}

double sum_of(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

class LightTree : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, LightTree, testing::ValuesIn(kernel_backends()),
                         [](const auto& info) { return info.param; });

TEST_P(LightTree, ProbabilitiesAddUpToOne) {
    for (const int count : {8, 9, 30, 500}) {
        SCOPED_TRACE(count);
        const BuiltText built = build_world(random_lights(count, 3));
        const Scene& scene = checked(built);
        TreeAsker asker(GetParam(), scene);
        for (const glm::vec3 p : places(uint32_t(count))) {
            const std::vector<double> found = asker.probabilities(p);
            EXPECT_NEAR(sum_of(found), 1, 1e-5);
            for (size_t i = 0; i < found.size(); ++i)
                EXPECT_GE(found[i], 0.124 * double(scene.lights[i].choice_probability)) << "light " << i;
        }
    }
}

TEST_P(LightTree, ChoicesHaveTheirProbabilities) {
    const BuiltText built = build_world(random_lights(30, 5));
    TreeAsker asker(GetParam(), checked(built));
    constexpr uint32_t kChoices = 100000;
    for (const glm::vec3 p : {glm::vec3(0), glm::vec3(0.9f, -0.8f, 0.7f), glm::vec3(0, 0, 5)}) {
        const std::vector<double> stated = asker.probabilities(p);
        std::vector<double> counts(stated.size()), expected;
        for (const auto [light, probability] : asker.choices(p, kChoices, 11)) {
            ASSERT_LT(light, stated.size());
            ASSERT_EQ(probability, float(stated[light]))
                << "light " << light;  // weights use the one, samples the other
            counts[light] += 1;
        }
        for (const double share : stated) expected.push_back(kChoices * share);
        EXPECT_GT(chi_squared_test(counts, expected).p, 1e-7);
    }
}

// Where a light's sample arrives, the bounds must not say that it sends nothing: it would be left to choices by power.
// Other backends have the same probabilities: the tests above.
TEST(LightTreeBounds, NothingThatArrivesIsBeyondThem) {
    const BuiltText built = build_world(random_lights(70, 9));
    const Scene& scene = checked(built);
    TreeAsker asker("cpu", scene);
    int arrived = 0, beyond = 0;
    for (const glm::vec3 p : places(1)) {
        const std::vector<double> found = asker.probabilities(p);
        for (uint32_t i = scene.record.placeless_lights; i < scene.lights.size(); ++i) {
            const double by_power = 0.125 * double(scene.lights[i].choice_probability);  // LIGHT_CHOICES_BY_POWER
            const bool in_bounds = found[i] > 1.00001 * by_power;
            if (asker.arrives(i, p)) {
                ++arrived;
                EXPECT_TRUE(in_bounds) << "light " << i << " at " << p.x << " " << p.y << " " << p.z;
            } else {
                beyond += !in_bounds;
            }
        }
    }
    EXPECT_GT(arrived, 500);
    EXPECT_GT(beyond, 100) << "the bounds tell nothing";
}

// Neither the scene's unit nor its place changes a probability by more than rounding.
TEST_P(LightTree, UnitAndPlaceDoNotMatter) {
    const BuiltText built = build_world(random_lights(40, 13, 1.0, true));
    TreeAsker asker(GetParam(), checked(built));
    for (const double scale : {0x1p-16, 0x1p16}) {
        SCOPED_TRACE(scale);
        const BuiltText other = build_world(random_lights(40, 13, scale, true));
        TreeAsker scaled(GetParam(), checked(other));
        for (const glm::vec3 p : places(2)) {
            const auto a = asker.probabilities(p), b = scaled.probabilities(float(scale) * p);
            for (size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-4 * a[i]) << "light " << i;
        }
    }
}

// Halves of halves: sixty lamps along a line, each at half of the distance of the one before, then all in one place but one.
TEST_P(LightTree, DeepTreesAreWhole) {
    std::string halves, same;
    for (int i = 0; i < 60; ++i) {
        halves += fmt::format("LightSource \"point\" \"point3 from\" [ {} 0 0 ]\n", std::ldexp(1.0, -i));
        same += "LightSource \"point\"\n";
    }
    same += "LightSource \"point\" \"point3 from\" [ 1 0 0 ]\n";
    for (const std::string& text : {halves, same}) {
        const BuiltText built = build_world(text + "Shape \"sphere\"\n");
        const Scene& scene = checked(built);
        EXPECT_EQ(scene.light_nodes.size(), 2 * scene.lights.size() - 1);
        TreeAsker asker(GetParam(), scene);
        for (const glm::vec3 p : {glm::vec3(0), glm::vec3(1, 0, 0), glm::vec3(0, 0x1p-40f, 0), glm::vec3(0, 5, 0)})
            EXPECT_NEAR(sum_of(asker.probabilities(p)), 1, 1e-5);
    }
}

// A beam without a solid angle.
TEST(LightTreeBounds, NarrowBeamsHaveSome) {
    const std::string narrow = "LightSource \"spot\" \"float coneangle\" 1e-21 \"float conedeltaangle\" 0\n";
    const BuiltText built = build_world(random_lights(12, 3) + narrow);
    TreeAsker asker("cpu", checked(built));
    EXPECT_NEAR(sum_of(asker.probabilities(glm::vec3(0))), 1, 1e-5);
}

}  // namespace
}  // namespace lampyris::test
