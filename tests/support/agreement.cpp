#include "support/agreement.h"

#include "core/scene/load.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "support/device_run.h"

namespace lampyris::test {

Agreement agreement(const Rendered& a, const Rendered& b, double tolerance) {
    Agreement result;
    double brightest = 0.0;
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x)
            for (int c = 0; c < 3; ++c) brightest = std::max(brightest, std::abs(double(a.value(x, y, c))));
    for (int y = 0; y < a.height; ++y) {
        for (int x = 0; x < a.width; ++x) {
            double off = 0.0;
            for (int c = 0; c < 3; ++c) {
                const double p = a.value(x, y, c), q = b.value(x, y, c);
                if (p == q) continue;
                off = std::max(off, std::abs(p - q) / std::max({std::abs(p), std::abs(q), 1e-3 * brightest}));
            }
            ++result.pixels;
            result.identical += off == 0.0;
            result.within += off <= tolerance;
            result.largest = std::max(result.largest, off);
            constexpr size_t kShown = 4;
            if (!(off <= tolerance) && result.diverging.size() < kShown) result.diverging.push_back({x, y});
        }
    }
    return result;
}

std::string scene_path(const std::string& name) {
    return std::string(LAMPYRIS_SOURCE_DIR) + "/scenes/" + name + ".pbrt";
}

std::vector<std::string> small_scenes() {
    std::vector<std::string> names;
    for (const char* folder : {"reference", "analytic"})
        for (const auto& entry :
             std::filesystem::directory_iterator(std::string(LAMPYRIS_SOURCE_DIR) + "/scenes/" + folder))
            if (entry.path().extension() == ".pbrt")
                names.push_back(std::string(folder) + "/" + entry.path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

const std::vector<std::string>& scenes_of_all_effects() {
    static const std::vector<std::string> names{
        "reference/coated-diffuse",  "reference/conductor-gold", "reference/diffuse-transmission",
        "reference/distant",         "reference/infinite-image", "reference/instances",
        "reference/point-spot",      "reference/sds-lamp",       "reference/textures",
        "reference/thin-dielectric", "reference/thin-lens"};
    return names;
}

static std::vector<std::string> small_scenes_that(bool vary) {
    const std::vector<std::string>& few = scenes_of_all_effects();
    std::vector<std::string> names = small_scenes();
    std::erase_if(names, [&](const std::string& name) {
        return vary != (!name.starts_with("reference/") || std::find(few.begin(), few.end(), name) != few.end());
    });
    return names;
}

std::vector<std::string> varied_scenes() { return small_scenes_that(true); }
std::vector<std::string> further_scenes() { return small_scenes_that(false); }

uint64_t effects_of(const std::string& scene) {
    return load_scene(SceneSource::of_file(scene_path(scene)), {}, false).scene.effects.mask();
}

std::string test_name(std::string text) {
    for (char& c : text)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return text;
}

Agreement expect_agreement(const std::string& scene, const std::string& other, const RenderSettings& settings,
                           double tolerance, double least) {
    RenderSettings s = settings;
    if (s.integrator.empty()) s.integrator = "path";  // whatever the scene needs
    s.backend = "cpu";
    s.device_settings.clear();
    const Rendered cpu = render_file(scene_path(scene), s);
    s.backend = other;
    s.device_settings = settings.device_settings;
    s.device_settings.merge(exact_options(other).settings);
    const Rendered theirs = render_file(scene_path(scene), s);
    const Agreement result = agreement(cpu, theirs, tolerance);
    std::string where;
    for (const auto& [x, y] : result.diverging) where += fmt::format(" ({}, {})", x, y);
    fmt::print("{:32} {:9} {:5} spp: {:8.4f} % to the bit, {:8.4f} % to {:.0e}, largest {:.1e}{}{}\n", scene, other,
               s.samples, 100.0 * double(result.identical) / double(result.pixels), 100.0 * result.share(), tolerance,
               result.largest, where.empty() ? "" : ", not:", where);
    EXPECT_GE(result.share(), least) << scene << ": cpu and " << other << " differ at" << where << "; lampyris render "
                                     << scene << ".pbrt --seed " << s.seed
                                     << " --replay X,Y,0 --backend ... shows one sample";
    if (testing::Test::HasFailure()) {
        save_failure(test_name(fmt::format("backends_{}_{}_cpu", scene, other)), cpu.image);
        save_failure(test_name(fmt::format("backends_{}_{}", scene, other)), theirs.image);
    }
    return result;
}

void expect_exact_agreement(const std::string& scene) {
    RenderSettings settings;
    settings.samples = 1;
    settings.seed = 25;
    settings.device_settings["exact"] = "on";
    settings.device_settings["staging"] = "on";  // as on a GPU
    expect_agreement(scene, "vulkan", settings, 1e-5, 0.999);
}

}  // namespace lampyris::test
