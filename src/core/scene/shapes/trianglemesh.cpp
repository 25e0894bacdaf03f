// Shape "trianglemesh".
#include "core/scene/shapes/mesh.h"

namespace lampyris {

namespace {

void build(ShapeContext& context) {
    Mesh mesh;
    context.reader.take_ints("faceIndices");
    if (!context.reader.take_floats("S").empty())
        context.build.diagnostics.unsupported(context.reader.location("S"), "tangents of a mesh (\"S\")",
                                              "without them, tangents follow uv");
    if (read_mesh(context, mesh)) add_mesh(context, std::move(mesh));
}

ParameterSpecs specs() {
    return {
        values("P", ParameterType::kPoint3, "", "positions of the vertices").in("scene units").needed(),
        values("indices", ParameterType::kInteger, "0 1 2 if there are 3 vertices", "three vertices a triangle"),
        values("N", ParameterType::kNormal, "flat", "normals at the vertices"),
        values("uv", ParameterType::kPoint2, "the triangle's corners", "texture coordinates at the vertices"),
        values("S", ParameterType::kVector3, "along u", "tangents at the vertices (not supported)"),
        values("faceIndices", ParameterType::kInteger, "none", "faces for ptex; has no effect"),
    };
}

const RegisterShape trianglemesh("trianglemesh", "Triangles that share vertices.", specs(), build);

}  // namespace

}  // namespace lampyris
