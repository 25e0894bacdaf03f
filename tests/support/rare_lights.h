// Scenes whose light is rarely sampled: a strong source that the picture does not see, and a weak one that it does.
#pragma once

#include "support/runs.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <array>
#include <numbers>
#include <string>

namespace lampyris::test {

// A wall (albedo 1/2, z = 0) lit by a square lamp (side 2, z = -6, radiance 1), which is divided into 2 n^2 triangles, and a
// distant lamp behind the wall with all but 1e-5 of the power. The picture shows [-3, 3]^2 of the wall.
inline std::string lamp_in_pieces(int n) {
    std::string text =
        "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nPixelFilter \"box\"\nSampler "
        "\"independent\"\n"
        "LookAt 0 0 -3  0 0 0  0 1 0\nCamera \"orthographic\" \"float screenwindow\" [ -3 3 -3 3 ]\nWorldBegin\n"
        "AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [ 1e5 1e5 1e5 ]\nShape \"trianglemesh\" "
        "\"point3 P\" [ -1 -1 500 1 -1 500 0 1 500 ]\nAttributeEnd\n"
        "Material \"diffuse\" \"rgb reflectance\" [ .5 .5 .5 ]\n"
        "Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ] \"point3 P\" [ -9 -9 0 9 -9 0 9 9 0 -9 9 0 ]\n"
        "AreaLightSource \"diffuse\" \"rgb L\" [ 1 1 1 ]\nShape \"trianglemesh\" \"point3 P\" [";
    for (int y = 0; y <= n; ++y)
        for (int x = 0; x <= n; ++x) text += fmt::format(" {} {} -6", 2.0 * x / n - 1.0, 2.0 * y / n - 1.0);
    text += " ] \"integer indices\" [";
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const int a = y * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;
            text += fmt::format(" {} {} {} {} {} {}", a, b, d, a, d, c);
        }
    return text + " ]\n";
}

// The wall's radiance at a point, by Lambert's formula for a polygon.
inline double wall_radiance(double x, double y) {
    const std::array<glm::dvec3, 4> corners{{{-1, -1, -6}, {1, -1, -6}, {1, 1, -6}, {-1, 1, -6}}};
    double sum = 0.0;
    for (size_t i = 0; i < 4; ++i) {
        const glm::dvec3 p(x, y, 0.0);
        const glm::dvec3 a = glm::normalize(corners[i] - p), b = glm::normalize(corners[(i + 1) % 4] - p);
        sum += std::acos(glm::dot(a, b)) * glm::normalize(glm::cross(a, b)).z;
    }
    return 0.5 / std::numbers::pi * std::abs(sum) / 2.0;
}

inline double mean_wall_radiance() {
    constexpr int kGrid = 60;
    double sum = 0.0;
    for (int y = 0; y < kGrid; ++y)
        for (int x = 0; x < kGrid; ++x)
            sum += wall_radiance(6.0 * (x + 0.5) / kGrid - 3.0, 6.0 * (y + 0.5) / kGrid - 3.0);
    return sum / (kGrid * kGrid);
}

// The mean of a picture against its closed form, on the CPU by sixteen runs with different seeds: Student's t with 15 degrees
// of freedom exceeds 8 with a probability of 9e-7. `allowed`: the blur of a radius; `detectable`: the relative error that the
// runs must be able to detect. Other backends follow the same paths (docs/determinism.md): because each compiles its shaders
// again, they make only one of the runs, which must give the CPU's mean within the error of one run.
inline void expect_mean_of_runs(const std::string& text, const std::string& backend, const std::string& integrator,
                                uint32_t passes, double expected, double allowed, double detectable) {
    SCOPED_TRACE(integrator);
    constexpr uint32_t kRuns = 16;
    RenderSettings settings = settings_of("cpu", integrator, passes, 0);
    if (backend == "cpu") {
        const Mean mean = mean_of_text_runs(text, settings, kRuns);
        fmt::print("{:.5g} +- {:.2g}, expected {:.5g}\n", mean.value(), mean.error(), expected);
        EXPECT_LT(std::abs(mean.value() - expected), 8.0 * mean.error() + allowed * expected)
            << mean.value() << " +- " << mean.error() << ", expected " << expected;
        EXPECT_LT(8.0 * mean.error(), detectable * expected);
        return;
    }
    const double on_cpu = render_text(text, settings).mean_luminance();
    settings.backend = backend;
    const double here = render_text(text, settings).mean_luminance();
    fmt::print("{:.5g}, on the CPU {:.5g}, expected {:.5g}\n", here, on_cpu, expected);
    EXPECT_NEAR(here / on_cpu, 1.0, 1e-3);
    EXPECT_NEAR(here / expected, 1.0, allowed + std::sqrt(double(kRuns)) * detectable);
}

}  // namespace lampyris::test
