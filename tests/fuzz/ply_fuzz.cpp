// Any bytes are either a mesh or an InputError, and the indices of a mesh are within its vertices.
#include "core/base/error.h"
#include "core/scene/ply.h"

#include <cassert>
#include <cmath>

using namespace lampyris;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    try {
        const PlyMesh mesh = read_ply_bytes("fuzz.ply", {reinterpret_cast<const char*>(data), size});
        assert(mesh.positions.size() % 3 == 0 && mesh.triangles.size() % 3 == 0 && mesh.quads.size() % 4 == 0);
        const size_t vertices = mesh.positions.size() / 3;
        assert(mesh.normals.empty() || mesh.normals.size() == 3 * vertices);
        assert(mesh.uvs.empty() || mesh.uvs.size() == 2 * vertices);
        assert(mesh.face_indices.empty() ||
               mesh.face_indices.size() == mesh.triangles.size() / 3 + mesh.quads.size() / 4);
        for (const uint32_t index : mesh.triangles) assert(index < vertices);
        for (const uint32_t index : mesh.quads) assert(index < vertices);
        for (const float value : mesh.positions) assert(std::isfinite(value));
    } catch (const InputError&) {}
    return 0;
}
