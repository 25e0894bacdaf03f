// LightSource directives, and the order and choice of all lights.
#pragma once

#include "core/scene/builder.h"

namespace lampyris {

void build_lights(BuildContext& context);
// Moves the pending lights into the scene, infinite ones first, with the CDF that kernels choose by (in proportion to power).
// Needs the scene's bounds: distant and infinite lights send as much as its cross-section catches.
void finish_lights(BuildContext& context);

}  // namespace lampyris
