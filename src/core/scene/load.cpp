#include "core/scene/load.h"

#include <chrono>

namespace lampyris {

LoadedScene load_scene(const std::string& path, const BuildOptions& options, bool skip_unsupported) {
    using Clock = std::chrono::steady_clock;
    const auto seconds = [](Clock::time_point since) {
        return std::chrono::duration<double>(Clock::now() - since).count();
    };
    LoadedScene loaded;
    loaded.sources = std::make_shared<Sources>();
    Diagnostics diagnostics(*loaded.sources);
    diagnostics.set_skip_unsupported(skip_unsupported);
    const auto start = Clock::now();
    SceneDescription description = parse_scene_file(path, loaded.sources, diagnostics);
    loaded.parse_s = seconds(start);
    const auto parsed = Clock::now();
    // Building goes on after errors of the parser: all that is wrong with a scene is told at once.
    BuiltScene built = build_scene(std::move(description), options, diagnostics);
    diagnostics.throw_if_errors();
    loaded.scene = std::move(built.scene);
    loaded.scene.name = path;
    loaded.settings = std::move(built.settings);
    loaded.warnings = diagnostics.warnings();
    loaded.build_s = seconds(parsed);
    return loaded;
}

}  // namespace lampyris
