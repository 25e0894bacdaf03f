// What the mesh shapes share: checking, baking to world space, and appending to the scene's arrays.
#pragma once

#include "core/scene/builder.h"

#include <vector>

namespace lampyris {

struct Mesh {
    std::vector<float> positions, normals, uvs;
    std::vector<uint32_t> indices;
    uint32_t corners = 3;  // of a face: 3 (triangles) or 4 (bilinear patches p00, p10, p01, p11)
};

// Reads P, N, uv and indices of a directive. False where there is no mesh left to build (told).
bool read_mesh(ShapeContext& context, Mesh& mesh);
// False, and an error, where counts do not fit or an index is out of range. `where` is asked for the place of a parameter.
bool check_mesh(ShapeContext& context, const Mesh& mesh);
// Transforms the mesh to world space (or to the object's), and adds geometry and lights.
void add_mesh(ShapeContext& context, Mesh&& mesh);

}  // namespace lampyris
