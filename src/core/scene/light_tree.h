// The tree of bounds by which kernels choose one of many lights (core/kernel/light_tree.h).
#pragma once

#include "core/scene/scene.h"

#include <span>

namespace lampyris {

// Scenes of fewer lights that have a place choose by power alone, which costs nothing (docs/decisions/light-tree.md).
inline constexpr uint32_t kFewestLightsOfTree = 8;

// Fills scene.light_nodes, the numbers of leaves in scene.lights, and what the scene's record says of the tree; false if the scene
// has too few lights for one, or they are close together for their size. `powers` as in choose_lights, which comes first. Lights of
// no power are not in the tree.
bool build_light_tree(Scene& scene, std::span<const double> powers);

}  // namespace lampyris
