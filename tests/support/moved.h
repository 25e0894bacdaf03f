// The text of a scene file with all of the scene moved, camera included, for tests that its image is the same far from the
// origin.
#pragma once

#include "support/paired.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace lampyris::test {

using Shift = std::array<double, 3>;

// For scenes with one directive per line that neither reset the transform nor include files.
inline std::string moved_scene(const std::string& path, const Shift& by) {
    const auto translate = [&](double sign) {
        return fmt::format("Translate {:.17g} {:.17g} {:.17g}\n", sign * by[0], sign * by[1], sign * by[2]);
    };
    std::ifstream file(path);
    if (!file) throw std::runtime_error("no scene " + path);
    std::string text;
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string first;
        words >> first;
        for (const char* absolute : {"Identity", "Transform", "CoordSysTransform", "Include", "Import"})
            if (first == absolute) throw std::runtime_error(path + " has " + first);
        if (first == "Camera") text += translate(-1);
        text += line + "\n";
        if (first == "WorldBegin") text += translate(1);
        if (first == "ObjectBegin") text += translate(-1);  // directives in here are not in world space
    }
    return text;
}

// Compares the scene at the origin and the moved one, with the same random numbers. Transforms are in double precision, and a
// scene that lies farther out than 64 times its size is moved back (recentre.h). So the effect of the move is at most the
// rounding at 64 sizes, 64 eps = 4e-6 of the scene's size. That is 4e-4 of a lamp's height of 1/100 of the size, and twice that
// for its light: kMoved. If rounding changes a random choice (of alpha, in a coat's walk, at an edge), the difference is noise,
// which is tested with 6 standard errors: a false alarm of 2e-9 each.
inline constexpr double kMoved = 1e-3;

inline void expect_moved_alike(const std::string& path, const std::string& backend, const std::string& integrator,
                               const std::vector<Shift>& shifts, uint32_t samples) {
    RenderSettings settings;
    settings.backend = backend;
    settings.samples = samples;
    settings.seed = 11;
    settings.sampler = "independent";
    settings.resolution = {16, 16};
    settings.integrator = integrator;
    const std::string directory = path.substr(0, path.rfind('/')), name = path.substr(directory.size() + 1);
    const Rendered here = render_text(moved_scene(path, {0, 0, 0}), settings, directory);
    for (const Shift& by : shifts) {
        const Rendered there = render_text(moved_scene(path, by), settings, directory);
        EXPECT_EQ(there.summary.non_finite, here.summary.non_finite);
        const Paired found = compare_paired(here, there);
        fmt::print("{:24} {:9} {:12} ({:.0f}, {:.0f}, {:.0f}): {:+.1e} (+- {:.1e})\n", name, backend,
                   integrator.substr(0, integrator.find(':')), by[0], by[1], by[2], found.relative_difference,
                   found.standard_error);
        EXPECT_LT(std::abs(found.relative_difference), kMoved + 6.0 * found.standard_error)
            << name << " by " << integrator << " on " << backend << ", moved by " << by[0] << " " << by[1] << " "
            << by[2];
        EXPECT_LT(found.standard_error, 0.03) << name << " by " << integrator << ": too noisy to tell";
    }
}

inline constexpr const char* kMovedIntegrators[] = {"path:maxdepth=5", "sppm:maxdepth=5,photonsperiteration=2000",
                                                    "photon_map:maxdepth=5,photons=5000"};

}  // namespace lampyris::test
