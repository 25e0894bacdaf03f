// Shapes, objects and their instances.
#pragma once

#include "core/scene/builder.h"

namespace lampyris {

// Fills geometries, sets and instances of the scene. Frees the descriptions' meshes as it goes.
void build_shapes(BuildContext& context);
// The bounding sphere of everything, from pbrt-v4's rule: the centre of the box, and the distance to its corner.
kernel::vec4 bounding_sphere(const Scene& scene);

}  // namespace lampyris
