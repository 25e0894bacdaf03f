#include "core/scene/shapes/mesh.h"

#include "core/scene/area_lights.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <cmath>

namespace lampyris {

namespace {

// Appends, or takes the storage over where there is nothing yet: one large mesh is not copied.
template <typename T>
void append(std::vector<T>& to, std::vector<T>&& from) {
    if (to.empty()) {
        to = std::move(from);
    } else {
        to.insert(to.end(), from.begin(), from.end());
        std::vector<T>().swap(from);
    }
}

glm::vec3 point(const std::vector<float>& values, size_t i) {
    return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

void put(std::vector<float>& values, size_t i, glm::vec3 v) {
    values[3 * i] = v.x, values[3 * i + 1] = v.y, values[3 * i + 2] = v.z;
}

void transform_mesh(Mesh& mesh, const glm::mat4& matrix, bool negate_normals) {
    if (matrix != glm::mat4(1.0f))
        for (size_t i = 0; i < mesh.positions.size() / 3; ++i)
            put(mesh.positions, i, glm::vec3(matrix * glm::vec4(point(mesh.positions, i), 1.0f)));
    // Normals go by the inverse's transpose, and are not made unit length: interpolation is pbrt-v4's.
    const glm::mat3 normal_matrix(glm::transpose(glm::inverse(glm::dmat3(glm::mat3(matrix)))));
    const float sign = negate_normals ? -1.0f : 1.0f;
    if (normal_matrix != glm::mat3(1.0f) || negate_normals)
        for (size_t i = 0; i < mesh.normals.size() / 3; ++i)
            put(mesh.normals, i, sign * (normal_matrix * point(mesh.normals, i)));
}

// The area of a patch by quadrature of |dp/du x dp/dv|; exact for parallelograms.
double patch_area(glm::dvec3 p00, glm::dvec3 p10, glm::dvec3 p01, glm::dvec3 p11) {
    constexpr int kSteps = 8;
    double area = 0.0;
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
            const double u = (i + 0.5) / kSteps, v = (j + 0.5) / kSteps;
            const glm::dvec3 du = (1.0 - v) * (p10 - p00) + v * (p11 - p01),
                             dv = (1.0 - u) * (p01 - p00) + u * (p11 - p10);
            area += glm::length(glm::cross(du, dv));
        }
    return area / (kSteps * kSteps);
}

void add_lights(ShapeContext& context, const Mesh& mesh, uint32_t geometry) {
    const size_t faces = mesh.indices.size() / mesh.corners;
    begin_area_lights(context, geometry, uint32_t(faces));
    for (size_t face = 0; face < faces; ++face) {
        glm::vec3 p[4];
        for (uint32_t c = 0; c < mesh.corners; ++c) p[c] = point(mesh.positions, mesh.indices[face * mesh.corners + c]);
        kernel::LightRecord light{};
        double area;
        if (mesh.corners == 3) {
            light = triangle_light(p[0], p[1], p[2], context.build.scene.geometries[geometry].data.y);
            area = double(light.v0.w);
        } else {
            area = patch_area(p[0], p[1], p[2], p[3]);
            light.data.x = kernel::LIGHT_GEOMETRY;
        }
        add_area_light(context, light, geometry, uint32_t(face), float(area), float(area));
    }
}

}  // namespace

bool read_mesh(ShapeContext& context, Mesh& mesh) {
    ParameterReader& reader = context.reader;
    mesh.positions = reader.take_floats("P");
    mesh.normals = reader.take_floats("N");
    mesh.uvs = reader.take_floats("uv");
    // Negative ones become huge, and are out of range all the same.
    const std::vector<int32_t> indices = reader.take_ints("indices");
    mesh.indices.assign(indices.begin(), indices.end());
    // One face may do without indices, as in pbrt-v4.
    if (mesh.indices.empty() && mesh.positions.size() == size_t(3 * mesh.corners))
        for (uint32_t i = 0; i < mesh.corners; ++i) mesh.indices.push_back(i);
    return check_mesh(context, mesh);
}

bool check_mesh(ShapeContext& context, const Mesh& mesh) {
    ParameterReader& reader = context.reader;
    // A mesh from a file has its parameters there; the message then stands at the file's name.
    const auto fail = [&](const char* name, const std::string& message, const std::string& hint) {
        context.build.diagnostics.error(reader.location(reader.has(name) ? name : "filename"), message, hint);
        return false;
    };
    const size_t vertices = mesh.positions.size() / 3;
    if (mesh.positions.empty() && reader.has("P"))
        return fail("P", "the mesh has no vertices", "\"point3 P\" with 3 numbers a vertex");
    if (mesh.positions.empty()) return false;  // told as a missing parameter
    if (mesh.positions.size() % 3 != 0)
        return fail("P", fmt::format("\"P\" has {} numbers", mesh.positions.size()), "3 a vertex");
    if (mesh.indices.empty())
        return fail("indices", "the mesh has no faces",
                    fmt::format("\"integer indices\" with {} vertices a face", mesh.corners));
    if (mesh.indices.size() % mesh.corners != 0)
        return fail("indices", fmt::format("\"indices\" has {} numbers", mesh.indices.size()),
                    fmt::format("{} a face", mesh.corners));
    if (!mesh.normals.empty() && mesh.normals.size() != mesh.positions.size())
        return fail("N", fmt::format("\"N\" has {} numbers for {} vertices", mesh.normals.size(), vertices),
                    fmt::format("{}, 3 a vertex", 3 * vertices));
    if (!mesh.uvs.empty() && mesh.uvs.size() != 2 * vertices)
        return fail("uv", fmt::format("\"uv\" has {} numbers for {} vertices", mesh.uvs.size(), vertices),
                    fmt::format("{}, 2 a vertex", 2 * vertices));
    for (size_t i = 0; i < mesh.indices.size(); ++i)
        if (mesh.indices[i] >= vertices)
            return fail("indices",
                        fmt::format("index {} (number {} of \"indices\") is outside of the {} vertices",
                                    int32_t(mesh.indices[i]), i, vertices),
                        fmt::format("0 to {}", vertices - 1));
    if (vertices >= (size_t(1) << 31) ||
        context.build.scene.indices.size() + mesh.indices.size() >= (size_t(1) << 32) ||
        context.build.scene.positions.size() / 3 + vertices >= (size_t(1) << 32) / 3)
        return fail("P", fmt::format("the mesh of {} vertices does not fit beside the others", vertices),
                    "kernels count to 2^32 coordinates");
    for (const std::vector<float>* values : {&mesh.positions, &mesh.normals, &mesh.uvs})
        for (const float value : *values)
            if (!std::isfinite(value))
                return fail(values == &mesh.positions ? "P"
                            : values == &mesh.normals ? "N"
                                                      : "uv",
                            "a coordinate of the mesh is not finite", "");
    return true;
}

void add_mesh(ShapeContext& context, Mesh&& mesh) {
    Scene& scene = context.build.scene;
    const ShapeDescription& shape = context.shape;
    transform_mesh(mesh, shape.world_from_object.matrix[0], shape.reverse_orientation);
    uint32_t flags = 0;
    if (!mesh.normals.empty()) {
        flags |= kernel::GEOMETRY_HAS_NORMALS;
        context.build.ask(kernel::EFFECT_SMOOTH_NORMALS, context.asked_by);
    }
    if (!mesh.uvs.empty()) flags |= kernel::GEOMETRY_HAS_UVS;
    if (mesh.corners == 4) context.build.ask(kernel::EFFECT_BILINEAR, context.asked_by);
    const uint32_t kind = mesh.corners == 3 ? kernel::GEOMETRY_TRIANGLES : kernel::GEOMETRY_BILINEAR;
    const uint32_t index = context.add_geometry(kind, flags, uint32_t(mesh.indices.size() / mesh.corners));
    kernel::GeometryRecord& geometry = scene.geometries[index];
    geometry.data.z = uint32_t(scene.indices.size());
    geometry.data.w = uint32_t(scene.positions.size() / 3);
    geometry.attributes.x = mesh.normals.empty() ? kernel::NONE : uint32_t(scene.normals.size() / 3);
    geometry.attributes.y = mesh.uvs.empty() ? kernel::NONE : uint32_t(scene.uvs.size() / 2);
    if (context.area_light) add_lights(context, mesh, index);
    append(scene.indices, std::move(mesh.indices));
    append(scene.positions, std::move(mesh.positions));
    append(scene.normals, std::move(mesh.normals));
    append(scene.uvs, std::move(mesh.uvs));
}

}  // namespace lampyris
