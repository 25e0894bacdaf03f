// Scenes that lie far from the world's origin are moved to it before coordinates are rounded to floats.
#pragma once

#include "core/scene/description.h"

#include <glm/vec3.hpp>

#include <vector>

namespace lampyris {

// The points to which the transforms of a description move their origins, in the description's order, before rounding to
// floats.
struct Places {
    glm::dvec3 camera{0.0};
    std::vector<glm::dvec3> shapes, instances, lights,
        textures;  // in world space, but those of an object's shapes are in the object's space
};

// Moves a scene to the origin if its distance from there is many times its size, so that coordinates are rounded in proportion
// to the size alone. The size is estimated before the scene's meshes are read from their files. Returns the point that became
// the origin. If coordinates would not gain accuracy, nothing is moved, and the result is zero: the transforms, and so the
// images, of ordinary scenes stay as they are.
glm::dvec3 recentre(SceneDescription& description, const Places& places);

}  // namespace lampyris
