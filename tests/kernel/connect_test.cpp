// Connections to the camera undo camera_ray, for every kind of camera; splats follow the pixel filter, and their sums lose
// nothing.
#include "core/scene/filter_table.h"
#include "integrators/bidirectional/bidirectional_host.h"
#include "support/device_run.h"
#include "support/statistics.h"
#include "support/test_scene.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace lampyris::test {
namespace {

using glm::dmat4;
using glm::dvec2;
using glm::dvec3;
using glm::vec3;
using glm::vec4;

constexpr uint32_t kConnect = 0, kPixel = 1, kSplat = 2, kSum = 3;

class Probe {
 public:
    explicit Probe(const std::string& backend)
        : device_(create_device(backend)),
          rays_(device_->compile("kernel/camera_probe.kernel.h", kernel::EFFECT_DEPTH_OF_FIELD)),
          connect_(device_->compile("kernel/connect_probe.kernel.h", kernel::EFFECT_DEPTH_OF_FIELD)) {}

    // Origin and direction of the camera's rays.
    std::vector<vec4> rays(const Scene& scene, const std::vector<vec4>& inputs) {
        return run(*rays_, scene, {1, 0, 0, 0}, inputs, uint32_t(inputs.size()), 2 * inputs.size(), false);
    }
    std::vector<vec4> ask(const Scene& scene, uint32_t kind, const std::vector<vec4>& inputs, size_t results,
                          uint32_t seed = 0) {
        return run(*connect_, scene, {kind, seed, 0, 0}, inputs, uint32_t(inputs.size() / 2), results, true);
    }
    void clear_splats(size_t pixels) {
        splats_ = device_->create_buffer(pixels * kernel::SPLAT_WORDS * 4, "splats");
        splats_->fill_zero();
    }

