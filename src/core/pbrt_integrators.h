// pbrt-v4's integrators, and what renders in the place of those that have no namesake here: one table, which scene files are
// read by and the reference page is made of.
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
    std::string_view pbrt_default;  // as text; a value equal to it goes without a word
    std::string_view ours;          // the parameter that takes the value over; empty: none does
    std::string_view otherwise;     // where none does: why
    bool refused = false;           // another value than the default is unsupported, rather than of no effect
};

struct PbrtIntegrator {
    std::string_view name;
    std::string_view ours;        // what renders unless an integrator of that name is registered
    std::string_view difference;  // between the two, for a note
    bool ignores_media;           // pbrt's does
    std::span<const PbrtParameter> parameters;
};

std::span<const PbrtIntegrator> pbrt_integrators();
const PbrtIntegrator* find_pbrt_integrator(std::string_view name);

// The registered integrator that renders what a scene asks for by that name; the name itself where nothing does.
std::string rendering_integrator(const std::string& asked);

// Gives the directive's parameters the names that the integrator which renders has for them, and reports those of the wrong
// type and those that are refused. Returns the names of all that pbrt-v4 knows.
std::vector<std::string> take_pbrt_parameters(Entity& integrator, Diagnostics& diagnostics);

// What is to be said about the integrator that the scene names: what renders in its place, what of it has no effect.
std::vector<std::string> integrator_notes(const Entity& integrator, const Scene& scene, const Sources& sources);

}  // namespace lampyris
