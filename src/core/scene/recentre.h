// Scenes that lie far from the world's origin are moved to it before coordinates become floats.
#pragma once

#include "core/scene/description.h"

#include <glm/vec3.hpp>

#include <vector>

namespace lampyris {

// Where the transforms of a description take their origins, in the description's order, before they were rounded to floats.
struct Places {
    glm::dvec3 camera{0.0};
    std::vector<glm::dvec3> shapes, instances, lights,
        textures;  // of the world: an object's shapes are in their own space
};

// Moves a scene whose distance from the origin is many times its size, as far as can be told before its files are read, so
// that nothing but the size is left to be rounded. Returns the point that was made the origin; zero, and nothing moved, where
// coordinates would not gain digits by it: the transforms, and with them the images, of ordinary scenes stay what they are.
glm::dvec3 recentre(SceneDescription& description, const Places& places);

}  // namespace lampyris
