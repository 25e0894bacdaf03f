// An integrator's image is the same on every backend and with any number of threads, and a crop is that part of it.
#pragma once

#include "support/agreement.h"
#include "support/runs.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace lampyris::test {

// `settings`: of the rendering on one thread of the CPU. To the bit for other numbers of threads; on other backends, at least
// `share` of the pixels.
inline void expect_same_images(const std::string& scene, RenderSettings settings, double share,
                               const std::vector<std::string>& backends) {
    settings.backend = "cpu";
    settings.threads = 1;
    const Rendered one = render_file(scene_path(scene), settings);
    for (const std::string& backend : backends)
        for (const unsigned threads : {1u, 2u, 7u}) {
            if (backend != "cpu" && threads > 1) continue;
            SCOPED_TRACE(fmt::format("{} {} {} {}", scene, settings.integrator, backend, threads));
            settings.backend = backend;
            settings.threads = threads;
            const Rendered other = render_file(scene_path(scene), settings);
            size_t equal = 0;
            for (size_t i = 0; i < one.pixels.size(); ++i) equal += one.pixels[i].sum == other.pixels[i].sum;
            EXPECT_GE(double(equal), (backend == "cpu" ? 1.0 : share) * double(one.pixels.size()));
        }
}

inline void expect_same_on_every_backend(const std::string& scene, const RenderSettings& settings, double share) {
    expect_same_images(scene, settings, share, usable_backends());
}

// For further scenes: on Vulkan a compiler is at work for seconds for each, and backends_long_test has all of them there.
inline void expect_same_on_the_cpu(const std::string& scene, const RenderSettings& settings, double share) {
    expect_same_images(scene, settings, share, {"cpu", "cpu-bvh2"});
}

inline void expect_crop_is_part_of_the_whole(const std::string& scene, RenderSettings settings) {
    settings.resolution = {32, 32};
    const Rendered whole_image = render_file(scene_path(scene), settings);
    settings.crop = {{5, 9, 20, 30}};
    const Rendered part = render_file(scene_path(scene), settings);
    for (int y = 9; y < 30; ++y)
        for (int x = 5; x < 20; ++x)
            for (int c = 0; c < 3; ++c)
                EXPECT_EQ(part.value(x - 5, y - 9, c), whole_image.value(x, y, c)) << x << " " << y;
}

}  // namespace lampyris::test
