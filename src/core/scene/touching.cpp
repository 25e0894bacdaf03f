#include "core/scene/touching.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>

namespace lampyris {
namespace {

using glm::dvec2;
using glm::dvec3;

// Which materials let light pass. Those of a stranger's plugin are not known to.
class Passing {
 public:
    explicit Passing(const Scene& scene) : scene_(scene), known_(scene.materials.size(), kUnknown) {}

    bool operator()(const kernel::GeometryRecord& g) {
        return g.alpha_texture != kNone || g.alpha < 1.0f || material(g.material);
    }

 private:
    enum Answer : uint8_t { kUnknown, kNo, kYes };

    bool material(uint32_t index) {
        if (known_[index] != kUnknown) return known_[index] == kYes;
        known_[index] = kNo;
        const kernel::MaterialRecord& m = scene_.materials[index];
        bool passes = false;
        switch (m.kind) {
            case kernel::MATERIAL_DIELECTRIC:
            case kernel::MATERIAL_INTERFACE:
            case kernel::MATERIAL_THINDIELECTRIC:
            case kernel::MATERIAL_DIFFUSETRANSMISSION: passes = true; break;
            case kernel::MATERIAL_MIX: passes = material(m.first_material) || material(m.second_material); break;
            default: break;
        }
        known_[index] = passes ? kYes : kNo;
        return passes;
    }

    const Scene& scene_;
    std::vector<Answer> known_;
};

struct Triangle {
    std::array<dvec3, 3> corners;
    dvec3 normal{0.0};  // unit length, and 0 for a triangle without area
    uint32_t geometry = 0;
};

// Of a patch, the triangles on either side of a diagonal: all of it if it is plane.
constexpr std::array<std::array<uint32_t, 3>, 2> kHalves{{{0, 1, 3}, {0, 3, 2}}};

Triangle triangle_of(const Scene& scene, uint32_t geometry, uint32_t index) {
    const kernel::GeometryRecord& g = scene.geometries[geometry];
    const bool patch = g.kind == kernel::GEOMETRY_BILINEAR;
    Triangle t;
    t.geometry = geometry;
    for (uint32_t k = 0; k < 3; ++k) {
        const size_t corner = patch ? 4 * size_t(index / 2) + kHalves[index % 2][k] : 3 * size_t(index) + k;
        const size_t v = 3 * (size_t(g.first_vertex) + scene.indices[g.first_index + corner]);
        t.corners[k] = {scene.positions[v], scene.positions[v + 1], scene.positions[v + 2]};
    }
    const dvec3 n = glm::cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]);
    if (const double length = glm::length(n); length > 0.0) t.normal = n / length;
    return t;
}

double largest_coordinate(const Triangle& t) {
    double largest = 0.0;
    for (const dvec3& p : t.corners)
        for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::abs(p[axis]));
    return largest;
}

// Rays start this far beyond a surface, in parts of the coordinates: what is closer is not seen.
constexpr double kSame = 4e-7;

bool in_one_plane(const Triangle& a, const Triangle& b) {
    const double error = kSame * std::max(largest_coordinate(a), largest_coordinate(b));
    return std::all_of(b.corners.begin(), b.corners.end(),
                       [&](const dvec3& p) { return std::abs(glm::dot(p - a.corners[0], a.normal)) <= error; });
}

// Whether triangles of one plane share more than an edge: no edge's line separates them.
bool overlap(const Triangle& a, const Triangle& b) {
    const double error = 1e-5 * std::max(largest_coordinate(a), largest_coordinate(b));
    const dvec3 size = glm::abs(a.normal);
    const int dropped = size.x > size.y && size.x > size.z ? 0 : (size.y > size.z ? 1 : 2);
    const auto flat = [&](const dvec3& p) { return dvec2(p[(dropped + 1) % 3], p[(dropped + 2) % 3]); };
    for (const Triangle* edges : {&a, &b}) {
        for (int i = 0; i < 3; ++i) {
            const dvec2 from = flat(edges->corners[size_t(i)]), to = flat(edges->corners[size_t((i + 1) % 3)]);
            const dvec2 across = glm::normalize(dvec2(to.y - from.y, from.x - to.x));
            double a_low = 1e300, a_high = -1e300, b_low = 1e300, b_high = -1e300;
            for (const dvec3& p : a.corners) {
                const double x = glm::dot(flat(p) - from, across);
                a_low = std::min(a_low, x), a_high = std::max(a_high, x);
            }
            for (const dvec3& p : b.corners) {
                const double x = glm::dot(flat(p) - from, across);
                b_low = std::min(b_low, x), b_high = std::max(b_high, x);
            }
            if (!(std::min(a_high, b_high) - std::max(a_low, b_low) > error)) return false;
        }
    }
    return true;
}

