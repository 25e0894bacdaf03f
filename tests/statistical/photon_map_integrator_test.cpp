// Photon mapping with a photon map that is kept: closed forms, path-traced references, and itself under other settings.
//
// The spread of the mean over seeds is the error of a mean, because each seed has its own photons. False alarms: each z-test
// has a rate of 1e-6, at fixed seeds. Tolerances for the blur of a radius are stated where they apply.
#include "core/image/image_io.h"
#include "support/runs.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace lampyris::test {
namespace {

double reference_mean(const std::string& file) {
    const Image image = read_image(kScenes + file + ".exr");
    double sum = 0.0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            sum += 0.2126 * double(image.at(x, y, 0)) + 0.7152 * double(image.at(x, y, 1)) +
                   0.0722 * double(image.at(x, y, 2));
    return sum / (double(image.width) * image.height);
}

class PhotonMapIntegrator : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, PhotonMapIntegrator, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return name_of(info.param); });

// Walls of albedo 1/2 that emit 1 show 2 everywhere. A disk that reaches past an edge trades a part of its own wall for a part of
// the next: 1 % is allowed for that.
TEST_P(PhotonMapIntegrator, FillsAClosedBox) {
    for (const char* direct : {"nee", "photons"}) {
        SCOPED_TRACE(direct);
        const std::string integrator =
            fmt::format("photon_map:maxdepth=64,radius=0.05,photons=40000,direct={}", direct);
        const Mean mean = mean_of_runs("analytic/box-half.pbrt", settings_of(GetParam(), integrator, 4, 16), 8);
        expect_mean(mean, 2.0, 0.02);
        EXPECT_LT(mean.error(), 0.02);
    }
}

// A sphere of albedo 1/2 around a point light of intensity pi shows 1. A ball about one of its points cuts out a cap of area pi r^2
// exactly: nothing is allowed for the radius, nor for the nearest photons, which are unbiased.
TEST_P(PhotonMapIntegrator, FillsASphere) {
    for (const char* options : {"radius=0.05,direct=nee", "radius=0.05,direct=photons", "radius=0", "nearest=50",
                                "radius=0.1,nearest=20,direct=photons", "radius=0.1,nearest=100"}) {
        SCOPED_TRACE(options);
        const std::string integrator = fmt::format("photon_map:maxdepth=64,photons=40000,{}", options);
        const Mean mean = mean_of_runs("analytic/sphere-point.pbrt", settings_of(GetParam(), integrator, 4, 16), 8);
        expect_mean(mean, 1.0, 1e-4);
        EXPECT_LT(mean.error(), 0.01);
    }
}

// Backends follow the same paths and sum in the same order. A photon that takes a different path at an edge changes the hit
// points around it: docs/determinism.md gives the share.
TEST_P(PhotonMapIntegrator, GivesTheSameImageOnEveryBackend) {
    for (const char* integrator :
         {"photon_map:maxdepth=12,photons=20000", "photon_map:maxdepth=12,photons=20000,nearest=50"}) {
        SCOPED_TRACE(integrator);
        const std::string file = kScenes + "reference/sds-lamp.pbrt";
        const Rendered cpu = render_file(file, settings_of("cpu", integrator, 2, 64));
        const Rendered here = render_file(file, settings_of(GetParam(), integrator, 2, 64));
        size_t equal = 0;
        for (size_t i = 0; i < cpu.pixels.size(); ++i) equal += cpu.pixels[i].sum == here.pixels[i].sum;
        EXPECT_GE(double(equal), 0.999 * double(cpu.pixels.size()));
    }
}

// The mean of the picture against path tracing by pbrt (sds-point: against pbrt's sppm). A radius of a fiftieth of the room blurs
// edges and caustics, which nearly averages out: 1 %, 2 % where caustics light the scene.
struct Case {
    const char* name;
    const char* options;
    double allowed;
};
class PhotonMapIntegratorReference : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Scenes, PhotonMapIntegratorReference,
                         testing::Values(Case{"diffuse", "", 0.01}, Case{"diffuse", ",direct=photons", 0.01},
                                         Case{"diffuse", ",nearest=10", 0.01},
                                         Case{"diffuse", ",nearest=20,direct=photons", 0.01},
                                         Case{"dielectric-smooth", "", 0.01}, Case{"coated-diffuse", "", 0.01},
                                         Case{"sds-point", "", 0.02}),
                         [](const auto& info) {
                             std::string name = std::string(info.param.name) + info.param.options;
                             for (char& c : name)
                                 if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                             return name;
                         });

