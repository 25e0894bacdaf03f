// Which integrator renders a scene, and with which parameters: the scene's, and in their place the command line's.
#pragma once

#include "core/integrator.h"
#include "core/photon_map.h"
#include "core/scene/build.h"

#include <memory>
#include <string>

namespace lampyris {

struct ChosenIntegrator {
    std::string asked;                       // by the scene or the command line; empty: nobody named one
    std::string name;                        // of what renders
    std::unique_ptr<Integrator> integrator;  // nothing where the scene's is unknown (told)
    const ParameterFields* fields = nullptr;
    std::string photon_map = kDefaultPhotonMap;  // of integrators that use one
};

// `override`: a name (empty: the scene's integrator) and settings, which come last. Errors of the scene go to `diagnostics`, what
// is to be said of its integrator to the notes of `built`; throws InputError for what is wrong with the command line's.
ChosenIntegrator choose_integrator(BuiltScene& built, const PluginChoice& override, Diagnostics& diagnostics);

}  // namespace lampyris