// Triangles by their planes. Equal numbers give equal keys: faces that touch as they were written are found. Of faces that rounding
// has moved, some few are not, where a number lies at the border of its step.
class Planes {
 public:
    static uint64_t key(const Triangle& t) {
        dvec3 n = t.normal;
        const dvec3 size = glm::abs(n);
        const double largest = size.x >= size.y && size.x >= size.z ? n.x : (size.y >= size.z ? n.y : n.z);
        if (largest < 0.0) n = -n;
        const double distance = glm::dot(t.corners[0], n);
        // The distance in steps of about 1e-5 of itself.
        int exponent = 0;
        const double fraction = std::frexp(distance, &exponent);
        uint64_t hash = 0xcbf29ce484222325ull;
        for (const double x : {n.x * 1e4, n.y * 1e4, n.z * 1e4, fraction * 1e5, double(exponent)})
            hash = (hash ^ uint64_t(int64_t(std::llround(x)))) * 0x100000001b3ull, hash ^= hash >> 29;
        return hash;
    }

    // Those of a geometry one after the other.
    void add(const Triangle& t) {
        std::vector<std::vector<Triangle>>& shapes = by_key_[key(t)];
        if (shapes.empty() || shapes.back().front().geometry != t.geometry) shapes.emplace_back();
        shapes.back().push_back(t);
    }
    bool empty() const { return by_key_.empty(); }
    // Triangles of the same plane, by geometry.
    const std::vector<std::vector<Triangle>>* of(const Triangle& t) const {
        const auto found = by_key_.find(key(t));
        return found == by_key_.end() ? nullptr : &found->second;
    }

 private:
    std::unordered_map<uint64_t, std::vector<std::vector<Triangle>>> by_key_;
};

// Kind, size and place of a sphere, disk or cylinder.
std::string quadric_key(const Scene& scene, const kernel::GeometryRecord& g) {
    std::string key(reinterpret_cast<const char*>(&g.kind), sizeof g.kind);
    key.append(reinterpret_cast<const char*>(&g.quadric), sizeof g.quadric);
    key.append(reinterpret_cast<const char*>(&scene.transforms[g.transform]), sizeof(kernel::TransformRecord));
    return key;
}

constexpr size_t kMostWarnings = 10;
// Planes with very many triangles would take too long.
constexpr size_t kMostPairs = 2'000'000;

}  // namespace

void warn_of_touching_surfaces(BuildContext& context, const std::vector<Location>& places) {
    const Scene& scene = context.scene;
    Passing passes(scene);
    std::set<std::pair<uint32_t, uint32_t>> told;
    size_t pairs = 0;
    const auto for_each_triangle = [&](const GeometrySet& set, auto&& visit) {
        for (uint32_t g = set.first_geometry; g < set.first_geometry + set.geometry_count; ++g) {
            const kernel::GeometryRecord& record = scene.geometries[g];
            if (record.kind > kernel::GEOMETRY_BILINEAR) continue;
            const uint32_t count = record.primitive_count * (record.kind == kernel::GEOMETRY_BILINEAR ? 2 : 1);
            for (uint32_t i = 0; i < count; ++i) {
                const Triangle t = triangle_of(scene, g, i);
                if (t.normal != dvec3(0.0)) visit(t);
            }
        }
    };
    const auto tell = [&](uint32_t a, uint32_t b) {
        const auto pair = std::minmax(a, b);
        if (told.size() >= kMostWarnings || !told.insert(pair).second) return;
        context.diagnostics.warning(
            places[pair.second],
            fmt::format(
                "a surface of this shape lies in the same place as one of the shape at {}, and light that passes "
                "through one of them misses the other",
                context.description.sources->describe(places[pair.first])),
            "a gap of 1e-6 of the coordinates is enough, or let the shapes overlap");
    };
    for (const GeometrySet& set : scene.sets) {
        if (set.geometry_count < 2) continue;
        // Curved shapes: those that are the same.
        std::map<std::string, uint32_t> first_of;
        for (uint32_t g = set.first_geometry; g < set.first_geometry + set.geometry_count; ++g) {
            const kernel::GeometryRecord& record = scene.geometries[g];
            if (record.kind <= kernel::GEOMETRY_BILINEAR) continue;
            const auto [first, is_first] = first_of.try_emplace(quadric_key(scene, record), g);
            if (!is_first && (passes(record) || passes(scene.geometries[first->second]))) tell(first->second, g);
        }
        Planes planes;
        for_each_triangle(set, [&](const Triangle& t) {
            if (passes(scene.geometries[t.geometry])) planes.add(t);
        });
        if (planes.empty()) continue;
        for_each_triangle(set, [&](const Triangle& t) {
            const std::vector<std::vector<Triangle>>* shapes = planes.of(t);
            if (!shapes) return;
            for (const std::vector<Triangle>& shape : *shapes) {
                if (shape.front().geometry == t.geometry ||
                    told.contains(std::minmax(t.geometry, shape.front().geometry)))
                    continue;
                for (const Triangle& other : shape) {
                    if (told.size() >= kMostWarnings || ++pairs > kMostPairs) return;
                    if (!in_one_plane(other, t) || !overlap(other, t)) continue;
                    tell(t.geometry, other.geometry);
                    break;
                }
            }
        });
    }
}

}  // namespace lampyris
