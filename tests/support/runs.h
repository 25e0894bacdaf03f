// Renderings of one scene with different seeds: their mean, and its standard error.
#pragma once

#include "support/render.h"
#include "support/statistics.h"

#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <string>

namespace lampyris::test {

inline constexpr double kAlpha = 1e-6;  // false alarms of a z-test
inline const std::string kScenes = std::string(LAMPYRIS_SOURCE_DIR) + "/scenes/";

inline RenderSettings settings_of(const std::string& backend, const std::string& integrator, uint32_t passes,
                                  int size) {
    RenderSettings s;
    s.backend = backend;
    s.integrator = integrator;
    s.samples = passes;
    if (size) s.resolution = {size, size};
    return s;
}

// The mean luminance of renderings with different seeds.
inline Mean mean_of_runs(const std::string& file, RenderSettings settings, int runs) {
    Mean mean;
    for (int i = 0; i < runs; ++i) {
        settings.seed = uint32_t(100 + i);
        mean.add(render_file(kScenes + file, settings).mean_luminance());
    }
    return mean;
}

// The same for a scene given as text.
inline Mean mean_of_text_runs(const std::string& text, RenderSettings settings, uint32_t runs) {
    Mean mean;
    settings.seed = 100;
    for (const Rendered& rendered : render_text_seeds(text, settings, runs)) mean.add(rendered.mean_luminance());
    return mean;
}

inline void expect_mean(const Mean& mean, double expected, double tolerance) {
    EXPECT_LT(std::abs(mean.value() - expected), normal_threshold(kAlpha) * mean.error() + tolerance)
        << mean.value() << " +- " << mean.error();
}

// As a part of a test's name.
inline std::string name_of(std::string text) {
    for (char& c : text)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return text;
}

}  // namespace lampyris::test
