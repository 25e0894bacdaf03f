// Pixel filters are sampled in proportion to their absolute value with the right sign, and cameras generate rays in the right
// directions.
#include "core/scene/filter_table.h"
#include "support/device_run.h"
#include "support/histogram.h"
#include "support/test_scene.h"

#include <gtest/gtest.h>

namespace lampyris::test {
namespace {

using glm::dvec2;
using glm::dvec3;
using glm::vec3;
using glm::vec4;

std::vector<vec4> run(Device& device, const Scene& scene, glm::uvec4 what, const std::vector<vec4>& inputs,
                      uint32_t count, size_t results) {
    const BufferHandle what_buffer = upload(device, std::vector{what}, "what");
    const BufferHandle in = upload(device, inputs, "inputs");
    const BufferHandle out = device.create_buffer(count * results * sizeof(vec4), "results");
    const auto kernel = device.compile("kernel/camera_probe.kernel.h", kernel::EFFECT_DEPTH_OF_FIELD);
    const auto device_scene = device.upload(scene);
    const NamedBuffer buffers[] = {{"what", what_buffer}, {"inputs", in}, {"results", out}};
    device.run(*kernel, device_scene.get(), buffers, 0, count);
    return download<vec4>(out, count * results);
}

struct FilterCase {
    const char* name;
    uint32_t kind;
    double rx, ry;
    std::function<double(double)> x, y;
};

std::vector<FilterCase> filters() {
    const auto box = [](double) { return 1.0; };
    const auto tent = [](double r) { return [r](double x) { return std::max(0.0, r - std::abs(x)); }; };
    const auto gaussian = [](double r, double sigma) { return [=](double x) { return gaussian_filter(x, r, sigma); }; };
    const auto mitchell = [](double r) { return [=](double x) { return mitchell_filter(x, r, 1.0 / 3, 1.0 / 3); }; };
    const auto sinc = [](double r) { return [=](double x) { return sinc_filter(x, r, 3); }; };
    return {{"box", kernel::PIXEL_FILTER_BOX, 0.5, 0.75, box, box},
            {"triangle", kernel::PIXEL_FILTER_TRIANGLE, 2, 1.5, tent(2), tent(1.5)},
            {"gaussian", kernel::PIXEL_FILTER_GAUSSIAN, 1.5, 2, gaussian(1.5, 0.5), gaussian(2, 0.8)},
            {"mitchell", kernel::PIXEL_FILTER_GAUSSIAN, 2, 2, mitchell(2), mitchell(2)},
            {"sinc", kernel::PIXEL_FILTER_GAUSSIAN, 4, 3, sinc(4), sinc(3)}};
}

// False-alarm rate: 5 filters at 1e-6 each, fixed seed.
TEST(Camera, PixelFiltersAreSampled) {
    constexpr uint32_t kSamples = 200000;
    constexpr double kAlpha = 1e-6;
    for (const std::string& backend : kernel_backends()) {
        const auto device = create_device(backend);
        for (const FilterCase& f : filters()) {
            SCOPED_TRACE(backend + ", " + f.name);
            TestScene scene;
            kernel::CameraRecord& camera = scene.scene.record.camera;
            camera.filter_kind = f.kind;
            camera.filter_radius_x = f.rx;
            camera.filter_radius_y = f.ry;
            if (f.kind == kernel::PIXEL_FILTER_GAUSSIAN) {
                camera.filter_tables = append_filter_table(f.x, f.rx, f.y, f.ry, scene.scene.distributions);
                camera.filter_intervals = kFilterTableSize;
            }
            const auto samples = run(*device, scene.finish(), {0, 7, 0, 0}, {vec4(0)}, kSamples, 1);

            // Integrals by the midpoint rule.
            double absolute = 0, integral = 0;
            constexpr int kGrid = 1000;
            for (int y = 0; y < kGrid; ++y) {
                for (int x = 0; x < kGrid; ++x) {
                    const double value =
                        f.x(f.rx * (2 * (x + 0.5) / kGrid - 1)) * f.y(f.ry * (2 * (y + 0.5) / kGrid - 1));
                    absolute += std::abs(value);
                    integral += value;
                }
            }
            absolute *= 4 * f.rx * f.ry / (double(kGrid) * kGrid);
            integral *= 4 * f.rx * f.ry / (double(kGrid) * kGrid);

            const Domain domain{4 * f.rx * f.ry,
                                [&](vec4 p) { return dvec2((p.x / f.rx + 1) / 2, (p.y / f.ry + 1) / 2); },
                                [&](dvec2 s) { return vec4(f.rx * (2 * s.x - 1), f.ry * (2 * s.y - 1), 0, 0); }};
            const auto density = [&](double distortion) {
                return [&, distortion](const std::vector<vec4>& points) {
                    std::vector<double> values;
                    for (const vec4& p : points)
                        values.push_back(std::abs(f.x(p.x) * f.y(p.y)) / absolute *
                                         (1 + distortion * std::sin(7 * p.x / f.rx)));
                    return values;
                };
            };
            Histogram observed{24, 24};
            Mean weight;
            int wrong_signs = 0;
            for (const vec4& s : samples) {
                observed.add(domain, s);
                weight.add(s.z);
                const double value = f.x(s.x) * f.y(s.y);
                if (value * s.z < 0 && std::abs(value) > 1e-2 * std::abs(f.x(0) * f.y(0))) ++wrong_signs;
                EXPECT_NEAR(std::abs(s.z), absolute / integral, 3e-3 * absolute / integral);
            }
            EXPECT_EQ(wrong_signs, 0);
            EXPECT_LT(std::abs(weight.value() - 1), normal_threshold(kAlpha) * weight.error() + 3e-3);
            auto expected = expected_counts(domain, 24, 24, 8, kSamples, density(0));
            EXPECT_NEAR(expected.back() / kSamples, 0, 3e-3);
            expected.back() = 0;
            EXPECT_GT(chi_squared_test(observed.cells, expected).p, kAlpha);
            auto wrong = expected_counts(domain, 24, 24, 8, kSamples, density(0.1));
            wrong.back() = 0;
            EXPECT_LT(chi_squared_test(observed.cells, wrong).p, kAlpha) << "the test has no power";
        }
    }
}

// A camera of 200 x 100 pixels that looks along -x from (5, 1, 2), z up.
kernel::CameraRecord camera(uint32_t kind) {
    kernel::CameraRecord c{};
    c.kind = kind;
    // Columns of world-from-camera: right (y), up (z), forward (-x), position.
    c.to0 = vec4(0, 0, -1, 5);
    c.to1 = vec4(1, 0, 0, 1);
    c.to2 = vec4(0, 1, 0, 2);
    c.screen = vec4(-2, 1, 4.0f / 200, -2.0f / 100);
    return c;
}

TEST(Camera, RaysGoThroughTheirPixels) {
    for (const std::string& backend : kernel_backends()) {
        SCOPED_TRACE(backend);
        const auto device = create_device(backend);
        const std::vector<vec4> inputs = {
            {100, 50, 0.3f, 0.4f}, {0, 0, 0.1f, 0.9f}, {200, 100, 0.5f, 0.5f}, {150, 20, 0.7f, 0.2f}};
        for (const uint32_t kind : {kernel::CAMERA_PERSPECTIVE, kernel::CAMERA_ORTHOGRAPHIC}) {
            TestScene scene;
            scene.scene.record.camera = camera(kind);
            const auto rays = run(*device, scene.finish(), {1, 0, 0, 0}, inputs, uint32_t(inputs.size()), 2);
            for (size_t i = 0; i < inputs.size(); ++i) {
                const double x = -2 + inputs[i].x * 0.02, y = 1 - inputs[i].y * 0.02;
                const bool perspective = kind == kernel::CAMERA_PERSPECTIVE;
                const dvec3 origin = perspective ? dvec3(5, 1, 2) : dvec3(5, 1 + x, 2 + y);
                const dvec3 direction = perspective ? glm::normalize(dvec3(-1, x, y)) : dvec3(-1, 0, 0);
                EXPECT_LT(glm::length(dvec3(rays[2 * i]) - origin), 1e-6);
                EXPECT_LT(glm::length(dvec3(rays[2 * i + 1]) - direction), 1e-6);
            }
        }
    }
}

// All rays of a film point meet in the plane of focus, and start all over the lens.
TEST(Camera, LensRaysMeetInThePlaneOfFocus) {
    constexpr float kRadius = 0.25f, kFocus = 3.0f;
    for (const std::string& backend : kernel_backends()) {
        SCOPED_TRACE(backend);
        const auto device = create_device(backend);
        for (const uint32_t kind : {kernel::CAMERA_PERSPECTIVE, kernel::CAMERA_ORTHOGRAPHIC}) {
            TestScene scene;
            scene.scene.record.camera = camera(kind);
            scene.scene.record.camera.lens_radius = kRadius;
            scene.scene.record.camera.focal_distance = kFocus;
            std::vector<vec4> inputs;
            for (int i = 0; i < 400; ++i)
                inputs.emplace_back(130, 70, (float(i % 20) + 0.5f) / 20, (float(i / 20) + 0.5f) / 20);  // NOLINT
            const auto rays = run(*device, scene.finish(), {1, 0, 0, 0}, inputs, uint32_t(inputs.size()), 2);
            const bool perspective = kind == kernel::CAMERA_PERSPECTIVE;
            const double x = -2 + 130 * 0.02, y = 1 - 70 * 0.02, scale = perspective ? kFocus : 1;
            const dvec3 focus(5 - kFocus, 1 + scale * x, 2 + scale * y);
            double farthest = 0, mean_square = 0;
            dvec3 mean(0.0);
            for (size_t i = 0; i < inputs.size(); ++i) {
                const dvec3 o(rays[2 * i]), d(rays[2 * i + 1]);
                EXPECT_NEAR(glm::length(d), 1, 1e-6);
                EXPECT_LT(glm::length(o + d * ((focus.x - o.x) / d.x) - focus), 1e-5);
                const dvec3 on_lens = o - (perspective ? dvec3(5, 1, 2) : dvec3(5, 1 + x, 2 + y));
                EXPECT_NEAR(on_lens.x, 0, 1e-6);
                farthest = std::max(farthest, glm::length(on_lens));
                mean += on_lens / double(inputs.size());
                mean_square += glm::dot(on_lens, on_lens) / double(inputs.size());
            }
            // Uniform over a disk: E r^2 = R^2 / 2. A radius that is 0.5 % wrong shows.
            EXPECT_NEAR(mean_square, kRadius * kRadius / 2.0, 0.01 * kRadius * kRadius / 2.0);
            EXPECT_LT(farthest, kRadius * 1.0001);
            EXPECT_GT(farthest, kRadius * 0.9);
            EXPECT_LT(glm::length(mean), 0.1 * kRadius);
        }
    }
}

}  // namespace
}  // namespace lampyris::test
