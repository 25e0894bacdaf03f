#include "core/scene/shapes/mesh.h"

#include "core/scene/area_lights.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>

namespace lampyris {

namespace {

// Appends; takes over the storage if the array is empty, so that a single large mesh is not copied.
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
    // Normals are transformed by the inverse transpose, and are not normalised: pbrt-v4 interpolates them like this.
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
            light = triangle_light(p[0], p[1], p[2], context.build.scene.geometries[geometry].flags);
            area = double(light.area);
        } else {
            area = patch_area(p[0], p[1], p[2], p[3]);
            light.kind = kernel::LIGHT_GEOMETRY;
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
    // Negative indices become huge, and are reported as out of range.
    const std::vector<int32_t> indices = reader.take_ints("indices");
    mesh.indices.assign(indices.begin(), indices.end());
    // A single face needs no indices, as in pbrt-v4.
    if (mesh.indices.empty() && mesh.positions.size() == size_t(3 * mesh.corners))
        for (uint32_t i = 0; i < mesh.corners; ++i) mesh.indices.push_back(i);
    return check_mesh(context, mesh);
}

bool check_mesh(ShapeContext& context, const Mesh& mesh) {
    ParameterReader& reader = context.reader;
    // If the mesh comes from a file, so do its parameters; the error is then reported at the file's name.
    const auto fail = [&](const char* name, const std::string& message, const std::string& hint) {
        context.build.diagnostics.error(reader.location(reader.has(name) ? name : "filename"), message, hint);
        return false;
    };
    const size_t vertices = mesh.positions.size() / 3;
    if (mesh.positions.empty() && reader.has("P"))
        return fail("P", "the mesh has no vertices", "\"point3 P\" with 3 numbers a vertex");
    if (mesh.positions.empty()) return false;  // reported as a missing parameter
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
        return fail("P", fmt::format("the mesh of {} vertices does not fit together with the others", vertices),
                    "kernels count to 2^32 coordinates");
    for (const float value : mesh.positions)
        if (!std::isfinite(value)) return fail("P", "a coordinate of the mesh is not finite", "");
    return true;
}

namespace {

// The attributes of a vertex that are not finite and cannot be used.
enum Unusable : uint8_t { kNormal = 1, kUv = 2 };

// Marks each vertex of whose `components` values one is not finite. Returns whether there are any.
bool mark_unusable(const std::vector<float>& values, size_t components, Unusable mark, std::vector<uint8_t>& marks) {
    bool any = false;
    for (size_t i = 0; i < values.size(); ++i) {
        if (std::isfinite(values[i])) continue;
        marks[i / components] |= mark;
        any = true;
    }
    return any;
}

uint8_t marks_of_face(const Mesh& mesh, const std::vector<uint8_t>& marks, size_t face) {
    uint8_t all = 0;
    for (uint32_t c = 0; c < mesh.corners; ++c) all |= marks[mesh.indices[face * mesh.corners + c]];
    return all;
}

void warn_of_unusable(ShapeContext& context, const Mesh& mesh, const std::vector<uint8_t>& marks, Unusable mark) {
    const size_t faces = mesh.indices.size() / mesh.corners;
    const auto vertices = std::count_if(marks.begin(), marks.end(), [&](uint8_t m) { return (m & mark) != 0; });
    const auto first =
        std::find_if(marks.begin(), marks.end(), [&](uint8_t m) { return (m & mark) != 0; }) - marks.begin();
    size_t affected = 0;
    for (size_t face = 0; face < faces; ++face) affected += (marks_of_face(mesh, marks, face) & mark) != 0;
    if (affected == 0) return;
    const char* name = mark == kNormal ? "N" : "uv";
    context.build.diagnostics.warning(
        context.reader.location(context.reader.has(name) ? name : "filename"),
        fmt::format("{} of the mesh's {} {} are not finite, the first is that of vertex {}: {} of its {} {} {}",
                    vertices, marks.size(), mark == kNormal ? "normals" : "texture coordinates", first, affected, faces,
                    mesh.corners == 3 ? "triangles" : "patches",
                    mark == kNormal ? "are shaded flat" : "use default texture coordinates"));
}

// The faces with exactly these marks, as a separate mesh without the attributes that cannot be used.
Mesh faces_with(const Mesh& mesh, const std::vector<uint8_t>& marks, uint8_t wanted) {
    constexpr uint32_t kUnset = 0xffffffffu;
    Mesh part;
    part.corners = mesh.corners;
    std::vector<uint32_t> new_index(marks.size(), kUnset);
    const auto copy = [](std::vector<float>& to, const std::vector<float>& from, size_t components, uint32_t i) {
        const auto first = from.begin() + ptrdiff_t(components * i);
        to.insert(to.end(), first, first + ptrdiff_t(components));
    };
    for (size_t face = 0; face < mesh.indices.size() / mesh.corners; ++face) {
        if (marks_of_face(mesh, marks, face) != wanted) continue;
        for (uint32_t c = 0; c < mesh.corners; ++c) {
            const uint32_t i = mesh.indices[face * mesh.corners + c];
            if (new_index[i] == kUnset) {
                new_index[i] = uint32_t(part.positions.size() / 3);
                copy(part.positions, mesh.positions, 3, i);
                if (!mesh.normals.empty() && (wanted & kNormal) == 0) copy(part.normals, mesh.normals, 3, i);
                if (!mesh.uvs.empty() && (wanted & kUv) == 0) copy(part.uvs, mesh.uvs, 2, i);
            }
            part.indices.push_back(new_index[i]);
        }
    }
    return part;
}

void add_usable(ShapeContext& context, Mesh&& mesh) {
    Scene& scene = context.build.scene;
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
    geometry.first_index = uint32_t(scene.indices.size());
    geometry.first_vertex = uint32_t(scene.positions.size() / 3);
    geometry.first_normal = mesh.normals.empty() ? kernel::NONE : uint32_t(scene.normals.size() / 3);
    geometry.first_uv = mesh.uvs.empty() ? kernel::NONE : uint32_t(scene.uvs.size() / 2);
    if (context.area_light) add_lights(context, mesh, index);
    append(scene.indices, std::move(mesh.indices));
    append(scene.positions, std::move(mesh.positions));
    append(scene.normals, std::move(mesh.normals));
    append(scene.uvs, std::move(mesh.uvs));
}

}  // namespace

// If the normal of one of its vertices is not finite, a face is shaded flat, as pbrt-v4 does for NaN. If a texture coordinate
// is not finite, the face gets those of a mesh without texture coordinates. Other faces keep theirs.
void add_mesh(ShapeContext& context, Mesh&& mesh) {
    const ShapeDescription& shape = context.shape;
    transform_mesh(mesh, shape.world_from_object.matrix[0], shape.reverse_orientation);
    std::vector<uint8_t> marks(mesh.positions.size() / 3);
    const bool bad_normals = mark_unusable(mesh.normals, 3, kNormal, marks),
               bad_uvs = mark_unusable(mesh.uvs, 2, kUv, marks);
    if (!bad_normals && !bad_uvs) return add_usable(context, std::move(mesh));
    if (bad_normals) warn_of_unusable(context, mesh, marks, kNormal);
    if (bad_uvs) warn_of_unusable(context, mesh, marks, kUv);
    for (const int wanted : {0, int(kNormal), int(kUv), kNormal | kUv})
        if (Mesh part = faces_with(mesh, marks, uint8_t(wanted)); !part.indices.empty())
            add_usable(context, std::move(part));
}

}  // namespace lampyris
