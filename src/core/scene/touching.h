// Surfaces in the same place.
#pragma once

#include "core/scene/builder.h"

namespace lampyris {

// A ray that passes a surface goes on beyond it, and misses another one in the same place. Where a face of a body that lets light
// pass (a triangle or a plane patch of a dielectric or of a medium's boundary) lies on a face of another shape or of another body
// of its mesh, it is moved inwards by a little, with a note. Of other pairs where light passes through one of the two (masks, thin
// surfaces, disks, two bodies on the same side of a face, equal curved shapes), it warns (docs/numerics.md). `places` are those of
// the scene's geometries.
void separate_touching_surfaces(BuildContext& context, const std::vector<Location>& places);

}  // namespace lampyris
