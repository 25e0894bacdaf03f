#include "core/render/integrator_choice.h"

#include "core/render/pbrt_integrators.h"

#include <fmt/format.h>

namespace lampyris {
namespace {

// By its name on the command line.
const IntegratorFactory& require_integrator(const std::string& name) {
    if (!integrators().find(name) && find_pbrt_integrator(name))
        throw InputError(
            fmt::format("error: unknown integrator \"{}\"; scenes that name pbrt-v4's are rendered with \"{}\"", name,
                        rendering_integrator(name)));
    if (!integrators().find(name)) {
        const auto [message, hint] = integrators().unknown(name);
        throw InputError(fmt::format("error: {}{}{}; --plugin FILE.so loads others", message,
                                     hint.starts_with(' ') ? "" : "; ", hint));
    }
    return integrators().require(name);
}

}  // namespace

ChosenIntegrator choose_integrator(BuiltScene& built, const PluginChoice& override, Diagnostics& diagnostics) {
    ChosenIntegrator chosen;
    Entity& of_scene = built.settings.integrator;
    const bool from_scene = override.name.empty();
    chosen.asked = from_scene ? (of_scene.given() ? of_scene.type : std::string()) : override.name;
    chosen.name = from_scene ? rendering_integrator(of_scene.type) : override.name;
    if (from_scene && !integrators().find(chosen.name)) {
        const auto [message, hint] = integrators().unknown(chosen.name);
        diagnostics.error(
            of_scene.type_location, message,
            hint + "; --plugin FILE.so loads others, --integrator NAME renders the scene with another one");
        return chosen;
    }
    const IntegratorFactory& factory = require_integrator(chosen.name);
    chosen.integrator = factory.create();
    chosen.fields = &factory.fields;
    void* parameters = chosen.integrator->parameters();
    set_defaults(parameters, factory.fields);
    const ParameterList& list = of_scene.parameters;
    // If the command line chose the integrator, only the parameters it knows are read from the scene's directive; the others
    // were meant for another integrator.
    if (from_scene) {
        const std::vector<std::string> notes = integrator_notes(of_scene, built.scene, diagnostics.sources());
        built.scene.notes.insert(built.scene.notes.end(), notes.begin(), notes.end());
        std::vector<std::string> known = take_pbrt_parameters(of_scene, diagnostics);
        const std::vector<std::string> own = spec_names(specs_of(factory.fields));
        known.insert(known.begin(), own.begin(), own.end());
        read_parameters(parameters, factory.fields, list, diagnostics);
        if (chosen.integrator->uses_photon_map()) {
            chosen.photon_map = list.get_string("photon_map", chosen.photon_map, diagnostics);
            known.emplace_back("photon_map");
        }
        known.emplace_back("media");  // read when the scene is built
        list.report_unused(fmt::format("integrator \"{}\"", of_scene.type), known, diagnostics);
    } else {
        read_parameters(parameters, factory.fields, list, diagnostics);
    }
    for (const auto& [key, value] : override.settings)
        set_parameter(parameters, factory.fields, key, value, fmt::format("integrator \"{}\"", chosen.name));
    return chosen;
}

}  // namespace lampyris
