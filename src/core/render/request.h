// What a RenderRequest asks for, together with what its scene says. Used by render.cpp.
#pragma once

#include "core/render/integrator_choice.h"
#include "core/render/render.h"
#include "core/render/render_session.h"

#include <array>
#include <string>
#include <vector>

namespace lampyris {

// Throws InputError if members of the request make no sense, or exclude each other.
void check(const RenderRequest& request);

// The request's settings of the integrator. `media` is removed: every integrator accepts it, and the scene's builder uses it.
PluginChoice requested_integrator(const RenderRequest& request, BuildOptions& build);

// The integrator and its photon map; without an integrator if `diagnostics` has errors.
ChosenIntegrator choose(const RenderRequest& request, const PluginChoice& choice, BuiltScene& built,
                        Diagnostics& diagnostics);

// The limits of the rendering: those of the request, or the scene's number of samples.
BudgetLimits choose_limits(const RenderRequest& request, const ChosenIntegrator& chosen, const SceneSettings& settings,
                           const std::string& unseen_error);

// Renders nothing but the pixel.
void apply_replay(const std::array<int, 3>& replay, BuiltScene& built);

// One of kernel::SAMPLER_...
uint32_t sampler_number(const std::string& name);

// R, G, B of the rendered pixels.
std::vector<float> read_reference(const std::string& file, const BuiltScene& built);

}  // namespace lampyris
