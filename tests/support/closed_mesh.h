// Rays from inside closed meshes, none of which may pass.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lampyris::test {

// A rough ball, a cube of small squares, and a drum of needles.
std::vector<std::string> closed_meshes();

// How many of `rays` random rays from inside the mesh hit nothing, and for how many an occlusion test says so. With `aimed`, a third of
// them goes to vertices, a third to points of edges.
struct Escaped {
    uint64_t closest = 0, occlusion = 0;
};
Escaped escaped_rays(const std::string& mesh, const std::string& backend, uint64_t rays, bool aimed);

}  // namespace lampyris::test
