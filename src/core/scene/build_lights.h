// LightSource directives, and the order and choice of all lights.
#pragma once

#include "core/scene/builder.h"

namespace lampyris {

void build_lights(BuildContext& context);
// Moves the pending lights into the scene, infinite ones first, and builds the CDF by which kernels choose a light in
// proportion to its power. Needs the scene's bounds: the power of distant and infinite lights is proportional to the scene's
// cross-section.
void finish_lights(BuildContext& context);

}  // namespace lampyris
