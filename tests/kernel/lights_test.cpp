// Lights: directions are sampled with the density that is reported, and the light that arrives is right.
//
// False alarms: chi-squared tests reject at kAlpha / kTests, with kAlpha = 1e-5 for the whole file on one backend; seeds are
// fixed, so that a build that passes passes again.
#include "support/histogram.h"
#include "support/light_probe.h"
#include "support/shape_probe.h"

#include <gtest/gtest.h>

#include <numbers>

namespace lampyris::test {
namespace {

using glm::dmat4;
using glm::dvec2;
using glm::dvec3;
using glm::dvec4;
using glm::vec3;
using glm::vec4;

constexpr double kPi = std::numbers::pi;
constexpr float kTwoPi = 2 * std::numbers::pi_v<float>;
constexpr double kAlpha = 1e-5;
constexpr int kTests = 64;  // at least as many chi-squared and z tests as there are here
constexpr uint32_t kTwoSided = kernel::LIGHT_TWO_SIDED;
// The effects that the probe is compiled for: shaders for everything take long to compile.
constexpr uint64_t kAreaEffects =
    kernel::EFFECT_QUADRICS | kernel::EFFECT_BILINEAR | kernel::EFFECT_AREA_LIGHTS | kernel::EFFECT_QUADRIC_LIGHTS;
constexpr uint64_t kInfiniteEffects = kernel::EFFECT_ENVIRONMENT | kernel::EFFECT_ENVIRONMENT_IMAGE;

struct Case {
    const char* name;
    std::function<uint32_t(TestScene&)> add;  // the geometry
    std::function<dvec3(dvec2)> point;        // its parametrisation
    vec3 ref_p;
    bool near_side_only = false;  // a whole sphere from outside: what faces away is never sampled
    bool folds = false;           // has an outline where its density has an integrable pole: quadrature is less precise
};

dmat4 skewed(bool mirror = false) {
    dmat4 m = glm::translate(dmat4(1.0), dvec3(0.5, -0.25, 3));
    m = glm::rotate(m, 0.7, glm::normalize(dvec3(1, 2, -1)));
    return glm::scale(m, dvec3(mirror ? -1.5 : 1.5, 0.7, 1.1));
}

Case quadric(const char* name, uint32_t kind, vec4 params, const dmat4& to, vec3 ref_p, bool near_side_only = false,
             bool folds = false) {
    return {name,
            [=](TestScene& scene) { return scene.add_quadric(kind, params, to); },
            [=](dvec2 uv) { return dvec3(to * dvec4(quadric_point(kind, params, uv), 1.0)); },
            ref_p,
            near_side_only,
            folds};
}
Case triangle(const char* name, std::array<vec3, 3> p, vec3 ref_p) {
    return {name,
            [=](TestScene& scene) { return scene.add_polygon<3>(p); },
            [=](dvec2 uv) {  // a square with one side collapsed
                return dvec3(p[0]) + uv.x * (dvec3(p[1] - p[0]) + uv.y * dvec3(p[2] - p[1]));
            },
            ref_p,
            false,
            false};
}
Case patch(const char* name, std::array<vec3, 4> p, vec3 ref_p) {
    return {name,
            [=](TestScene& scene) { return scene.add_polygon<4>(p); },
            [=](dvec2 uv) {
                return (1 - uv.x) * ((1 - uv.y) * dvec3(p[0]) + uv.y * dvec3(p[2])) +
                       uv.x * ((1 - uv.y) * dvec3(p[1]) + uv.y * dvec3(p[3]));
            },
            ref_p,
            false,
            false};
}

std::vector<Case> area_lights() {
    const dmat4 up = glm::translate(dmat4(1.0), dvec3(0, 0, 3));
    using namespace kernel;
    std::vector<Case> cases = {
        triangle("far triangle", {vec3(-0.5f, -0.5f, 3), vec3(0.5f, -0.5f, 3.2f), vec3(-0.2f, 0.5f, 2.8f)},
                 vec3(0.3f, 0.2f, 0)),
        triangle("near triangle", {vec3(-3, -2, 1), vec3(3, -2, 1), vec3(0, 4, 1.5f)}, vec3(0.3f, 0.2f, 0)),
        triangle("triangle all around", {vec3(-9, -9, 0.2f), vec3(9, -9, 0.2f), vec3(0, 9, 0.2f)}, vec3(0)),
        triangle("wide triangle", {vec3(-3, 0.5f, 1), vec3(3, 0.5f, 1), vec3(0, 1.5f, 1.2f)}, vec3(0)),
        quadric("sphere", GEOMETRY_SPHERE, {1, -1, 1, kTwoPi}, up, vec3(0.5f, 0, 0), true),
        quadric("sphere close by", GEOMETRY_SPHERE, {1, -1, 1, kTwoPi}, up, vec3(0, 0, 1.9f), true),
        quadric("sphere from inside", GEOMETRY_SPHERE, {1, -1, 1, kTwoPi}, up, vec3(0, 0.5f, 3.2f)),
        quadric("ellipsoid", GEOMETRY_SPHERE, {1, -1, 1, kTwoPi}, skewed(), vec3(0), true),
        quadric("ellipsoid from inside", GEOMETRY_SPHERE, {1, -1, 1, kTwoPi}, skewed(true), vec3(0.5f, -0.2f, 3.1f)),
        quadric("half an ellipsoid", GEOMETRY_SPHERE, {1, -0.5f, 0.75f, 4}, skewed(true), vec3(0.5f, -0.2f, 3.1f)),
        quadric("disk", GEOMETRY_DISK, {0.5f, 1, 0, kTwoPi}, skewed(), vec3(0)),
        quadric("ring in part", GEOMETRY_DISK, {0, 1, 0.4f, 4}, up, vec3(0.3f, 0, 0)),
        quadric("cylinder", GEOMETRY_CYLINDER, {0.6f, -0.5f, 1, kTwoPi}, skewed(), vec3(0), false, true),
        quadric("cylinder in part, from inside", GEOMETRY_CYLINDER, {1, -1, 1, 5}, up, vec3(0.2f, 0, 3)),
        patch("rectangle", {vec3(-1, -1, 2), vec3(1, -1, 2), vec3(-1, 1, 2), vec3(1, 1, 2)}, vec3(0.5f, 0.2f, 0)),
        patch("trapezium", {vec3(-1, -1, 2), vec3(1, -1, 2), vec3(-0.2f, 1, 2), vec3(0.3f, 1, 2)}, vec3(0.5f, 0.2f, 0)),
        patch("saddle", {vec3(-1, -1, 2.7f), vec3(1, -1, 1.5f), vec3(-1, 1, 1.3f), vec3(1, 1, 2.8f)},
              vec3(2.5f, 0.2f, 1)),
    };
    cases.back().folds = true;
    return cases;
}

// The cone that holds all samples.
Domain cone_about(const std::vector<LightAnswer>& samples) {
    dvec3 mean(0.0);
    for (const LightAnswer& s : samples) mean += dvec3(s.wi);
    if (glm::length(mean) < 0.2 * double(samples.size())) return sphere_domain();
    mean = glm::normalize(mean);
    // Off centre, lest the light's edges run along the grid's lines.
    mean = glm::normalize(mean + 0.2 * std::min(1.0, glm::length(mean - dvec3(samples[0].wi))) *
                                     glm::normalize(glm::cross(mean, dvec3(0.3, 0.5, 0.8))));
    double cosine = 1;
    for (const LightAnswer& s : samples) cosine = std::min(cosine, glm::dot(mean, glm::normalize(dvec3(s.wi))));
    if (cosine < -0.5) return sphere_domain();
    const double width = std::min(2.0, (1 - cosine) * 1.02);
    const dvec3 x = glm::normalize(glm::cross(mean, std::abs(mean.x) < 0.5 ? dvec3(1, 0, 0) : dvec3(0, 1, 0)));
    const dvec3 y = glm::cross(mean, x);
    return {2 * kPi * width,
            [=](vec4 p) {
                const dvec3 d = glm::normalize(dvec3(p));
                const double phi = std::atan2(glm::dot(d, y), glm::dot(d, x)) / (2 * kPi);
                return dvec2((1 - glm::dot(d, mean)) / width, phi < 0 ? phi + 1 : phi);
            },
            [=](dvec2 s) {
                const double z = 1 - s.x * width, r = std::sqrt(std::max(0.0, 1 - z * z));
                return vec4(vec3(z * mean + r * (std::cos(2 * kPi * s.y) * x + std::sin(2 * kPi * s.y) * y)), 0);
            }};
}

struct Fit {
    double p;        // of the samples against the density reported,
    double p_wrong;  // and against one that is wrong by 15 %, or 30 % with folds
    double missing;  // by how much the density's integral falls short of 1
};

Fit fit(LightAsker& asker, vec3 ref_p, bool first_hit_only = false, bool folds = false) {
    constexpr int kCells = 12, kSub = 32;
    const uint32_t count = folds ? 10000 : 30000;
    const auto samples = asker.sample(ref_p, count);
    const Domain domain = cone_about(samples);
    Histogram observed{kCells, kCells};
    for (const LightAnswer& s : samples) {
        if (s.pdf > 0) {
            observed.add(domain, vec4(s.wi, 0));
        } else {
            observed.miss();
        }
    }
    const auto density = [&](const std::vector<vec4>& directions) {
        std::vector<double> values;
        for (const DirectionAnswer& a : asker.look(ref_p, directions))
            values.push_back(first_hit_only ? a.pdf_first : a.pdf);
        return values;
    };
    auto expected = expected_counts(domain, kCells, kCells, kSub, count, density);
    Fit result{};
    double total = 0;
    for (size_t i = 0; i + 1 < expected.size(); ++i) total += expected[i];
    result.missing = 1 - total / count;
    expected.back() = 0;  // nothing may be missed
    result.p = chi_squared_test(observed.cells, expected).p;
    double sum = 0;
    for (size_t i = 0; i < expected.size(); ++i)
        sum += expected[i] *= 1 + (folds ? 0.3 : 0.15) * std::sin(double(i) * 0.7);
    for (double& e : expected) e *= total / sum;
    result.p_wrong = chi_squared_test(observed.cells, expected).p;
    return result;
}

TEST(Lights, AreaLightsAreSampledWithTheirDensity) {
    for (const std::string& backend : kernel_backends()) {
        const auto device = create_device(backend);
        const KernelHandle probe = light_probe(*device, kAreaEffects);
        for (const Case& c : area_lights()) {
            SCOPED_TRACE(backend + ", " + c.name);
            TestScene scene;
            scene.add_area_light(c.add(scene), vec3(1), kTwoSided);
            LightAsker asker(*device, probe, scene.finish());
            const Fit result = fit(asker, c.ref_p, c.near_side_only, c.folds);
            EXPECT_GT(result.p, kAlpha / kTests);
            EXPECT_LT(result.p_wrong, kAlpha / kTests) << "the test has no power";
            EXPECT_NEAR(result.missing, 0, c.folds ? 1.5e-2 : 4e-3);
            // The density that a sample reports equals light_pdf where its direction first hits the light.
            int met = 0;
            const auto samples = asker.sample(c.ref_p, 4000, 2);
            std::vector<float> densities;
            for (const LightAnswer& s : samples) densities.push_back(s.pdf);
            std::nth_element(densities.begin(), densities.begin() + 2000, densities.end());
            for (const LightAnswer& s : samples) {
                if (!(s.pdf > 0) || std::abs(s.distance - s.distance_met) > 1e-4f * s.distance) continue;
                ++met;
                // Grazing incidence, where the density of a direction is large, amplifies the rounding of the position.
                const float grazing = s.pdf / densities[2000];
                EXPECT_NEAR(s.pdf_met / s.pdf, 1, 1e-4 * (1 + grazing * grazing));
            }
            EXPECT_GT(met, 1500);
        }
    }
}

TEST(Lights, InfiniteLightsAreSampledWithTheirDensity) {
    std::mt19937 rng(3);
    std::vector<float> picture(8 * 8);
    for (float& texel : picture) texel = std::uniform_real_distribution<float>(0, 1)(rng);
    for (int x = 0; x < 8; ++x) picture[3 * 8 + x] = 0;  // a black row
    picture[5 * 8 + 2] = 30;                             // a sun
    for (const std::string& backend : kernel_backends()) {
        const auto device = create_device(backend);
        const KernelHandle probe = light_probe(*device, kInfiniteEffects);
        // Constant; image; both; image of a stretched sky; then the same for samples that are weighed against those of a BSDF.
        for (int kind = 1; kind <= 8; ++kind) {
            const int lights = (kind - 1) % 4 + 1;
            SCOPED_TRACE(backend + ", kind " + std::to_string(kind));
            TestScene scene;
            if (lights == 1 || lights == 3) {
                kernel::LightRecord light{};
                light.kind = kernel::LIGHT_INFINITE;
                light.image = light.transform = kernel::NONE;
                scene.add_light(light, vec3(0.3f));
            }
            if (lights >= 2) {
                kernel::LightRecord light{};
                light.kind = kernel::LIGHT_INFINITE_IMAGE;
                light.image = scene.add_image(picture, 8, 8, kernel::WRAP_OCTAHEDRAL);
                light.transform = uint32_t(scene.scene.transforms.size());
                const dvec3 stretch = lights == 4 ? dvec3(1.25, 1, 0.8) : dvec3(1);
                scene.scene.transforms.push_back(
                    transform_of(glm::scale(glm::rotate(dmat4(1.0), 0.5, dvec3(1, 0, 0)), stretch)));
                light.distribution = append_sky_distributions(picture, 8, 8, scene.scene.distributions);
                scene.add_light(light, vec3(0.5f), 2.0f);
            }
            scene.scene.record.infinite_lights = uint32_t(scene.scene.lights.size());
            LightAsker asker(*device, probe, scene.finish());
            asker.weighted = kind > 4;
            const Fit result = fit(asker, vec3(0));
            EXPECT_GT(result.p, kAlpha / kTests);
            EXPECT_LT(result.p_wrong, kAlpha / kTests) << "the test has no power";
            EXPECT_NEAR(result.missing, 0, 4e-3);
            int off = 0;
            for (const LightAnswer& s : asker.sample(vec3(0), 4000, 2)) {
                if (std::abs(s.pdf_met / s.pdf - 1) > 1e-4f) ++off;  // the direction may round into the next texel
                EXPECT_GE(s.distance, 3e38f);
            }
            EXPECT_LE(off, 4);
            // The light that is sampled is the light that is seen: the irradiance on a tilted plane.
            const dvec3 normal = glm::normalize(dvec3(1, 2, 2));
            const Domain domain = sphere_domain();
            std::vector<vec4> grid;
            constexpr int kGrid = 400;
            for (int y = 0; y < kGrid; ++y)
                for (int x = 0; x < kGrid; ++x)
                    grid.push_back(domain.from_square({(x + 0.5) / kGrid, (y + 0.5) / kGrid}));
            const auto seen = asker.look(vec3(0), grid);
            double expected = 0;
            size_t never = 0;
            for (size_t i = 0; i < grid.size(); ++i) never += seen[i].radiance > 0 && seen[i].pdf == 0;
            // Of an image alone, weighed samples leave out what is not above the mean: most of it, beside the sun.
            if (kind == 6 || kind == 8)
                EXPECT_GT(never, grid.size() / 2);
            else
                EXPECT_EQ(never, 0u);
            for (size_t i = 0; i < grid.size(); ++i)
                expected += (seen[i].pdf > 0) * seen[i].radiance * std::max(0.0, glm::dot(normal, dvec3(grid[i]))) *
                            domain.jacobian / double(grid.size());
            Mean mean;
            for (const LightAnswer& s : asker.sample(vec3(0), 100000, 3))
                mean.add(s.pdf > 0 ? s.radiance * std::max(0.0, glm::dot(normal, dvec3(s.wi))) / s.pdf : 0.0);
            EXPECT_LT(std::abs(mean.value() - expected),
                      normal_threshold(kAlpha / kTests) * mean.error() + 2e-3 * expected);
            EXPECT_LT(mean.error(), 0.01 * expected);
        }
    }
}

// Irradiance on a plane with the given normal, by quadrature over the shape; `side` +1 or -1: emission only where the
// parametrisation's normal, times it, looks at the point; 0: from both sides.
double quadrature(const Case& c, dvec3 normal, double side, const std::function<double(dvec2)>& radiance) {
    constexpr int kGrid = 400;
    constexpr double h = 1e-5;
    double sum = 0;
    for (int y = 0; y < kGrid; ++y) {
        for (int x = 0; x < kGrid; ++x) {
            const dvec2 uv((x + 0.5) / kGrid, (y + 0.5) / kGrid);
            const dvec3 du = (c.point(uv + dvec2(h, 0)) - c.point(uv - dvec2(h, 0))) / (2 * h);
            const dvec3 dv = (c.point(uv + dvec2(0, h)) - c.point(uv - dvec2(0, h))) / (2 * h);
            const dvec3 n = glm::cross(du, dv);
            const dvec3 to = c.point(uv) - dvec3(c.ref_p);
            const double d2 = glm::dot(to, to), d = std::sqrt(d2);
            double cosine = -glm::dot(n, to) / d;
            cosine = side == 0 ? std::abs(cosine) : std::max(0.0, side * cosine);
            sum += radiance(uv) * cosine * std::max(0.0, glm::dot(normal, to) / d) / d2;
        }
    }
    return sum / (double(kGrid) * kGrid);
}

Mean irradiance(LightAsker& asker, vec3 ref_p, dvec3 normal, uint32_t samples = 60000) {
    Mean mean;
    for (const LightAnswer& s : asker.sample(ref_p, samples, 5))
        mean.add(s.pdf > 0 ? s.radiance * std::max(0.0, glm::dot(normal, dvec3(s.wi))) / s.pdf : 0.0);
    return mean;
}

void expect_mean(const Mean& mean, double expected, double tolerance) {
    EXPECT_LT(std::abs(mean.value() - expected),
              normal_threshold(kAlpha / kTests) * mean.error() + tolerance * expected)
        << mean.value() << " +- " << mean.error() << ", expected " << expected;
    EXPECT_LT(mean.error(), 0.015 * expected + 1e-12);
}

TEST(Lights, AreaLightsIrradiateAsQuadratureSays) {
    const dvec3 normal = glm::normalize(dvec3(0.2, 0.3, 1));
    const auto one = [](dvec2) { return 2.0; };
    for (const std::string& backend : kernel_backends()) {
        const auto device = create_device(backend);
        const KernelHandle probe = light_probe(*device, kAreaEffects);
        for (const Case& c : area_lights()) {
            for (const bool two_sided : {true, false}) {
                SCOPED_TRACE(backend + ", " + c.name + (two_sided ? ", two-sided" : ""));
                TestScene scene;
                scene.add_area_light(c.add(scene), vec3(2), two_sided ? kTwoSided : 0);
                LightAsker asker(*device, probe, scene.finish());
                const std::string name = c.name;
                // pbrt's quadrics point outward whatever the transform does; the parametrisation turns with a mirror.
                const bool mirrored = name == "half an ellipsoid" || name == "ellipsoid from inside";
                const double expected =
                    two_sided ? quadrature(c, normal, 0, one) : quadrature(c, normal, mirrored ? -1 : 1, one);
                if (!(expected > 1e-6)) {
                    EXPECT_LT(irradiance(asker, c.ref_p, normal).value(), 1e-5);
                    continue;
                }
                expect_mean(irradiance(asker, c.ref_p, normal),
                            c.near_side_only ? quadrature(c, normal, 1, one) : expected, 2e-3);
            }
        }
    }
}

// Closed forms, from below: a disk of radius r at height h, and a sphere of radius r at distance h.
TEST(Lights, IrradianceHasItsClosedForm) {
    for (const std::string& backend : kernel_backends()) {
        SCOPED_TRACE(backend);
        const auto device = create_device(backend);
        const KernelHandle probe = light_probe(*device, kAreaEffects);
        for (const double r : {1e-3, 0.1, 1.0}) {
            const double h = 2;
            SCOPED_TRACE(r);
            TestScene disk;
            disk.add_area_light(disk.add_quadric(kernel::GEOMETRY_DISK, {h, r, 0, kTwoPi}), vec3(3), kTwoSided);
            LightAsker of_disk(*device, probe, disk.finish());
            expect_mean(irradiance(of_disk, vec3(0), {0, 0, 1}), 3 * kPi * r * r / (r * r + h * h), 1e-5);
            TestScene sphere;
            sphere.add_area_light(sphere.add_quadric(kernel::GEOMETRY_SPHERE, vec4(r, -r, r, kTwoPi),
                                                     glm::translate(dmat4(1.0), dvec3(0, 0, h))),
                                  vec3(3));
            LightAsker of_sphere(*device, probe, sphere.finish());
            expect_mean(irradiance(of_sphere, vec3(0), {0, 0, 1}), 3 * kPi * r * r / (h * h), 1e-5);
        }
    }
}

}  // namespace
}  // namespace lampyris::test
