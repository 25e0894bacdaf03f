#include "core/scene/load.h"

#include <chrono>

namespace lampyris {

LoadedScene read_scene(SceneSource source, const BuildOptions& options, std::shared_ptr<Sources> sources,
                       Diagnostics& diagnostics) {
    using Clock = std::chrono::steady_clock;
    const auto seconds = [](Clock::time_point since) {
        return std::chrono::duration<double>(Clock::now() - since).count();
    };
    LoadedScene loaded;
    loaded.sources = std::move(sources);
    const auto start = Clock::now();
    SceneDescription description =
        source.text
            ? parse_scene_text(source.name, *std::move(source.text),
                               SceneFolder(source.directory, source.allowed_folders), loaded.sources, diagnostics)
            : parse_scene_file(source.name, loaded.sources, diagnostics, source.allowed_folders);
    loaded.parse_s = seconds(start);
    const auto parsed = Clock::now();
    // Building continues after parser errors, so that all errors of a scene are reported at once.
    static_cast<BuiltScene&>(loaded) = build_scene(std::move(description), options, diagnostics);
    loaded.scene.name = std::move(source.name);
    loaded.build_s = seconds(parsed);
    return loaded;
}

LoadedScene load_scene(SceneSource source, const BuildOptions& options, bool skip_unsupported) {
    auto sources = std::make_shared<Sources>();
    Diagnostics diagnostics(*sources);
    diagnostics.set_skip_unsupported(skip_unsupported);
    LoadedScene loaded = read_scene(std::move(source), options, std::move(sources), diagnostics);
    diagnostics.throw_if_errors();
    loaded.warnings = diagnostics.warnings();
    return loaded;
}

}  // namespace lampyris
