#include "support/render.h"

#include "core/image/image_io.h"
#include "core/integrator_choice.h"

#include <cmath>
#include <filesystem>
#include <map>

namespace lampyris::test {
namespace {

std::shared_ptr<Device> shared_device(const std::string& backend) {
    static std::map<std::string, std::shared_ptr<Device>> devices;
    std::shared_ptr<Device>& device = devices[backend];
    if (!device) device = create_device(backend, {});
    return device;
}

// With seeds from the settings' on, one after the other: the scene is built once.
std::vector<Rendered> render_description(SceneDescription description, const RenderSettings& settings,
                                         Diagnostics& diagnostics, uint32_t seeds = 1) {
    BuildOptions options;
    options.resolution = settings.resolution;
    options.crop = settings.crop;
    BuiltScene built = build_scene(std::move(description), options, diagnostics);
    if (settings.one_variant && settings.backend == "vulkan") {
        built.scene.effects.ask(kernel::kAllEffects, "the test");
        built.scene.record_effects(built.scene.effects.mask());
    }
    PluginChoice choice;
    if (!settings.integrator.empty()) choice = parse_plugin_choice(settings.integrator);
    const ChosenIntegrator chosen = choose_integrator(built, choice, diagnostics);
    diagnostics.throw_if_errors();

    DeviceOptions device_options;
    device_options.threads = settings.threads;
    device_options.settings = settings.device_settings;
    std::shared_ptr<Device> device =
        settings.one_variant ? shared_device(settings.backend) : create_device(settings.backend, device_options);
    if (settings.wrap) device = settings.wrap(std::move(device));
    const DeviceSceneHandle device_scene = device->upload(built.scene);
    std::vector<Rendered> results;
    for (uint32_t i = 0; i < seeds; ++i) {
        Film film(*device, built.scene, built.settings.crop);
        RenderSession session(*device, built.scene, device_scene, film, {settings.samples, {}, {}});
        session.seed = settings.seed + i;
        session.eye_samples = settings.eye_samples;
        session.sampler = settings.sampler.value_or(built.settings.sampler) == "independent"
                              ? kernel::SAMPLER_INDEPENDENT
                              : kernel::SAMPLER_SOBOL;
        session.max_slice = settings.slice;
        session.on_progress = settings.on_progress;
        session.photon_map = settings.photon_map;
        session.start_at(settings.first_pass);
        chosen.integrator->render(session);
        film.download();
        Rendered& result = results.emplace_back();
        result.image = film.image();
        result.summary = film.summary();
        result.pixels = film.pixels();
        result.scene_samples = built.settings.samples_per_pixel;
        result.width = result.image.width;
        result.height = result.image.height;
    }
    return results;
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
    auto sources = std::make_shared<Sources>();
    Diagnostics diagnostics(*sources);
    return render_description(parse_scene_text("test.pbrt", scene_text, ".", sources, diagnostics), settings,
                              diagnostics, seeds);
}

Rendered render_text(const std::string& scene_text, const RenderSettings& settings, const std::string& directory) {
    auto sources = std::make_shared<Sources>();
    Diagnostics diagnostics(*sources);
    return std::move(render_description(parse_scene_text("test.pbrt", scene_text, directory, sources, diagnostics),
                                        settings, diagnostics)[0]);
}

Rendered render_file(const std::string& path, const RenderSettings& settings) {
    auto sources = std::make_shared<Sources>();
    Diagnostics diagnostics(*sources);
    return std::move(render_description(parse_scene_file(path, sources, diagnostics), settings, diagnostics)[0]);
}

std::vector<std::string> usable_backends() {
    std::vector<std::string> names;
    for (const std::string& name : backend_names()) {
        for (const DeviceInfo& device : list_devices()) {
            if (device.backend != name) continue;
            names.push_back(name);
            break;
        }
    }
    return names;
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
