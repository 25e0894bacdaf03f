#include "support/random_scenes.h"

#include "support/agreement.h"
#include "support/random_scene.h"
#include "support/render.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace lampyris::test {
namespace {

struct Mean {
    double mean = 0.0, variance = 0.0;  // of the mean
};

Mean mean_of(const std::string& scene, const std::string& integrator) {
    RenderSettings settings;
    settings.integrator = integrator;
    settings.samples = 32;
    const std::vector<Rendered> images = render_text_seeds(scene, settings, kImages);
    Mean result;
    for (const Rendered& image : images) {
        EXPECT_EQ(image.summary.non_finite, 0u) << integrator << "\n" << scene;
        result.mean += image.mean_luminance() / kImages;
    }
    for (const Rendered& image : images)
        result.variance += std::pow(image.mean_luminance() - result.mean, 2) / (kImages - 1) / kImages;
    return result;
}

}  // namespace

void expect_integrators_agree(uint32_t seed, const std::vector<std::string>& integrators) {
    const std::string scene = random_scene(seed, false);
    const Mean path = mean_of(scene, "path:maxdepth=4");
    for (const std::string& integrator : integrators) {
        // The default bootstrap is for larger films, and would take most of the time.
        const char* more = integrator == "mlt" ? ",bootstrapsamples=2048" : "";
        const Mean other = mean_of(scene, integrator + ":maxdepth=4" + more);
        const double error = std::sqrt(path.variance + other.variance);
        EXPECT_LE(std::abs(other.mean - path.mean), kLimit * error + 1e-5 * path.mean)
            << integrator << ": " << other.mean << ", path: " << path.mean << " +- " << error << "\nseed " << seed
            << ":\n"
            << scene;
        // What the comparison can show.
        EXPECT_LE(error, 0.03 * path.mean) << integrator << ", seed " << seed;
    }
}

void expect_backends_agree(uint32_t seed, const std::string& backend, const std::string& integrator) {
    const std::string scene = random_scene(seed, true);
    RenderSettings settings;
    settings.integrator = integrator;
    settings.samples = 4;
    settings.seed = seed;
    const Rendered cpu = render_text(scene, settings);
    settings.backend = backend;
    const Rendered other = render_text(scene, settings);
    const Agreement found = agreement(cpu, other, 1e-4);
    EXPECT_GE(found.share(), 0.97) << integrator << " on " << backend << ", seed " << seed << ":\n" << scene;
    EXPECT_EQ(cpu.summary.non_finite + other.summary.non_finite, 0u) << "seed " << seed << ":\n" << scene;
    if (found.share() >= 0.97) return;
    save_failure(fmt::format("random-{}-cpu", seed), cpu.image);
    save_failure(fmt::format("random-{}-{}", seed, backend), other.image);
}

}  // namespace lampyris::test
