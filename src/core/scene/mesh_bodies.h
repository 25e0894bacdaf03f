// Which triangles of a mesh bound the same body.
#pragma once

#include "core/scene/scene.h"

#include <cstdint>
#include <vector>

namespace lampyris {

struct MeshBodies {
    std::vector<uint32_t> of_triangle;  // the first triangle of its body
    bool share_vertices = false;        // two of them have an entry of `positions` in common: split_shared_vertices()
};

// Triangles with a common edge (one whose ends have the same positions) belong to the same body. Where bodies touch, more than two
// triangles meet at an edge: a triangle then continues in the one that it meets first when it is turned about the edge through the
// inside.
MeshBodies bodies_of_mesh(const Scene& scene, uint32_t geometry);

// Gives each body vertices of its own. A mesh whose bodies share some gets new ones at the end of the scene's arrays.
void split_shared_vertices(Scene& scene, uint32_t geometry, const MeshBodies& bodies);

// False if a mesh is one body for certain: edges of shared vertices connect all of its triangles, and no two triangles go along an edge
// in the same direction. It takes a moment, where bodies_of_mesh() takes seconds for a million triangles.
bool may_have_bodies(const Scene& scene, uint32_t geometry);

}  // namespace lampyris
