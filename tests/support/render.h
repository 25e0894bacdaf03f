// Rendering for tests: from a scene text or file and a backend to the film.
#pragma once

#include "core/photons/photon_map.h"
#include "core/render/render.h"
#include "support/backends.h"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lampyris::test {

struct RenderSettings {
    std::string backend = "cpu";
    uint32_t samples = 16;
    uint32_t eye_samples = 1;  // of integrators that fix them
    uint32_t seed = 1;
    unsigned threads = 0;
    std::optional<std::array<int, 2>> resolution;
    std::optional<std::string> sampler;  // in place of the scene's: "independent", "sobol"
    std::string integrator;              // "name:key=value"; empty: the scene's
    std::string photon_map;              // empty: the scene's
    bool share_device = false;           // as for all scenes that have this
    std::map<std::string, std::string> device_settings;
    std::optional<std::array<int, 4>> crop;
    uint32_t first_pass = 0;
    std::function<std::shared_ptr<Device>(std::shared_ptr<Device>)> wrap;  // replaces the device
    uint32_t slice = 0;  // passes per dispatch; 0: chosen by the session
    std::function<void(const RenderProgress&, const Film&)> on_progress;  // RenderObserver's
};

struct Rendered {
    Image image;  // Film::image()
    FilmSummary summary;
    std::vector<kernel::FilmPixel> pixels;
    int width = 0, height = 0;
    int scene_samples = 0;  // samples per pixel that the scene file asks for
    float value(int x, int y, int channel) const { return image.at(x, y, channel); }
    double luminance(int x, int y) const;
    double luminance_variance(int x, int y) const;  // of the pixel's mean; channels taken as fully correlated
    double mean_luminance() const;
};

// Throws InputError with the scene's errors.
Rendered render_text(const std::string& scene_text, const RenderSettings& settings, const std::string& directory = ".");
// With `count` consecutive seeds, beginning with the settings', one image each; the scene is built once.
std::vector<Rendered> render_text_seeds(const std::string& scene_text, const RenderSettings& settings, uint32_t seeds);
Rendered render_file(const std::string& path, const RenderSettings& settings);

// The folder where a failing test saves its images; it exists.
std::string failure_directory();
void save_failure(const std::string& name, const Image& image);

}  // namespace lampyris::test
