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
    std::string name;                 // the file's path; or what messages call the text
    std::optional<std::string> text;  // a scene in memory
    std::string directory = ".";      // of a text: where the files that it names are looked for

    static SceneSource of_file(std::string path) { return {std::move(path), {}, {}}; }
    static SceneSource of_text(std::string text, std::string name = "scene", std::string directory = ".") {
        return {std::move(name), std::move(text), std::move(directory)};
    }
};

struct LoadedScene : BuiltScene {
    std::shared_ptr<Sources> sources;   // of locations that settings still hold (the integrator's parameters)
    std::vector<std::string> warnings;  // formatted, with location
    double parse_s = 0.0, build_s = 0.0;
};

// For a caller that has more to check before errors are thrown: they are in the diagnostics, which look places up in `sources`,
// and so are the warnings.
LoadedScene read_scene(SceneSource source, const BuildOptions& options, std::shared_ptr<Sources> sources,
                       Diagnostics& diagnostics);

// Throws InputError with all errors of the scene; with `skip_unsupported`, what is known but not simulated is a warning,
// and listed in Scene::unsupported.
LoadedScene load_scene(SceneSource source, const BuildOptions& options, bool skip_unsupported);

}  // namespace lampyris
