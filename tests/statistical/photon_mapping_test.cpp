// Progressive photon mapping where the answer is known: closed forms, path-traced references, and itself under other settings.
//
// The spread of the mean over seeds is the error of a mean. False alarms: each z-test has a rate of 1e-6, at fixed seeds.
// Tolerances for the blur of a radius are stated where they apply.
#include "core/image/image_io.h"
#include "support/runs.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace lampyris::test {
namespace {

double largest_difference(const Rendered& a, const Rendered& b) {
    double largest = 0.0;
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x)
            largest = std::max(largest, std::abs(a.luminance(x, y) - b.luminance(x, y)) / (a.luminance(x, y) + 0.01));
    return largest;
}

bool offers_boxes() {
    for (const DeviceInfo& info : list_devices()) {
        const auto feature = info.features.find("ray_query");
        if (info.backend == "vulkan" && info.index == 0 && feature != info.features.end())
            return feature->second == "yes";
    }
    return false;
}

class PhotonMapping : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, PhotonMapping, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return name_of(info.param); });

// A closed box of albedo 1/2 whose walls emit 1 shows 2 everywhere. A disk that reaches past an edge trades a part of its own
// wall for a part of the next: 1 % is allowed for that.
TEST_P(PhotonMapping, FillsAClosedBox) {
    for (const char* direct : {"nee", "photons"}) {
        SCOPED_TRACE(direct);
        const std::string integrator =
            fmt::format("sppm:maxdepth=64,radius=0.02,photonsperiteration=20000,schedule=memoryless,direct={}", direct);
        const Mean mean = mean_of_runs("analytic/box-half.pbrt", settings_of(GetParam(), integrator, 4, 16), 8);
        expect_mean(mean, 2.0, 0.02);
        EXPECT_LT(mean.error(), 0.02);
    }
}

// A unit sphere of albedo 1/2 with a point light of intensity pi in its middle shows 1 from inside. A ball about a point of the
// sphere cuts out a cap of area pi r^2 exactly: nothing is allowed for the radius.
TEST_P(PhotonMapping, FillsASphere) {
    for (const char* direct : {"nee", "photons"}) {
        SCOPED_TRACE(direct);
        const std::string integrator =
            fmt::format("sppm:maxdepth=64,radius=0.05,photonsperiteration=20000,schedule=memoryless,direct={}", direct);
        const Mean mean = mean_of_runs("analytic/sphere-point.pbrt", settings_of(GetParam(), integrator, 4, 16), 8);
        expect_mean(mean, 1.0, 1e-4);
        EXPECT_LT(mean.error(), 0.01);
    }
}

// A floor that sees light only by way of a wall whose shading normals are not its own. Scattering is not symmetric there, and
// photons need the adjoint factor (Veach 1997, section 5.3); path tracing, which starts at the camera, does not. Without the factor, the
// floor is 30 % darker.
TEST_P(PhotonMapping, ShadingNormalsAreTheSameFromBothSides) {
    const std::string scene = R"(
LookAt 1 1 0  1 0 0  0 0 1
Camera "orthographic" "float screenwindow" [ -0.4 0.4 -0.4 0.4 ]
PixelFilter "box"
Film "rgb" "integer xresolution" 16 "integer yresolution" 16
WorldBegin
LightSource "spot" "point3 from" [ 2 1.5 0 ] "point3 to" [ 0 1 0 ] "float coneangle" 15 "rgb I" [ 100 100 100 ]
Material "diffuse" "rgb reflectance" [ 0.8 0.8 0.8 ]
Shape "trianglemesh" "point3 P" [ 0 0.2 -1  0 2 -1  0 2 1  0 0.2 1 ] "integer indices" [ 0 1 2 0 2 3 ]
  "normal N" [ 0.8 -0.6 0  0.8 -0.6 0  0.8 -0.6 0  0.8 -0.6 0 ]
Shape "trianglemesh" "point3 P" [ 0.1 0 -3  4 0 -3  4 0 3  0.1 0 3 ] "integer indices" [ 0 2 1 0 3 2 ]
)";
    const Mean path = mean_of_text_runs(scene, settings_of("cpu", "path:maxdepth=2", 256, 0), 4);
    for (const char* direct : {"nee", "photons"}) {
        SCOPED_TRACE(direct);
        const std::string integrator =
            fmt::format("sppm:maxdepth=2,radius=0.05,photonsperiteration=50000,schedule=memoryless,direct={}", direct);
        const Mean mean = mean_of_text_runs(scene, settings_of(GetParam(), integrator, 4, 0), 8);
        const double error = std::hypot(mean.error(), path.error());
        EXPECT_LT(std::abs(mean.value() - path.value()), normal_threshold(kAlpha) * error)
            << mean.value() << ", path " << path.value() << " +- " << error;
        EXPECT_LT(error, 0.01 * path.value());
    }
}