TEST_P(PhotonMapIntegratorReference, AgreesWithPathTracing) {
    const std::string file = std::string("reference/") + GetParam().name;
    const int depth = std::string(GetParam().name) == "sds-point" ? 24 : 12;
    const std::string integrator =
        fmt::format("photon_map:maxdepth={},photons=200000,radius=0.04{}", depth, GetParam().options);
    const Mean mean = mean_of_runs(file + ".pbrt", settings_of("cpu", integrator, 4, 0), 4);
    const double expected = reference_mean(file);
    // From four runs, the error is only known to a third (t distribution of 3 degrees of freedom), so it has a floor of 0.2 %.
    const double error = std::max(mean.error(), 0.002 * expected);
    EXPECT_LT(std::abs(mean.value() - expected), normal_threshold(kAlpha) * error + GetParam().allowed * expected)
        << mean.value() << " +- " << mean.error() << " against " << expected;
    EXPECT_LT(mean.error(), 0.01 * expected);
}

// Same seed, same image, however many threads store photons; also if structures are rebuilt in each pass.
TEST(PhotonMapIntegratorDeterminism, ThreadsChangeNothing) {
    for (const char* map : {"sorted_grid", "splat", "stochastic_hash"}) {
        SCOPED_TRACE(map);
        RenderSettings s = settings_of("cpu", "photon_map:maxdepth=12,photons=20000", 3, 48);
        s.photon_map = map;
        s.threads = 1;
        const Rendered one = render_file(kScenes + "reference/sds-lamp.pbrt", s);
        s.threads = 7;
        const Rendered many = render_file(kScenes + "reference/sds-lamp.pbrt", s);
        EXPECT_EQ(one.image.pixels, many.image.pixels);
    }
}

// The nearest photons are the same set, summed in the same order: the same image, to the bit, with every structure that finds them, on
// any number of threads.
TEST(PhotonMapIntegratorNearest, StructuresGiveTheSameImage) {
    RenderSettings s = settings_of("cpu", "photon_map:maxdepth=12,photons=5000,nearest=30", 2, 32);
    s.photon_map = "brute_force";
    const Rendered truth = render_file(kScenes + "reference/sds-lamp.pbrt", s);
    EXPECT_GT(truth.mean_luminance(), 0.0);
    int compared = 0;
    for (const std::string& name : photon_maps().names()) {
        const PhotonMapCapabilities can = create_photon_map(name)->capabilities();
        if (!can.exact || can.sums_only) continue;
        SCOPED_TRACE(name);
        s.photon_map = name;
        s.threads = unsigned(1 + compared % 3);
        EXPECT_EQ(render_file(kScenes + "reference/sds-lamp.pbrt", s).image.pixels, truth.image.pixels);
        ++compared;
    }
    EXPECT_GT(compared, 4);
}

TEST(PhotonMapIntegratorNearest, OtherStructuresAreBadInput) {
    for (const std::string map : {"splat", "stochastic_hash"}) {
        SCOPED_TRACE(map);
        RenderSettings s = settings_of("cpu", "photon_map:nearest=50,photons=100", 1, 8);
        s.photon_map = map;
        try {
            render_file(kScenes + "reference/diffuse.pbrt", s);
            FAIL();
        } catch (const InputError& error) {
            const std::string text = error.what();
            for (const char* named : {map.c_str(), "bvh", "sorted_grid", "brute_force"})
                EXPECT_NE(text.find(named), std::string::npos) << text;
        }
    }
}

// A pass is a function of its number: rendered alone, it is what it contributes to the whole.
TEST(PhotonMapIntegratorDeterminism, PassesAreIndependent) {
    RenderSettings s = settings_of("cpu", "photon_map:maxdepth=12,photons=20000", 2, 32);
    const Rendered both = render_file(kScenes + "reference/sds-lamp.pbrt", s);
    s.samples = 1;
    const Rendered first = render_file(kScenes + "reference/sds-lamp.pbrt", s);
    s.first_pass = 1;
    const Rendered second = render_file(kScenes + "reference/sds-lamp.pbrt", s);
    // Sums of two floats, rounded in a different order.
    for (size_t i = 0; i < both.pixels.size(); ++i)
        EXPECT_NEAR(double(both.pixels[i].sum.y), double(first.pixels[i].sum.y) + double(second.pixels[i].sum.y),
                    1e-5 * (double(both.pixels[i].sum.y) + 1e-3));
}

// Walls of albedo 4/5 show 5, and store five photons of each path: more than the store has room for at first, so the paths are
// traced again. 1 % is allowed for edges.
TEST(PhotonMapIntegratorStore, GrowsUntilAllFit) {
    const std::string integrator = "photon_map:maxdepth=200,photons=40000,radius=0.05,direct=photons";
    const Mean mean = mean_of_runs("analytic/box-bright.pbrt", settings_of("cpu", integrator, 2, 16), 6);
    expect_mean(mean, 5.0, 0.05);
    EXPECT_LT(mean.error(), 0.05);
}

}  // namespace
}  // namespace lampyris::test
