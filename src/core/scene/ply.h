// Meshes from PLY files: ascii, binary of either byte order, gzip'd or not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lampyris {

struct PlyMesh {
    std::vector<float> positions;     // x y z of each vertex
    std::vector<float> normals;       // nx ny nz, or empty
    std::vector<float> uvs;           // u v, or empty
    std::vector<uint32_t> triangles;  // three vertices each
    // Four vertices each, in the order of a bilinear patch's corners (0,0) (1,0) (0,1) (1,1), as pbrt converts a quad: these
    // are the file's 1st, 2nd, 4th and 3rd. Split into triangles, a quad is the 1st, 2nd, 4th and the 1st, 4th, 3rd of the four
    // here.
    std::vector<uint32_t> quads;
    std::vector<int32_t> face_indices;  // empty, or one per triangle and then one per quad
    size_t skipped_faces = 0;           // with neither three nor four vertices: skipped, as in pbrt
};

// Throws InputError, with a place in the file, if the file cannot be read or does not match its header. Every index of the
// result is within range, and every position is finite; normals and texture coordinates may be infinite or NaN.
PlyMesh read_ply(const std::string& path);
// The same for a file's bytes in memory; `name` is used in messages.
PlyMesh read_ply_bytes(const std::string& name, std::string_view bytes);

}  // namespace lampyris
