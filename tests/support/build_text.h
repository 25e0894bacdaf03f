// A scene from a text, for tests of the builder.
#pragma once

#include "core/scene/build.h"

#include <memory>
#include <string>
#include <vector>

namespace lampyris {

// Texts of tests may name pictures of the tree, and those that tests make in the build's folder.
inline const std::vector<std::string> kTestFolders = {LAMPYRIS_SOURCE_DIR, LAMPYRIS_BINARY_DIR};

struct BuiltText {
    BuiltScene built;
    std::vector<std::string> errors, warnings, unsupported;
    std::string all_errors() const {
        std::string all;
        for (const std::string& error : errors) all += error + "\n";
        return all;
    }
    const Scene& scene() const { return built.scene; }
};

inline BuiltText build_text(const std::string& text, bool skip_unsupported = false, const BuildOptions& options = {},
                            const std::string& directory = ".") {
    auto sources = std::make_shared<Sources>();
    Diagnostics diagnostics(*sources);
    diagnostics.set_skip_unsupported(skip_unsupported);
    SceneDescription description =
        parse_scene_text("test.pbrt", text, SceneFolder(directory, kTestFolders), sources, diagnostics);
    BuiltText result;
    result.built = build_scene(std::move(description), options, diagnostics);
    result.errors = diagnostics.errors();
    result.warnings = diagnostics.warnings();
    result.unsupported = diagnostics.unsupported_list();
    return result;
}

// The world part of a scene with a camera and a small film in front.
inline BuiltText build_world(const std::string& world, bool skip_unsupported = false) {
    return build_text(
        "Camera \"perspective\"\nFilm \"rgb\" \"integer xresolution\" 4 \"integer yresolution\" 4\nWorldBegin\n" +
            world,
        skip_unsupported);
}

}  // namespace lampyris
