// Which integrator renders a scene, and with which parameters: those of the scene, overridden by those of the command line.
#pragma once

#include "core/photons/photon_map.h"
#include "core/render/integrator.h"
#include "core/scene/build.h"

#include <memory>
#include <string>

namespace lampyris {

struct ChosenIntegrator {
    std::string asked;                       // the name in the scene or on the command line; empty: none was given
    std::string name;                        // of the integrator that renders
    std::unique_ptr<Integrator> integrator;  // empty if the scene's is unknown (reported)
    const ParameterFields* fields = nullptr;
    std::string photon_map = kDefaultPhotonMap;  // for integrators that use one
};

// `override`: a name (empty: the scene's integrator) and settings, which override the scene's. Errors in the scene are reported
// to `diagnostics`; remarks about its integrator are added to the notes of `built`. Throws InputError for errors on the command
// line.
ChosenIntegrator choose_integrator(BuiltScene& built, const PluginChoice& override, Diagnostics& diagnostics);

}  // namespace lampyris
