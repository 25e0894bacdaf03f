#include "core/scene/ply.h"

#include "core/base/error.h"
#include "core/scene/file_text.h"
#include "core/scene/ply_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace lampyris {
namespace {

// Destination of a vertex's scalar properties: up to three consecutive components of an array.
struct Attribute {
    std::vector<float>* values;
    size_t components;
    std::array<size_t, 3> property;  // indices into the element's properties
};

class PlyReader : PlyBody {
 public:
    using PlyBody::PlyBody;

    PlyMesh read() {
        bool has_vertices = false, has_faces = false;
        for (const PlyElement& element : header_.elements) {
            has_vertices = has_vertices || element.name == "vertex";
            has_faces = has_faces || element.name == "face";
        }
        if (!has_vertices || !has_faces)
            fail_in_header(header_.body,
                           std::string("the file has no element \"") + (has_vertices ? "face" : "vertex") + "\"");
        for (const PlyElement& element : header_.elements) {
            check_size(element);
            if (element.name == "vertex")
                read_vertices(element);
            else if (element.name == "face")
                read_faces(element);
            else
                skip(element);
        }
        check_indices(mesh_.triangles, 3, "triangle");
        check_indices(mesh_.quads, 4, "quad");
        mesh_.face_indices.insert(mesh_.face_indices.end(), quad_face_indices_.begin(), quad_face_indices_.end());
        return std::move(mesh_);
    }

 private:
    static constexpr size_t kAbsent = std::numeric_limits<size_t>::max();
    static size_t scalar(const PlyElement& element, std::string_view name) {
        for (size_t i = 0; i < element.properties.size(); ++i)
            if (element.properties[i].name == name && !element.properties[i].is_list) return i;
        return kAbsent;
    }

