#include "support/render.h"

#include "core/image/image_io.h"
#include "support/build_text.h"

#include <cmath>
#include <filesystem>
#include <map>
#include <utility>

namespace lampyris::test {
namespace {

std::shared_ptr<Device> shared_device(const std::string& backend) {
    static std::map<std::string, std::shared_ptr<Device>> devices;
    std::shared_ptr<Device>& device = devices[backend];
    if (!device) device = create_device(backend, {});
    return device;
}

class ProgressListener final : public RenderObserver {
 public:
    explicit ProgressListener(const RenderSettings& settings) : settings_(settings) {}
    void progress(const RenderProgress& progress, const Film& film) override {
        if (settings_.on_progress) settings_.on_progress(progress, film);
    }

 private:
    const RenderSettings& settings_;
};

RenderRequest request_of(SceneSource scene, const RenderSettings& settings) {
    RenderRequest request;
    request.scene = std::move(scene);
    request.build.resolution = settings.resolution;
    request.build.crop = settings.crop;
    request.integrator = settings.integrator;
    request.photon_map = settings.photon_map;
    request.sampler = settings.sampler;
    request.limits.passes = settings.samples;
    // For other integrators it would limit the passes.
    if (settings.eye_samples != 1) request.samples_per_pixel = settings.eye_samples;
    request.first_pass = settings.first_pass;
    request.max_slice = settings.slice;
    DeviceOptions options;
    options.threads = settings.threads;
    options.settings = settings.device_settings;
    request.device = settings.share_device ? shared_device(settings.backend) : create_device(settings.backend, options);
    if (settings.wrap) request.device = settings.wrap(std::move(request.device));
    return request;
}

// With consecutive seeds, beginning with the settings': the scene is built once.
std::vector<Rendered> render_seeds(SceneSource scene, const RenderSettings& settings, uint32_t seeds = 1) {
    ProgressListener listener(settings);
    Rendering rendering(request_of(std::move(scene), settings), listener);
    std::vector<Rendered> results;
    for (uint32_t i = 0; i < seeds; ++i) {
        RenderOutcome outcome = rendering.run(settings.seed + i);
        Rendered& result = results.emplace_back();
        result.summary = outcome.record.film;
        result.pixels = std::move(outcome.pixels);
        result.scene_samples = rendering.settings().samples_per_pixel;
        result.width = outcome.image.width;
        result.height = outcome.image.height;
        result.image = std::move(outcome.image);
    }
    return results;
}

SceneSource test_text(const std::string& text, const std::string& directory = ".") {
    SceneSource source = SceneSource::of_text(text, "test.pbrt", directory);
    source.allowed_folders = kTestFolders;
    return source;
}

}  // namespace

double Rendered::luminance(int x, int y) const {
    return 0.2126 * value(x, y, 0) + 0.7152 * value(x, y, 1) + 0.0722 * value(x, y, 2);
}

double Rendered::luminance_variance(int x, int y) const {
    const int first = image.find_channel("variance.R");
    const double deviation = 0.2126 * std::sqrt(double(value(x, y, first))) +
                             0.7152 * std::sqrt(double(value(x, y, first + 1))) +
                             0.0722 * std::sqrt(double(value(x, y, first + 2)));
    return deviation * deviation;
}

double Rendered::mean_luminance() const {
    double sum = 0.0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) sum += luminance(x, y);
    return sum / (double(width) * height);
}

std::vector<Rendered> render_text_seeds(const std::string& scene_text, const RenderSettings& settings, uint32_t seeds) {
    return render_seeds(test_text(scene_text), settings, seeds);
}

Rendered render_text(const std::string& scene_text, const RenderSettings& settings, const std::string& directory) {
    return std::move(render_seeds(test_text(scene_text, directory), settings)[0]);
}

Rendered render_file(const std::string& path, const RenderSettings& settings) {
    return std::move(render_seeds(SceneSource::of_file(path), settings)[0]);
}

std::string failure_directory() {
    const std::string directory = std::string(LAMPYRIS_BINARY_DIR) + "/failures";
    std::filesystem::create_directories(directory);
    return directory;
}

void save_failure(const std::string& name, const Image& image) {
    write_image(failure_directory() + "/" + name + ".exr", image);
}

}  // namespace lampyris::test
