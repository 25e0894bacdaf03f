// pbrt-v4's integrators, and the integrators that replace those without a namesake here. One table serves for reading scene
// files and for the reference page.
#pragma once

#include "core/scene/build.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lampyris {

struct PbrtParameter {
    std::string_view name;
    ParameterType type;
    std::string_view pbrt_default;  // as text; a value equal to it is accepted silently
    std::string_view ours;          // the parameter here that gets the value; empty: none does
    std::string_view otherwise;     // if none does: why
    bool refused = false;           // other values than the default are unsupported, rather than without effect
};

struct PbrtIntegrator {
    std::string_view name;
    std::string_view ours;        // the replacement, unless an integrator of pbrt's name is registered
    std::string_view difference;  // between the two, for a note to the user
    bool ignores_media;           // pbrt's integrator ignores them
    std::span<const PbrtParameter> parameters;
};

std::span<const PbrtIntegrator> pbrt_integrators();
const PbrtIntegrator* find_pbrt_integrator(std::string_view name);

// The registered integrator that renders scenes which request `asked`; `asked` itself if there is none.
std::string rendering_integrator(const std::string& asked);

// Renames the directive's parameters to those of the integrator that renders. Reports parameters of the wrong type, and refused
// ones. Returns the names of all parameters that pbrt-v4 knows.
std::vector<std::string> take_pbrt_parameters(Entity& integrator, Diagnostics& diagnostics);

// Remarks about the integrator that the scene names: its replacement, and the parameters that have no effect.
std::vector<std::string> integrator_notes(const Entity& integrator, const Scene& scene, const Sources& sources);

}  // namespace lampyris
