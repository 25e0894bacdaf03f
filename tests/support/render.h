// Rendering for tests: a scene text or file, a backend, and the film that comes out.
#pragma once

#include "core/photon_map.h"
#include "core/render/render.h"

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
    bool share_device = false;           // with all scenes that say so
    std::map<std::string, std::string> device_settings;
    std::optional<std::array<int, 4>> crop;
    uint32_t first_pass = 0;
    std::function<std::shared_ptr<Device>(std::shared_ptr<Device>)> wrap;  // what to render on in place of the device
    uint32_t slice = 0;  // passes per dispatch; 0: as the session decides
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
// With so many seeds from the settings' on, each an image of its own; the scene is built once.
std::vector<Rendered> render_text_seeds(const std::string& scene_text, const RenderSettings& settings, uint32_t seeds);
Rendered render_file(const std::string& path, const RenderSettings& settings);

// Backends to test on: all that have a device on this machine.
std::vector<std::string> usable_backends();

// Where a failing test leaves its images; the folder exists.
std::string failure_directory();
void save_failure(const std::string& name, const Image& image);

}  // namespace lampyris::test
