// Loop's subdivision of triangle meshes, to the limit surface.
#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace lampyris {

struct SubdividedMesh {
    std::vector<glm::vec3> positions, normals;  // of the limit surface
    std::vector<std::array<uint32_t, 3>> faces;
    std::string error;  // the error in the input; empty if there is none
};

// Indices must be in range. Normals point as in pbrt-v4: away from the side on which the faces run counter-clockwise.
SubdividedMesh loop_subdivide(std::vector<glm::vec3> positions, std::vector<std::array<uint32_t, 3>> faces, int levels);

}  // namespace lampyris