    std::vector<Attribute> attributes_of(const PlyElement& element) {
        std::vector<Attribute> attributes;
        attributes.push_back({&mesh_.positions, 3, {scalar(element, "x"), scalar(element, "y"), scalar(element, "z")}});
        for (size_t property : attributes[0].property)
            if (property == kAbsent) fail_in_header(element.offset, "vertices need the properties x, y and z");
        const std::array<size_t, 3> normal{scalar(element, "nx"), scalar(element, "ny"), scalar(element, "nz")};
        if (normal[0] != kAbsent && normal[1] != kAbsent && normal[2] != kAbsent)
            attributes.push_back({&mesh_.normals, 3, normal});
        static constexpr std::pair<const char*, const char*> kUvNames[] = {
            {"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}};
        for (const auto& [u, v] : kUvNames) {
            const std::array<size_t, 3> uv{scalar(element, u), scalar(element, v), kAbsent};
            if (uv[0] == kAbsent || uv[1] == kAbsent) continue;
            attributes.push_back({&mesh_.uvs, 2, uv});
            break;
        }
        return attributes;
    }

    void read_vertices(const PlyElement& element) {
        if (element.count > std::numeric_limits<uint32_t>::max())
            fail_in_header(element.offset, "more than 2^32 - 1 vertices");
        const std::vector<Attribute> attributes = attributes_of(element);
        for (const Attribute& attribute : attributes) attribute.values->resize(element.count * attribute.components);
        const char* start = p_;
        if (stride_of(element) > 0)
            read_packed_vertices(element, attributes);
        else
            read_mixed_vertices(element, attributes);
        // Normals and texture coordinates that are not finite are dealt with later (shapes/mesh.cpp).
        const std::vector<float>& values = mesh_.positions;
        const auto bad = std::find_if(values.begin(), values.end(), [](float v) { return !std::isfinite(v); });
        if (bad == values.end()) return;
        const auto index = static_cast<size_t>(bad - values.begin());
        fail(start, "property \"" + element.properties[attributes[0].property[index % 3]].name + "\" of vertex " +
                        std::to_string(index / 3) + " is not a finite float");
    }

    // Rows of a fixed size: each attribute separately; components that are adjacent floats are copied whole.
    void read_packed_vertices(const PlyElement& element, const std::vector<Attribute>& attributes) {
        const size_t stride = stride_of(element);
        std::vector<size_t> offsets(element.properties.size());
        for (size_t i = 1; i < offsets.size(); ++i)
            offsets[i] = offsets[i - 1] + size_of(element.properties[i - 1].type);
        for (const Attribute& attribute : attributes) {
            bool plain = !swap_;
            for (size_t c = 0; c < attribute.components; ++c) {
                const size_t property = attribute.property[c];
                plain = plain && element.properties[property].type == PlyType::kFloat32 &&
                        offsets[property] == offsets[attribute.property[0]] + c * sizeof(float);
            }
            float* out = attribute.values->data();
            if (plain) {
                const char* row = p_ + offsets[attribute.property[0]];
                const size_t bytes = attribute.components * sizeof(float);
                for (uint64_t i = 0; i < element.count; ++i, row += stride, out += attribute.components)
                    std::memcpy(out, row, bytes);
                continue;
            }
            for (uint64_t i = 0; i < element.count; ++i)
                for (size_t c = 0; c < attribute.components; ++c) {
                    const size_t property = attribute.property[c];
                    *out++ = to_float(
                        load_as_double(p_ + i * stride + offsets[property], element.properties[property].type, swap_));
                }
        }
        p_ += element.count * stride;
    }

    // A double beyond float's range becomes infinite, which is reported; converting it as such would be undefined.
    static float to_float(double value) {
        constexpr double kMax = std::numeric_limits<float>::max();
        if (value > kMax || value < -kMax) return std::numeric_limits<float>::infinity();
        return static_cast<float>(value);
    }

    void read_mixed_vertices(const PlyElement& element, const std::vector<Attribute>& attributes) {
        std::vector<std::pair<const Attribute*, size_t>> targets(element.properties.size(), {nullptr, 0});
        for (const Attribute& attribute : attributes)
            for (size_t c = 0; c < attribute.components; ++c) targets[attribute.property[c]] = {&attribute, c};
        for (uint64_t row = 0; row < element.count; ++row)
            for (size_t i = 0; i < element.properties.size(); ++i) {
                const PlyProperty& property = element.properties[i];
                const auto [attribute, component] = targets[i];
                if (attribute)
                    (*attribute->values)[row * attribute->components + component] =
                        to_float(read_value(element, property.type));
                else
                    skip_values(element, property.type, property.is_list ? read_count(element, property) : 1);
            }
    }

    void read_faces(const PlyElement& element) {
        size_t list = kAbsent, face_index = kAbsent;
        for (size_t i = 0; i < element.properties.size(); ++i) {
            const PlyProperty& property = element.properties[i];
            if (property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index")) {
                if (list != kAbsent) fail_in_header(element.offset, "faces have both vertex_indices and vertex_index");
                if (!is_integer(property.type)) fail_in_header(element.offset, "vertex indices are integers");
                list = i;
            }
            if (!property.is_list && property.name == "face_indices" && is_integer(property.type)) face_index = i;
        }
        if (list == kAbsent) fail_in_header(element.offset, "faces need the property list vertex_indices");
        if (element.count > std::numeric_limits<uint32_t>::max())
            fail_in_header(element.offset, "more than 2^32 - 1 faces");
        const PlyProperty& vertices = element.properties[list];
        const bool usual = !ascii_ && !swap_ && element.properties.size() == 1 && size_of(vertices.count_type) == 1 &&
                           size_of(vertices.type) == sizeof(uint32_t);
        if (usual)
            read_usual_faces(element);
        else
            read_mixed_faces(element, list, face_index);
    }

    void add_face(const std::array<uint32_t, 4>& v, uint64_t count) {
        if (count == 3)
            mesh_.triangles.insert(mesh_.triangles.end(), {v[0], v[1], v[2]});
        else if (count == 4)
            mesh_.quads.insert(mesh_.quads.end(), {v[0], v[1], v[3], v[2]});
        else
            ++mesh_.skipped_faces;
    }

    // One byte of count and that many 32-bit indices: the layout of nearly every binary file.
    void read_usual_faces(const PlyElement& element) {
        if (p_ != end_ && *p_ == 3) mesh_.triangles.reserve(3 * std::min<uint64_t>(element.count, (end_ - p_) / 13));
        if (p_ != end_ && *p_ == 4) mesh_.quads.reserve(4 * std::min<uint64_t>(element.count, (end_ - p_) / 17));
        const bool is_signed = element.properties[0].count_type == PlyType::kInt8;
        for (uint64_t face = 0; face < element.count; ++face) {
            if (p_ == end_) fail_truncated(element);
            const auto count = static_cast<uint8_t>(*p_);
            if (is_signed && count > 127) fail(p_, "a list of \"face\" has a negative length");
            if (static_cast<size_t>(end_ - p_) < 1 + count * sizeof(uint32_t)) fail_truncated(element);
            std::array<uint32_t, 4> v{};
            std::memcpy(v.data(), p_ + 1, sizeof(uint32_t) * std::min<size_t>(count, 4));
            add_face(v, count);
            p_ += 1 + count * sizeof(uint32_t);
        }
    }

    void read_mixed_faces(const PlyElement& element, size_t list, size_t face_index) {
        for (uint64_t face = 0; face < element.count; ++face) {
            std::array<uint32_t, 4> v{};
            uint64_t vertex_count = 0;
            int32_t index = 0;
            for (size_t i = 0; i < element.properties.size(); ++i) {
                const PlyProperty& property = element.properties[i];
                if (i == list) {
                    vertex_count = read_count(element, property);
                    const uint64_t kept = std::min<uint64_t>(vertex_count, v.size());
                    for (uint64_t k = 0; k < kept; ++k) v[k] = read_index(element, property.type);
                    skip_values(element, property.type, vertex_count - kept);
                } else if (i == face_index) {
                    index = static_cast<int32_t>(static_cast<uint32_t>(read_integer(element, property.type)));
                } else {
                    skip_values(element, property.type, property.is_list ? read_count(element, property) : 1);
                }
            }
            add_face(v, vertex_count);
            if (face_index == kAbsent) continue;
            if (vertex_count == 3) mesh_.face_indices.push_back(index);
            if (vertex_count == 4) quad_face_indices_.push_back(index);
        }
    }

    uint32_t read_index(const PlyElement& element, PlyType type) {
        const char* place = p_;
        const int64_t index = read_integer(element, type);
        if (index < 0) fail(place, "a face has the negative vertex index " + std::to_string(index));
        return static_cast<uint32_t>(index);
    }

    // Faces may come before vertices in the file, so this is checked at the end. A negative index counts as a large one here.
    void check_indices(const std::vector<uint32_t>& indices, size_t per_face, const char* what) const {
        const size_t vertex_count = mesh_.positions.size() / 3;
        uint32_t largest = 0;
        for (uint32_t index : indices) largest = std::max(largest, index);
        if (indices.empty() || largest < vertex_count) return;
        const auto bad =
            std::find_if(indices.begin(), indices.end(), [&](uint32_t index) { return index >= vertex_count; });
        throw InputError(name_ + ": error: " + what + " " +
                         std::to_string(static_cast<size_t>(bad - indices.begin()) / per_face) +
                         " has the vertex index " + std::to_string(static_cast<int32_t>(*bad)) + ", but there are " +
                         std::to_string(vertex_count) + " vertices");
    }

    PlyMesh mesh_;
    std::vector<int32_t> quad_face_indices_;
};

}  // namespace

PlyMesh read_ply_bytes(const std::string& name, std::string_view bytes) {
    if (!is_gzip(bytes)) return PlyReader(name, bytes).read();
    std::string inflated, why;
    if (!inflate_gzip(bytes, inflated, why)) throw InputError(name + ": error: " + why);
    return PlyReader(name, inflated).read();
}

PlyMesh read_ply(const std::string& path) {
    std::string why;
    const auto file = FileText::open(path, why);
    if (!file) throw InputError(path + ": error: the mesh cannot be read: " + why);
    return PlyReader(path, file->text()).read();
}

}  // namespace lampyris
