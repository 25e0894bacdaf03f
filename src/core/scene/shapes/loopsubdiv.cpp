// Shape "loopsubdiv".
#include "core/scene/shapes/loop_subdivision.h"
#include "core/scene/shapes/mesh.h"

#include <fmt/format.h>

namespace lampyris {

namespace {

constexpr size_t kMostFaces = size_t(1) << 24;  // the adjacency of this many takes about 3 GB

void build(ShapeContext& context) {
    ParameterReader& reader = context.reader;
    const int levels = reader.get_int("levels");
    reader.get_string("scheme");
    Mesh mesh;
    mesh.positions = reader.take_floats("P");
    const std::vector<int32_t> indices = reader.take_ints("indices");
    mesh.indices.assign(indices.begin(), indices.end());
    if (!check_mesh(context, mesh)) return;
    if ((mesh.indices.size() / 3) << (2 * levels) > kMostFaces) {
        reader.error("levels",
                     fmt::format("{} levels make {} triangles of {}", levels, (mesh.indices.size() / 3) << (2 * levels),
                                 mesh.indices.size() / 3),
                     fmt::format("at most {}", kMostFaces));
        return;
    }
    std::vector<glm::vec3> positions(mesh.positions.size() / 3);
    for (size_t i = 0; i < positions.size(); ++i)
        positions[i] = {mesh.positions[3 * i], mesh.positions[3 * i + 1], mesh.positions[3 * i + 2]};
    std::vector<std::array<uint32_t, 3>> faces(mesh.indices.size() / 3);
    for (size_t i = 0; i < faces.size(); ++i)
        faces[i] = {mesh.indices[3 * i], mesh.indices[3 * i + 1], mesh.indices[3 * i + 2]};
    const SubdividedMesh limit = loop_subdivide(std::move(positions), std::move(faces), levels);
    if (!limit.error.empty()) {
        reader.error("indices", fmt::format("the mesh cannot be subdivided: {}", limit.error),
                     "each edge belongs to at most two faces of the same orientation");
        return;
    }
    mesh.positions.clear(), mesh.indices.clear();
    for (const glm::vec3& p : limit.positions) mesh.positions.insert(mesh.positions.end(), {p.x, p.y, p.z});
    for (const glm::vec3& n : limit.normals) mesh.normals.insert(mesh.normals.end(), {n.x, n.y, n.z});
    for (const auto& face : limit.faces) mesh.indices.insert(mesh.indices.end(), face.begin(), face.end());
    add_mesh(context, std::move(mesh));
}

ParameterSpecs specs() {
    return {
        values("P", ParameterType::kPoint3, "", "positions of the control mesh's vertices").in("scene units").needed(),
        values("indices", ParameterType::kInteger, "", "three vertices a face").needed(),
        integer("levels", 3, "how often each triangle is split into four").between(0, 12),
        text("scheme", "loop", "of subdivision").one_of({"loop"}),
    };
}

const RegisterShape loopsubdiv("loopsubdiv", "The limit surface of Loop's subdivision of a triangle mesh.", specs(),
                               build);

}  // namespace

}  // namespace lampyris
