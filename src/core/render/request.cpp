#include "core/render/request.h"

#include "core/image/image_io.h"
#include "core/scene/limits.h"

#include <fmt/format.h>

#include <algorithm>

namespace lampyris {

void check(const RenderRequest& request) {
    if (request.build.resolution) {
        const auto [width, height] = *request.build.resolution;
        if (std::min(width, height) < 1 || std::max(width, height) > kLargestSide)
            throw InputError(
                fmt::format("error: --resolution {}x{}: sides are 1 to {} pixels", width, height, kLargestSide));
    }
    const BudgetLimits& limits = request.limits;
    if (limits.passes == 0u || request.samples_per_pixel == 0u)
        throw InputError("error: a limit of passes or samples must be at least 1");
    if (limits.seconds && !(*limits.seconds > 0.0)) throw InputError("error: a time limit must be above 0 seconds");
    if (limits.target_error && !(*limits.target_error > 0.0)) throw InputError("error: --target-error must be above 0");
    if (request.resume && request.checkpoint.empty())
        throw InputError("error: --resume goes on from a checkpoint: name it with --checkpoint FILE");
    if (!request.checkpoint.empty() && request.replay)
        throw InputError("error: --replay renders one sample of one pixel, and has no checkpoint");
    if (!(request.checkpoint_every_s > 0.0)) throw InputError("error: --every must be above 0 seconds");
}

PluginChoice requested_integrator(const RenderRequest& request, BuildOptions& build) {
    PluginChoice choice;
    if (!request.integrator.empty()) choice = parse_plugin_choice(request.integrator);
    choice.settings.insert(choice.settings.end(), request.integrator_settings.begin(),
                           request.integrator_settings.end());
    for (const auto& [key, value] : choice.settings) {
        if (key != "media") continue;
        if (value != "on" && value != "off")
            throw InputError(fmt::format("error: integrator.media={}: expected on or off", shown(value)));
        build.media = value == "on";
    }
    std::erase_if(choice.settings, [](const auto& setting) { return setting.first == "media"; });
    return choice;
}

ChosenIntegrator choose(const RenderRequest& request, const PluginChoice& choice, BuiltScene& built,
                        Diagnostics& diagnostics) {
    ChosenIntegrator chosen = choose_integrator(built, choice, diagnostics);
    if (!chosen.integrator) return chosen;
    if (!request.photon_map.empty()) {
        if (!chosen.integrator->uses_photon_map())
            throw InputError(
                fmt::format("error: --photon-map: integrator \"{}\" does not use a photon map", chosen.name));
        chosen.photon_map = request.photon_map;
    }
    if (chosen.integrator->uses_photon_map()) create_photon_map(chosen.photon_map);  // reports errors early
    return chosen;
}

BudgetLimits choose_limits(const RenderRequest& request, const ChosenIntegrator& chosen, const SceneSettings& settings,
                           const std::string& unseen_error) {
    if (request.replay) return {1, {}, {}};
    BudgetLimits limits = request.limits;
    if (request.samples_per_pixel && !chosen.integrator->fixes_eye_samples())
        limits.passes =
            std::min<uint64_t>(limits.passes.value_or(*request.samples_per_pixel), *request.samples_per_pixel);
    if (limits.passes || limits.seconds) return limits;
    if (!limits.target_error) {
        limits.passes = uint64_t(settings.samples_per_pixel);
    } else if (!unseen_error.empty() && !limits.accept_unstable) {
        throw InputError(fmt::format(
            "error: --target-error alone would never stop: with integrator \"{}\" the estimated error stays "
            "unstable, because {}; give another limit, too (--passes or --time), or take the estimate as it "
            "is (--accept-unstable)",
            chosen.name, unseen_error));
    }
    return limits;
}

void apply_replay(const std::array<int, 3>& replay, BuiltScene& built) {
    const auto [x, y, pass] = replay;
    if (x < 0 || y < 0 || pass < 0 || x >= int(built.scene.width()) || y >= int(built.scene.height()))
        throw InputError(fmt::format("error: --replay {},{},{}: the picture has {}x{} pixels", x, y, pass,
                                     built.scene.width(), built.scene.height()));
    built.settings.crop = {x, y, x + 1, y + 1};
}

uint32_t sampler_number(const std::string& name) {
    if (name == "independent") return kernel::SAMPLER_INDEPENDENT;
    if (name == "sobol") return kernel::SAMPLER_SOBOL;
    throw InputError(
        fmt::format("error: unknown sampler \"{}\"; there are \"independent\" and \"sobol\"", shown(name)));
}

std::vector<float> read_reference(const std::string& file, const BuiltScene& built) {
    const std::array<int, 4>& crop = built.settings.crop;
    Image image = read_image(file, {true, true});
    const int width = crop[2] - crop[0], height = crop[3] - crop[1];
    if (image.width == int(built.scene.width()) && image.height == int(built.scene.height()))
        image = image.crop({crop[0], crop[1], crop[2], crop[3]});
    if (image.width != width || image.height != height)
        throw InputError(fmt::format("error: {}: the reference has {} pixels, the picture {}x{}", file,
                                     image.size_text(), width, height));
    return std::move(image.pixels);
}

}  // namespace lampyris
