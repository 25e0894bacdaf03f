// Shape "bilinearmesh".
#include "core/scene/shapes/mesh.h"

namespace lampyris {

namespace {

void build(ShapeContext& context) {
    Mesh mesh;
    mesh.corners = 4;
    context.reader.take_ints("faceIndices");
    if (!context.reader.get_string("emissionfilename").empty())
        context.build.diagnostics.unsupported(context.reader.location("emissionfilename"),
                                              "\"emissionfilename\" of a bilinear mesh",
                                              "\"filename\" of its AreaLightSource shows an image, too");
    if (read_mesh(context, mesh)) add_mesh(context, std::move(mesh));
}

ParameterSpecs specs() {
    return {
        values("P", ParameterType::kPoint3, "", "positions of the vertices").in("scene units").needed(),
        values("indices", ParameterType::kInteger, "0 1 2 3 if there are 4 vertices",
               "four vertices a patch, at (u, v) = (0,0), (1,0), (0,1), (1,1)"),
        values("N", ParameterType::kNormal, "the surface's", "normals at the vertices"),
        values("uv", ParameterType::kPoint2, "the patch's own", "texture coordinates at the vertices"),
        text("emissionfilename", "", "an image of the emission (not supported)"),
        values("faceIndices", ParameterType::kInteger, "none", "faces for ptex; has no effect"),
    };
}

const RegisterShape bilinearmesh("bilinearmesh", "Bilinear patches that share vertices.", specs(), build);

}  // namespace

}  // namespace lampyris