// Backends follow the same paths and sum in the same order.
TEST_P(PhotonMapping, GivesTheSameImageOnEveryBackend) {
    for (const char* integrator : {"sppm:maxdepth=12", "ppm:maxdepth=12"}) {
        SCOPED_TRACE(integrator);
        const Rendered cpu = render_file(kScenes + "reference/sds-lamp.pbrt", settings_of("cpu", integrator, 2, 64));
        const Rendered here =
            render_file(kScenes + "reference/sds-lamp.pbrt", settings_of(GetParam(), integrator, 2, 64));
        size_t equal = 0;
        for (size_t i = 0; i < cpu.pixels.size(); ++i) equal += cpu.pixels[i].sum == here.pixels[i].sum;
        // A photon that takes a different path at an edge changes the hit points around it: docs/determinism.md gives the
        // share.
        EXPECT_GE(double(equal), 0.999 * double(cpu.pixels.size()));
    }
}

// Effects, lights and cameras, against path tracing by pbrt: the mean of the picture. What a radius blurs at edges and caustics
// nearly averages out; 1 % is allowed for it.
struct Case {
    const char* name;
    const char* options;
};
class PhotonMappingReference : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Scenes, PhotonMappingReference,
                         testing::Values(Case{"diffuse", ""}, Case{"diffuse", ",direct=photons"},
                                         Case{"conductor-smooth", ""}, Case{"conductor-rough", ""},
                                         Case{"conductor-rough", ",direct=photons"}, Case{"dielectric-smooth", ""},
                                         Case{"dielectric-rough", ""}, Case{"coated-diffuse", ""},
                                         Case{"coated-diffuse", ",direct=photons"}, Case{"thin-dielectric", ""},
                                         Case{"diffuse-transmission", ""},
                                         Case{"diffuse-transmission", ",direct=photons"}, Case{"point-spot", ""},
                                         Case{"distant", ""}, Case{"instances", ""}, Case{"thin-lens", ""},
                                         Case{"orthographic", ""}, Case{"textures", ""}),
                         [](const auto& info) { return name_of(std::string(info.param.name) + info.param.options); });

TEST_P(PhotonMappingReference, AgreesWithPathTracing) {
    const std::string file = std::string("reference/") + GetParam().name;
    const std::string integrator = std::string("sppm:maxdepth=12,schedule=memoryless") + GetParam().options;
    const Mean mean = mean_of_runs(file + ".pbrt", settings_of("cpu", integrator, 6, 0), 4);
    Mean reference;
    const Image image = read_image(kScenes + file + ".exr");
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            reference.add(0.2126 * double(image.at(x, y, 0)) + 0.7152 * double(image.at(x, y, 1)) +
                          0.0722 * double(image.at(x, y, 2)));
    // From four runs, the error is only known to a third (t distribution of 3 degrees of freedom), so it has a floor of 0.2 %.
    const double error = std::max(mean.error(), 0.002 * reference.value());
    EXPECT_LT(std::abs(mean.value() - reference.value()), normal_threshold(kAlpha) * error + 0.01 * reference.value())
        << mean.value() << " +- " << mean.error() << " against " << reference.value();
    EXPECT_LT(mean.error(), 0.01 * reference.value());
}

// Every structure that finds all photons gives the image of brute force; stochastic hashing gives its mean.
TEST(PhotonMappingStructures, AllGiveTheSameImage) {
    RenderSettings s = settings_of("cpu", "sppm:maxdepth=12,schedule=memoryless,photonsperiteration=4000", 2, 48);
    s.photon_map = "brute_force";
    const Rendered truth = render_file(kScenes + "reference/sds-lamp.pbrt", s);
    for (const std::string& name : photon_maps().names()) {
        SCOPED_TRACE(name);
        s.photon_map = name;
        if (!create_photon_map(name)->capabilities().exact) continue;
        const Rendered image = render_file(kScenes + "reference/sds-lamp.pbrt", s);
        EXPECT_LT(largest_difference(truth, image), 1e-4);
    }
}

// Ray queries find the same photons in another order: sums of floats differ by rounding.
TEST(PhotonMappingStructures, RayQueryGivesTheSameImage) {
    if (!offers_boxes()) GTEST_SKIP() << "no device that offers VK_KHR_ray_query";
    RenderSettings s = settings_of("vulkan", "sppm:maxdepth=12,schedule=memoryless,photonsperiteration=4000", 2, 48);
    s.photon_map = "bvh:ray_query=off";
    const Rendered walk = render_file(kScenes + "reference/sds-lamp.pbrt", s);
    s.photon_map = "bvh:ray_query=on";
    const Rendered image = render_file(kScenes + "reference/sds-lamp.pbrt", s);
    EXPECT_GT(walk.mean_luminance(), 0.0);
    EXPECT_LT(largest_difference(walk, image), 1e-4);
}