 private:
    std::vector<vec4> run(const Kernel& kernel, const Scene& scene, glm::uvec4 what, const std::vector<vec4>& inputs,
                          uint32_t count, size_t results, bool splats) {
        if (!splats_) clear_splats(1);
        const BufferHandle out = device_->create_buffer(std::max<size_t>(results, 1) * sizeof(vec4), "results");
        const auto device_scene = device_->upload(scene);
        std::vector<NamedBuffer> buffers{{"what", upload(*device_, std::vector{what}, "what")},
                                         {"inputs", upload(*device_, inputs, "inputs")},
                                         {"results", out}};
        if (splats) buffers.push_back({"splats", splats_});
        device_->run(kernel, device_scene.get(), buffers, 0, count);
        return download<vec4>(out, results);
    }
    std::shared_ptr<Device> device_;
    KernelHandle rays_, connect_;
    BufferHandle splats_;
};

struct CameraCase {
    const char* name;
    uint32_t kind;
    float lens_radius;
    dmat4 to_world;
};

std::vector<CameraCase> cameras() {
    const dmat4 look = glm::inverse(glm::lookAt(dvec3(3, 2, -5), dvec3(0.5, 1, 2), dvec3(0.1, 1, 0))) *
                       glm::scale(dmat4(1), dvec3(1, 1, -1));  // +z forward
    const dmat4 mirrored = glm::scale(dmat4(1), dvec3(-1, 1, 1)) * look;
    const dmat4 stretched = look * glm::scale(dmat4(1), dvec3(0.5, 2, 3));
    return {{"perspective", kernel::CAMERA_PERSPECTIVE, 0, look},
            {"mirrored", kernel::CAMERA_PERSPECTIVE, 0, mirrored},
            {"stretched", kernel::CAMERA_PERSPECTIVE, 0, stretched},
            {"thin lens", kernel::CAMERA_PERSPECTIVE, 0.3f, look},
            {"stretched thin lens", kernel::CAMERA_PERSPECTIVE, 0.3f, stretched},
            {"orthographic", kernel::CAMERA_ORTHOGRAPHIC, 0, look},
            {"stretched orthographic", kernel::CAMERA_ORTHOGRAPHIC, 0, stretched},
            {"orthographic thin lens", kernel::CAMERA_ORTHOGRAPHIC, 0.3f, mirrored}};
}

void set_camera(Scene& scene, const CameraCase& c) {
    kernel::CameraRecord& camera = scene.record.camera;
    const kernel::TransformRecord m = transform_of(c.to_world);
    camera.kind = c.kind;
    camera.to0 = m.to0, camera.to1 = m.to1, camera.to2 = m.to2;
    camera.from0 = m.from0, camera.from1 = m.from1, camera.from2 = m.from2;
    camera.volume = float(std::abs(glm::determinant(glm::dmat3(c.to_world))));
    camera.lens_radius = c.lens_radius;
    camera.focal_distance = 4.0f;
    camera.resolution_x = 64, camera.resolution_y = 32;
    camera.screen = {-1.6f, 0.8f, 0.05f, -0.05f};
    camera.filter_kind = kernel::PIXEL_FILTER_BOX;
    camera.filter_radius_x = camera.filter_radius_y = 0.5f;
}

// The importance is that of rays through neighbouring film points, by differences: the solid angle, or the cross section of the beam,
// that a pixel covers at the point.
TEST(Connect, UndoesTheCamerasRays) {
    for (const std::string& backend : kernel_backends()) {
        Probe probe(backend);
        for (const CameraCase& c : cameras()) {
            SCOPED_TRACE(backend + ", " + c.name);
            TestScene scene;
            set_camera(scene.scene, c);
            const Scene& finished = scene.finish();
            std::mt19937 random(5);
            std::uniform_real_distribution<float> uniform(0.02f, 0.98f);
            constexpr float kStep = 0.25f;
            std::vector<vec4> inputs;
            for (int i = 0; i < 200; ++i) {
                const vec4 at(uniform(random) * 64, uniform(random) * 32, uniform(random), uniform(random));
                inputs.insert(inputs.end(), {at, at + vec4(kStep, 0, 0, 0), at - vec4(kStep, 0, 0, 0),
                                             at + vec4(0, kStep, 0, 0), at - vec4(0, kStep, 0, 0)});
            }
            const std::vector<vec4> rays = probe.rays(finished, inputs);
            std::vector<vec4> points;
            std::vector<float> ways;
            for (size_t i = 0; i < inputs.size(); i += 5) {
                ways.push_back(0.5f + 8 * uniform(random));
                points.emplace_back(vec3(rays[2 * i]) + ways.back() * vec3(rays[2 * i + 1]), 0);
                points.emplace_back(inputs[i].z, inputs[i].w, 0, 0);
            }
            const std::vector<vec4> found = probe.ask(finished, kConnect, points, 3 * points.size() / 2);
            for (size_t i = 0; i < points.size() / 2; ++i) {
                const size_t ray = 10 * i;
                const vec4 connection = found[3 * i];
                EXPECT_NEAR(connection.x, inputs[5 * i].x, 2e-3);
                EXPECT_NEAR(connection.y, inputs[5 * i].y, 2e-3);
                EXPECT_NEAR(connection.z, ways[i], 1e-4 * ways[i]);
                EXPECT_LT(glm::length(vec3(found[3 * i + 1]) + vec3(rays[ray + 1])), 1e-4f);
                EXPECT_LT(glm::length(vec3(found[3 * i + 2]) - vec3(rays[ray])), 1e-4f);
                // Where the rays of the pixel's edges are at the point's distance.
                const auto place = [&](int which) {
                    return dvec3(rays[ray + 2 * which]) + double(ways[i]) * dvec3(rays[ray + 2 * which + 1]);
                };
                const dvec3 x = (place(1) - place(2)) / (2.0 * kStep), y = (place(3) - place(4)) / (2.0 * kStep);
                const double area = std::abs(glm::dot(glm::cross(x, y), dvec3(rays[ray + 1])));
                EXPECT_NEAR(connection.w * area, 1, 2e-3);
            }
        }
    }
}

TEST(Connect, PointsBehindTheCameraAreNotSeen) {
    for (const std::string& backend : kernel_backends()) {
        Probe probe(backend);
        for (const CameraCase& c : cameras()) {
            SCOPED_TRACE(backend + ", " + c.name);
            TestScene scene;
            set_camera(scene.scene, c);
            const dvec3 behind(c.to_world * glm::dvec4(0.2, 0.1, -1, 1));
            EXPECT_EQ(probe.ask(scene.finish(), kConnect, {vec4(behind, 0), vec4(0.5f, 0.5f, 0, 0)}, 3)[0].z, -1);
        }
    }
}

struct FilterCase {
    const char* name;
    uint32_t kind;
    float rx, ry;
    std::function<double(double)> x, y;
};

// The expected weight of each pixel is the filter there, integral 1. Each of 3 places and 7 filters has a z-test per pixel:
// below 1e4 tests at 1e-9, fixed seed.
TEST(Connect, SplatsFollowThePixelFilter) {
    const auto box = [](double r) { return [r](double x) { return x >= -r && x < r ? 0.5 / r : 0.0; }; };
    const auto tent = [](double r) { return [r](double x) { return std::max(0.0, r - std::abs(x)) / (r * r); }; };
    const auto gaussian = [](double r, double s) { return [=](double x) { return gaussian_filter(x, r, s); }; };
    const auto mitchell = [](double r) { return [=](double x) { return mitchell_filter(x, r, 1.0 / 3, 1.0 / 3); }; };
    const auto sinc = [](double r) { return [=](double x) { return sinc_filter(x, r, 3); }; };
    const FilterCase filters[] = {
        {"box", kernel::PIXEL_FILTER_BOX, 0.5f, 0.5f, box(0.5), box(0.5)},
        {"wide box", kernel::PIXEL_FILTER_BOX, 1.3f, 0.7f, box(1.3), box(0.7)},
        {"triangle", kernel::PIXEL_FILTER_TRIANGLE, 2, 1.5f, tent(2), tent(1.5)},
        {"narrow triangle", kernel::PIXEL_FILTER_TRIANGLE, 0.3f, 0.5f, tent(0.3), tent(0.5)},
        {"gaussian", kernel::PIXEL_FILTER_GAUSSIAN, 1.5f, 2, gaussian(1.5, 0.5), gaussian(2, 0.8)},
        {"mitchell", kernel::PIXEL_FILTER_GAUSSIAN, 2, 2, mitchell(2), mitchell(2)},
        {"sinc", kernel::PIXEL_FILTER_GAUSSIAN, 4, 3, sinc(4), sinc(3)}};
    constexpr size_t kSplats = 40000;
    for (const std::string& backend : kernel_backends()) {
        Probe probe(backend);
        for (const FilterCase& f : filters) {
            SCOPED_TRACE(backend + ", " + f.name);
            TestScene scene;
            set_camera(scene.scene, cameras()[0]);
            kernel::CameraRecord& camera = scene.scene.record.camera;
            camera.filter_kind = f.kind;
            camera.filter_radius_x = f.rx, camera.filter_radius_y = f.ry;
            if (f.kind == kernel::PIXEL_FILTER_GAUSSIAN) {
                camera.filter_tables = append_filter_table(f.x, f.rx, f.y, f.ry, scene.scene.distributions);
                camera.filter_intervals = kFilterTableSize;
            }
            const Scene& finished = scene.finish();
            const auto integral = [](const std::function<double(double)>& h, double r) {
                double sum = 0;
                for (int i = 0; i < 20000; ++i) sum += h(r * (2 * (i + 0.5) / 20000 - 1));
                return sum * 2 * r / 20000;
            };
            const double allowed = f.name == std::string("sinc") ? 6e-3 : 1e-3;
            const double scale = 1 / (integral(f.x, f.rx) * integral(f.y, f.ry));
            for (const dvec2 raster : {dvec2(10.5, 7.5), dvec2(0.13, 31.9), dvec2(20.77, 12.26)}) {
                std::mt19937 random(11);
                std::uniform_real_distribution<float> uniform(0, 1);
                std::vector<vec4> inputs;
                for (size_t i = 0; i < kSplats; ++i) {
                    inputs.emplace_back(raster, uniform(random), uniform(random));
                    inputs.emplace_back(0);
                }
                const std::vector<vec4> splats = probe.ask(finished, kPixel, inputs, kSplats);
                for (int y = int(raster.y) - 5; y <= int(raster.y) + 5; ++y)
                    for (int x = int(raster.x) - 5; x <= int(raster.x) + 5; ++x) {
                        Mean mean;
                        for (const vec4& s : splats) mean.add(int(s.x) == x && int(s.y) == y ? double(s.z) : 0.0);
                        const double expected = scale * f.x(raster.x - (x + 0.5)) * f.y(raster.y - (y + 0.5));
                        // The filter's table is linear between its nodes, and no interval changes its sign: near a zero, sinc is off by
                        // what it changes over an interval.
                        EXPECT_LT(std::abs(mean.value() - expected), normal_threshold(1e-9) * mean.error() + allowed)
                            << x << " " << y << ": " << mean.value() << ", right: " << expected;
                    }
            }
        }
    }
}

// body(probe, scene) with an empty scene that has a camera.
template <typename Body>
void on_every_backend(const Body& body) {
    for (const std::string& backend : kernel_backends()) {
        SCOPED_TRACE(backend);
        Probe probe(backend);
        TestScene scene;
        set_camera(scene.scene, cameras()[0]);
        body(probe, scene.finish());
    }
}

TEST(Connect, SumsOfSplatsLoseNothing) {
    constexpr size_t kSplats = 300'000, kPixels = 3;
    constexpr float kQuantum = 0x1p-20f;
    on_every_backend([&](Probe& probe, const Scene& finished) {
        std::mt19937 random(3);
        std::normal_distribution<float> normal;
        std::vector<vec4> inputs;
        glm::dvec3 sums[kPixels] = {}, sizes[kPixels] = {};
        for (size_t i = 0; i < kSplats; ++i) {
            const uint32_t pixel = i % kPixels;
            // Pixel 0: mixed signs and sizes. Pixel 1: far below a quantum. Pixel 2: far above 2^32 of them, that cancel.
            const vec3 value = pixel == 0
                                   ? vec3(normal(random), -normal(random) * 1000, std::abs(normal(random)) * 1e-3f)
                               : pixel == 1 ? vec3(1e-4f * kQuantum, -0.25f * kQuantum, 0)
                                            : vec3(i % 2 ? 1e9f : -1e9f, 3e6f, i % 2 ? 0x1p30f : -0x1p30f);
            inputs.emplace_back(value, float(pixel));
            inputs.emplace_back(kQuantum, 0, 0, 0);
            sums[pixel] += glm::dvec3(value), sizes[pixel] += glm::abs(glm::dvec3(value));
        }
        probe.clear_splats(kPixels);
        probe.ask(finished, kSplat, inputs, 0, 17);
        const std::vector<vec4> questions(2 * kPixels, vec4(kQuantum, 0, 0, 0));
        const std::vector<vec4> found = probe.ask(finished, kSum, questions, kPixels);
        for (uint32_t p = 0; p < kPixels; ++p) {
            EXPECT_EQ(found[p].w, 0.0f);
            for (int c = 0; c < 3; ++c) {
                // Each splat is rounded to one of two neighbours: a standard deviation of at most half a quantum. 6 of them, and the
                // rounding of the sum to a float.
                const double tolerance =
                    6 * 0.5 * kQuantum * std::sqrt(double(kSplats) / kPixels) + std::abs(sums[p][c]) * 0x1p-22;
                EXPECT_NEAR(found[p][c], sums[p][c], tolerance) << p << " " << c;
            }
        }
        EXPECT_NEAR(found[1].x, 1e5 * 1e-4 * kQuantum, 6 * std::sqrt(10.0) * kQuantum);  // 10 +- 3 quanta, not 0
    });
}

// Numbers of 128 bits: each pair cancels but for the last number, whatever is carried or borrowed on the way.
TEST(Connect, SumsOfSplatsCarryThroughAllWords) {
    on_every_backend([&](Probe& probe, const Scene& finished) {
        std::vector<vec4> inputs;
        std::vector<glm::dvec3> expected;
        // The sums are given: doubles have too few digits for them.
        const auto pixel = [&](const std::vector<vec3>& values, const glm::dvec3& sum) {
            for (const vec3 value : values) {
                inputs.emplace_back(value, float(expected.size()));
                inputs.emplace_back(1, 0, 0, 0);  // a quantum
            }
            expected.push_back(sum);
        };
        for (const int power : {2, 23, 31, 32, 40, 63, 64, 70, 94}) {
            const float large = std::ldexp(1.0f, power);
            pixel({vec3(large, -large, 3), vec3(-large, large, -5), vec3(large, -large, large)},
                  {large, -large, double(large) - 2});
            pixel({vec3(-1, 1, -large), vec3(large, -large, 0.75f * large), vec3(-large, large, -1)},
                  {-1, 1, -0.25 * double(large) - 1});
        }
        pixel(std::vector<vec3>(1000, vec3(0x1p95f, -0x1p95f, 0x1.8p63f)),
              {1000 * 0x1p95, -1000 * 0x1p95, 1500 * 0x1p63});
        probe.clear_splats(expected.size());
        probe.ask(finished, kSplat, inputs, 0, 17);
        const auto found = probe.ask(finished, kSum, std::vector<vec4>(2 * expected.size(), vec4(1, 0, 0, 0)),
                                     uint32_t(expected.size()));
        for (size_t i = 0; i < expected.size(); ++i) {
            EXPECT_EQ(found[i].w, 0.0f);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(found[i][c], expected[i][c], std::abs(expected[i][c]) * 0x1p-22) << i << " " << c;
        }
    });
}

TEST(Connect, SplatsBeyondTheSumsAreCounted) {
    on_every_backend([&](Probe& probe, const Scene& finished) {
        probe.clear_splats(1);
        const float inf = std::numeric_limits<float>::infinity();
        std::vector<vec4> inputs;
        for (const vec3 value : {vec3(inf, 0, 0), vec3(0, std::nanf(""), 0), vec3(1e30f, 0, 0), vec3(1, 2, 3)}) {
            inputs.emplace_back(value, 0);
            inputs.emplace_back(1e-6f, 0, 0, 0);
        }
        probe.ask(finished, kSplat, inputs, 0, 1);
        const vec4 found = probe.ask(finished, kSum, {vec4(1e-6f, 0, 0, 0), vec4(0)}, 1)[0];
        EXPECT_NEAR(found.x, 1, 2e-6);
        EXPECT_NEAR(found.z, 3, 2e-6);
        EXPECT_EQ(found.w, 3.0f);
    });
}

}  // namespace
}  // namespace lampyris::test
