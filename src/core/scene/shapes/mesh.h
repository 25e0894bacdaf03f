// Shared by the mesh shapes: checking, transforming to world space, and appending to the scene's arrays.
#pragma once

#include "core/scene/builder.h"

#include <vector>

namespace lampyris {

struct Mesh {
    std::vector<float> positions, normals, uvs;
    std::vector<uint32_t> indices;
    uint32_t corners = 3;  // of a face: 3 (triangles) or 4 (bilinear patches p00, p10, p01, p11)
};

// Reads P, N, uv and indices of a directive. False, with the error reported, if no mesh is left to build.
bool read_mesh(ShapeContext& context, Mesh& mesh);
// False, with the error reported, if counts do not match or an index is out of range.
bool check_mesh(ShapeContext& context, const Mesh& mesh);
// Transforms the mesh to world space (or to the object's), and adds geometry and lights.
void add_mesh(ShapeContext& context, Mesh&& mesh);

}  // namespace lampyris
