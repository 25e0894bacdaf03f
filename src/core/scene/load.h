// A scene file, read and built: what every command that takes a SCENE does first.
#pragma once

#include "core/scene/build.h"

#include <string>
#include <vector>

namespace lampyris {

struct LoadedScene {
    Scene scene;
    SceneSettings settings;
    std::shared_ptr<Sources> sources;   // of locations that settings still hold (the integrator's parameters)
    std::vector<std::string> warnings;  // formatted, with location
    double parse_s = 0.0, build_s = 0.0;
};

// Throws InputError with all errors of the scene; with `skip_unsupported`, what is known but not simulated is a warning,
// and listed in Scene::unsupported.
LoadedScene load_scene(const std::string& path, const BuildOptions& options, bool skip_unsupported);

}  // namespace lampyris