TEST(PhotonMappingStructures, StochasticHashingIsRightInTheMean) {
    RenderSettings s = settings_of("cpu", "sppm:maxdepth=12,schedule=memoryless", 4, 64);
    const Mean exact = mean_of_runs("reference/sds-lamp.pbrt", s, 6);
    for (const char* map : {"stochastic_hash", "stochastic_hash:slots=2", "stochastic_hash:selection=flux",
                            "stochastic_hash:selection=race", "stochastic_hash:table_size=0.0625"}) {
        SCOPED_TRACE(map);
        s.photon_map = map;
        const Mean mean = mean_of_runs("reference/sds-lamp.pbrt", s, 6);
        expect_mean(mean, exact.value(), normal_threshold(kAlpha) * exact.error());
        EXPECT_LT(mean.error(), 0.02 * exact.value());
    }
}

// Same seed, same image, however many threads there are; only the race for buckets is random.
TEST(PhotonMappingDeterminism, ThreadsChangeNothing) {
    int compared = 0;
    for (const std::string& map : photon_maps().names()) {
        if (!create_photon_map(map)->capabilities().fixed_order) continue;
        ++compared;
        for (const char* integrator : {"sppm", "ppm", "sppm:schedule=memoryless,direct=photons"}) {
            SCOPED_TRACE(map + ", " + integrator);
            RenderSettings s = settings_of("cpu", integrator, 3, 48);
            s.photon_map = map;
            s.threads = 1;
            const Rendered one = render_file(kScenes + "reference/sds-lamp.pbrt", s);
            s.threads = 7;
            const Rendered many = render_file(kScenes + "reference/sds-lamp.pbrt", s);
            EXPECT_EQ(one.image.pixels, many.image.pixels);
        }
    }
    EXPECT_GE(compared, 8);
}

// A store that is too small is filled several times; nothing is dropped.
TEST(PhotonMappingStore, PartsAddUp) {
    const std::string integrator = "sppm:maxdepth=12,photonsperiteration=20000";
    const Rendered whole = render_file(kScenes + "reference/sds-lamp.pbrt", settings_of("cpu", integrator, 3, 48));
    for (const char* store : {"7000", "500"}) {
        const Rendered parts =
            render_file(kScenes + "reference/sds-lamp.pbrt", settings_of("cpu", integrator + ",store=" + store, 3, 48));
        EXPECT_LT(largest_difference(whole, parts), 1e-4) << store;
    }
}

// A point light in a ball of glass: path tracing cannot light the surroundings, photons do.
TEST(PhotonMappingCaustics, FindWhatPathTracingCannot) {
    const Rendered path =
        render_file(kScenes + "reference/sds-point.pbrt", settings_of("cpu", "path:maxdepth=24", 16, 32));
    EXPECT_EQ(path.mean_luminance(), 0.0);
    const Mean mean =
        mean_of_runs("reference/sds-point.pbrt", settings_of("cpu", "sppm:maxdepth=24,schedule=memoryless", 12, 0), 4);
    const Image image = read_image(kScenes + "reference/sds-point.exr");
    double reference = 0.0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) reference += double(image.at(x, y, 1));
    reference /= double(image.width) * image.height;
    expect_mean(mean, reference, 0.02 * reference);
    EXPECT_LT(mean.error(), 0.01 * reference);
}

// A lamp in a ball of glass, seen through glass and in a mirror: against very many samples of a path tracer, in blocks of 16x16
// pixels. Allowed: five standard errors of the reference (heavy-tailed: its own estimate may be a third too small), 0.8 % a standard
// error for our noise, and 1 % for the blur of radii.
TEST(PhotonMappingCaustics, AgreeWithAPatientPathTracerBlockByBlock) {
    constexpr int kBlock = 16;
    const Rendered ours =
        render_file(kScenes + "reference/sds-lamp.pbrt", settings_of("cpu", "sppm:maxdepth=24", 64, 0));
    const Image reference = read_image(kScenes + "reference/sds-lamp-path.exr");
    const Image errors = read_image(kScenes + "reference/sds-lamp-path.se.exr");
    int wrong = 0;
    for (int by = 0; by < reference.height; by += kBlock)
        for (int bx = 0; bx < reference.width; bx += kBlock) {
            double a = 0.0, b = 0.0, variance = 0.0;
            for (int y = by; y < by + kBlock; ++y)
                for (int x = bx; x < bx + kBlock; ++x) {
                    a += double(ours.value(x, y, 1)), b += double(reference.at(x, y, 1));
                    variance += std::pow(double(errors.at(x, y, 1)), 2);
                }
            const double limit = 5.0 * std::sqrt(1.8 * variance + std::pow(0.008 * b, 2)) + 0.01 * b;
            wrong += std::abs(a - b) > limit;
            EXPECT_LT(limit, 0.15 * b) << "block " << bx << ", " << by << ": the test cannot tell";
        }
    EXPECT_EQ(wrong, 0);
    if (wrong) save_failure("photon_mapping_sds_lamp", ours.image);
}

}  // namespace
}  // namespace lampyris::test
