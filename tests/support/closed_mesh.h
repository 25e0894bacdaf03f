// Rays from inside closed meshes, none of which may pass.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lampyris::test {

// A rough ball, a cube of small squares, and a drum of needles.
std::vector<std::string> closed_meshes();

// How many of `rays` rays from random points inside the mesh hit nothing, and for how many an occlusion test says so. Rays have
// random directions, or go to random points of its edges, or to its vertices.
enum class Aim { kNowhere, kEdges, kVertices };
struct Escaped {
    uint64_t closest = 0, occlusion = 0;
};
Escaped escaped_rays(const std::string& mesh, const std::string& backend, uint64_t rays, Aim aim);

}  // namespace lampyris::test
