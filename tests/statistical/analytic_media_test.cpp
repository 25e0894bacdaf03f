// Absorbing media, against the Beer-Lambert law (scenes/analytic/medium-*; each scene's comment derives its image).
#include "support/analytic.h"

namespace lampyris::test {
namespace {

using Sigma = std::array<double, 3>;  // absorption per distance and channel

// The length of a ray's path through a layer, relative to that along the axis: rays of the perspective scenes pass (px, py, 1).
double obliqueness(double x, double y, double width) {
    return std::sqrt(1.0 + std::pow(2.0 * x / width - 1.0, 2.0) + std::pow(2.0 * y / width - 1.0, 2.0));
}

// Some 100 roundings of single precision; an optical depth of 4 multiplies those of the distance.
constexpr double kBound = 1e-5;

TEST_P(AnalyticTest, SlabsAbsorbByThicknessAndAngle) {
    const Rendered& image = render("medium-slab", 4);
    const Sigma sigma{0.2, 0.5, 1.0};
    expect_exact(
        [&](double x, double y, int c) { return std::exp(-sigma[size_t(c)] * obliqueness(x, y, image.width)); },
        kBound);
}

TEST_P(AnalyticTest, MediaNestAroundTheCamera) {
    const Rendered& image = render("medium-nested", 4);
    const Sigma air{0.05, 0.1, 0.2}, outer{0.3, 0.1, 0.2}, inner{0.1, 0.4, 0.8};
    expect_exact(
        [&](double x, double y, int c) {
            const double depth = 2.0 * air[size_t(c)] + 2.0 * outer[size_t(c)] + inner[size_t(c)];
            return std::exp(-depth * obliqueness(x, y, image.width));
        },
        kBound);
}

// A lamp at z = 5 seen through air and two masks without a surface (alpha 0) in it: rays go on behind each, and the air
// absorbs over the whole way.
TEST_P(AnalyticTest, AirAbsorbsOnBothSidesOfMasks) {
    scene_ = "masks in air";
    RenderSettings settings;
    settings.backend = GetParam();
    settings.samples = 1;
    settings.integrator = "path:maxdepth=1";
    const std::string text = R"(
LookAt 0 0 0  0 0 1  0 1 0
MediumInterface "" "air"
Camera "perspective" "float fov" 90
PixelFilter "box" "float xradius" 0.0000001 "float yradius" 0.0000001
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
WorldBegin
MakeNamedMedium "air" "string type" "homogeneous" "rgb sigma_a" [ 0.05 0.1 0.2 ] "rgb sigma_s" [ 0 0 0 ]
MediumInterface "" ""
Material "diffuse" "rgb reflectance" [ 0 0 0 ]
Shape "disk" "float radius" 10 "float height" 1 "float alpha" 0
Shape "disk" "float radius" 10 "float height" 3 "float alpha" 0
AreaLightSource "diffuse" "rgb L" [ 1 1 1 ] "bool twosided" true
Shape "disk" "float radius" 10 "float height" 5
)";
    last_ = render_text(text, settings);
    const Sigma air{0.05, 0.1, 0.2};
    expect_exact(
        [&](double x, double y, int c) { return std::exp(-5.0 * air[size_t(c)] * obliqueness(x, y, last_.width)); },
        kBound);
}

// The distance from the axis of a pixel of the orthographic scenes.
double from_axis(double x, double y, double width) { return std::hypot(2.0 * x / width - 1.0, 2.0 * y / width - 1.0); }

TEST_P(AnalyticTest, SpheresAbsorbAlongTheirChords) {
    const Rendered& image = render("medium-sphere", 4);
    const Sigma sigma{0.5, 1.0, 2.0};
    int inside = 0;
    expect_exact(
        [&](double x, double y, int c) {
            const double b = from_axis(x, y, image.width);
            inside += b < 0.75;
            return b < 0.75 ? std::exp(-2.0 * sigma[size_t(c)] * std::sqrt(0.5625 - b * b)) : 1.0;
        },
        kBound);
    EXPECT_GT(inside, 3 * 100);
}

TEST_P(AnalyticTest, ColouredGlassAbsorbsBetweenReflections) {
    const Rendered& image = render("medium-ball", 256);
    const Sigma sigma{0.1, 0.3, 1.0};
    expect_mean(
        [&](double x, double y, int c) {
            constexpr double kIndex = 1.5, kRadius = 0.97;
            const double sine = from_axis(x, y, image.width) / kRadius;
            if (sine >= 1.0) return 1.0;
            const double outside = std::sqrt(1.0 - sine * sine),
                         within = std::sqrt(1.0 - sine * sine / kIndex / kIndex);
            const double parallel = (kIndex * outside - within) / (kIndex * outside + within);
            const double across = (outside - kIndex * within) / (outside + kIndex * within);
            const double reflected = (parallel * parallel + across * across) / 2.0;
            const double left = std::exp(-2.0 * sigma[size_t(c)] * kRadius * within);
            return reflected + (1.0 - reflected) * (1.0 - reflected) * left / (1.0 - reflected * left);
        },
        0.02);
}

// The share of light that the slabs of medium-shadow and medium-sun transmit, if the path through them is `slant` times their
// thickness.
double through_slabs(double slant, int c) {
    const Sigma outer{1.0, 2.0, 4.0}, inner{8.0, 4.0, 2.0};
    return std::exp(-slant * (0.15 * outer[size_t(c)] + 0.05 * inner[size_t(c)]));
}

// The floor of medium-shadow or medium-inside, at first without media.
class PointLightInMediaTest : public AnalyticTest {
 protected:
    static glm::dvec3 to_light(glm::dvec3 p) { return glm::dvec3(0.3, 0.9, -0.2) - p; }
    Expected clear() const {
        return floor_radiance([](glm::dvec3 p) { return to_light(p).y / std::pow(glm::length(to_light(p)), 3.0); });
    }
    Expected shadow() const {
        return [this](double x, double y, int c) {
            const glm::dvec3 to = to_light(floor_point(x, y));
            return clear()(x, y, c) * through_slabs(glm::length(to) / to.y, c);
        };
    }
    Expected inside() const {
        return [this](double x, double y, int c) {
            const Sigma water{0.5, 1.0, 2.0};
            return clear()(x, y, c) * std::exp(-water[size_t(c)] * (glm::length(to_light(floor_point(x, y))) + 0.25));
        };
    }
};

TEST_P(PointLightInMediaTest, ShadowRaysPassMedia) {
    for (const char* integrator : {"path", "sppm:maxdepth=1"}) {
        render("medium-shadow", 4, integrator);
        expect_exact(shadow(), kBound);
        render("medium-inside", 4, integrator);
        expect_exact(inside(), kBound);
    }
}

// 1.3 million photons, of which about a fifth land in view. The sum's noise is 0.4 % (from three seeds of the same scene
// without media); the bound is six times that, and forgetting a medium changes it by 10 % or more.
TEST_P(PointLightInMediaTest, PhotonsPassMedia) {
    const auto expect_total = [&](const char* scene, const Expected& expected) {
        const Rendered& image =
            render(scene, 64, "sppm:maxdepth=1,direct=photons,radius=0.05,photonsperiteration=20000");
        for (int c = 0; c < 3; ++c) {
            double sum = 0.0, total = 0.0;
            for (int y = 0; y < image.height; ++y) {
                for (int x = 0; x < image.width; ++x) {
                    sum += image.value(x, y, c);
                    total += expected(x + 0.5, y + 0.5, c);
                }
            }
            fmt::print("{:18} {:9} photons, channel {}: {:+.3f} %\n", scene, GetParam(), c,
                       100.0 * (sum / total - 1.0));
            EXPECT_NEAR(sum / total, 1.0, 0.025) << scene << ", channel " << c;
        }
    };
    expect_total("medium-shadow", shadow());
    expect_total("medium-inside", inside());
}

TEST_P(AnalyticTest, ShadowRaysPassMediaToInfinity) {
    render("medium-sun", 4);
    const double cosine = 3.0 / std::sqrt(14.0);
    const Expected clear = floor_radiance([&](glm::dvec3) { return cosine; });
    expect_exact([&](double x, double y, int c) { return clear(x, y, c) * through_slabs(1.0 / cosine, c); }, kBound);
}

LAMPYRIS_ANALYTIC_TESTS(AnalyticTest);
LAMPYRIS_ANALYTIC_TESTS(PointLightInMediaTest);

}  // namespace
}  // namespace lampyris::test
