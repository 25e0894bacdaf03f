// SceneDescription -> Scene + Effects: turns the directives into flat arrays that any device can use.
#pragma once

#include "core/base/error.h"
#include "core/scene/description.h"
#include "core/scene/scene.h"

#include <array>
#include <optional>
#include <string>

namespace lampyris {

struct BuildOptions {
    std::optional<std::array<int, 2>> resolution;  // replaces the Film's
    // Pixels to render, x0 y0 x1 y1, half-open, in the full picture; replaces the Film's crop window.
    std::optional<std::array<int, 4>> crop;
    std::optional<bool> media;  // whether media are simulated; replaces the Integrator's "media"
};

// What the scene file says about the run rather than about the world.
struct SceneSettings {
    bool media = true;  // false: ignored, as by pbrt-v4's "path"
    Entity integrator;  // "path" where the file names none; its parameters are read by the integrator
    // How pbrt's sampler was mapped: SAMPLER_* kind by name.
    std::string sampler = "independent";  // "independent" or "sobol" (Owen-scrambled)
    int samples_per_pixel = 16;
    uint32_t seed = 0;
    std::string output;     // the Film's "filename"; may be empty
    bool save_half = true;  // EXR: half floats ("savefp16")
    // The rectangle of pixels to render, half-open.
    std::array<int, 4> crop{0, 0, 0, 0};
};

struct BuiltScene {
    Scene scene;
    SceneSettings settings;
};

// Consumes the description: meshes are moved, not copied. Errors are collected in `diagnostics`; check has_errors() before
// using the result. The diagnostics' settings decide whether an unsupported feature is an error.
BuiltScene build_scene(SceneDescription&& description, const BuildOptions& options, Diagnostics& diagnostics);

}  // namespace lampyris
