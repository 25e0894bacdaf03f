#include "support/render.h"

#include "core/image/image_io.h"

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

Rendered render_description(SceneDescription description, const RenderSettings& settings, Diagnostics& diagnostics) {
    BuildOptions options;
    options.resolution = settings.resolution;
    options.crop = settings.crop;
    BuiltScene built = build_scene(std::move(description), options, diagnostics);
    diagnostics.throw_if_errors();
    if (settings.one_variant && settings.backend == "vulkan") {
        built.scene.effects.ask(kernel::kAllEffects, "the test");
        built.scene.record.counts.w = built.scene.effects.mask();
    }
    PluginChoice choice;
    if (!settings.integrator.empty()) choice = parse_plugin_choice(settings.integrator);
    const std::string name = choice.name.empty() ? built.settings.integrator.type : choice.name;
    const IntegratorFactory& factory = integrators().require(name);
    const std::unique_ptr<Integrator> integrator = factory.create();
    set_defaults(integrator->parameters(), factory.fields);
    read_parameters(integrator->parameters(), factory.fields, built.settings.integrator.parameters, diagnostics);
    for (const auto& [key, value] : choice.settings)
        set_parameter(integrator->parameters(), factory.fields, key, value, name);
    diagnostics.throw_if_errors();

    DeviceOptions device_options;
    device_options.threads = settings.threads;
    device_options.settings = settings.device_settings;
    const std::shared_ptr<Device> device =
        settings.one_variant ? shared_device(settings.backend) : create_device(settings.backend, device_options);
    const DeviceSceneHandle device_scene = device->upload(built.scene);
    Film film(*device, built.scene, built.settings.crop);
    RenderSession session(*device, built.scene, device_scene, film, {settings.samples, {}, {}});
    session.seed = settings.seed;
    session.sampler = settings.sampler.value_or(built.settings.sampler) == "independent" ? kernel::SAMPLER_INDEPENDENT
                                                                                         : kernel::SAMPLER_SOBOL;
    session.max_slice = settings.slice;
    session.on_progress = settings.on_progress;
    session.photon_map = settings.photon_map;
    session.start_at(settings.first_pass);
    integrator->render(session);
    film.download();
    Rendered result;
    result.image = film.image();
    result.summary = film.summary();
    result.pixels = film.pixels();
    result.scene_samples = built.settings.samples_per_pixel;
    result.width = result.image.width;
    result.height = result.image.height;
    return result;
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

Rendered render_text(const std::string& scene_text, const RenderSettings& settings, const std::string& directory) {
    auto sources = std::make_shared<Sources>();
    Diagnostics diagnostics(*sources);
    return render_description(parse_scene_text("test.pbrt", scene_text, directory, sources, diagnostics), settings,
                              diagnostics);
}

Rendered render_file(const std::string& path, const RenderSettings& settings) {
    auto sources = std::make_shared<Sources>();
    Diagnostics diagnostics(*sources);
    return render_description(parse_scene_file(path, sources, diagnostics), settings, diagnostics);
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
