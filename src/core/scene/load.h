// A scene, read and built: what every command that takes a SCENE does first, and every program that renders one.
#pragma once

#include "core/scene/build.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lampyris {

// Where a scene comes from.
struct SceneSource {
    std::string name;                 // the file's path, or the name of the text in messages
    std::optional<std::string> text;  // a scene in memory
    std::string directory = ".";      // for a text: the folder of the files that it names
    // A scene reads files in its folder and below it; and in these.
    std::vector<std::string> allowed_folders;

    static SceneSource of_file(std::string path) { return {std::move(path), {}, {}, {}}; }
    static SceneSource of_text(std::string text, std::string name = "scene", std::string directory = ".") {
        return {std::move(name), std::move(text), std::move(directory), {}};
    }
};

struct LoadedScene : BuiltScene {
    std::shared_ptr<Sources> sources;   // the texts of locations in the settings (the integrator's parameters)
    std::vector<std::string> warnings;  // formatted, with location
    double parse_s = 0.0, build_s = 0.0;
};

// For a caller that has more checks to make before errors are thrown. Errors and warnings are left in the diagnostics, which
// look locations up in `sources`.
LoadedScene read_scene(SceneSource source, const BuildOptions& options, std::shared_ptr<Sources> sources,
                       Diagnostics& diagnostics);

// Throws an InputError with all errors of the scene. With `skip_unsupported`, features that are known but not simulated cause
// warnings, and are listed in Scene::unsupported.
LoadedScene load_scene(SceneSource source, const BuildOptions& options, bool skip_unsupported);

}  // namespace lampyris
