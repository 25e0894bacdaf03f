// Surfaces in the same place.
#pragma once

#include "core/scene/builder.h"

namespace lampyris {

// Warns of triangles and plane patches that lie in the plane of others, and over them, and of equal curved shapes, where light
// passes through one of the two: a ray meets one surface and goes on beyond the other (docs/numerics.md). Those of an object, or
// of the world, are compared among themselves. `places` are those of the scene's geometries.
void warn_of_touching_surfaces(BuildContext& context, const std::vector<Location>& places);

}  // namespace lampyris
