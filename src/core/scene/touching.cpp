#include "core/scene/touching.h"

#include "core/scene/touching_planes.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

namespace lampyris {
namespace {

using glm::dvec3;

// Which materials let light pass. Those of a stranger's plugin are not known to.
class Passing {
 public:
    explicit Passing(const Scene& scene) : scene_(scene), known_(scene.materials.size(), kUnknown) {}

    bool operator()(const kernel::GeometryRecord& g) {
        return g.alpha_texture != kNone || g.alpha < 1.0f || material(g.material);
    }
    // Whether it is the boundary of a body, so that "inwards" has a meaning. Shapes that emit stay where their lights are.
    bool is_boundary(const kernel::GeometryRecord& g) const {
        const uint32_t kind = scene_.materials[g.material].kind;
        return (kind == kernel::MATERIAL_DIELECTRIC || kind == kernel::MATERIAL_INTERFACE) &&
               g.alpha_texture == kNone && g.alpha >= 1.0f && g.first_light == kernel::NONE;
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

// Kind, size and place of a sphere, disk or cylinder.
std::string quadric_key(const Scene& scene, const kernel::GeometryRecord& g) {
    std::string key(reinterpret_cast<const char*>(&g.kind), sizeof g.kind);
    key.append(reinterpret_cast<const char*>(&g.quadric), sizeof g.quadric);
    key.append(reinterpret_cast<const char*>(&scene.transforms[g.transform]), sizeof(kernel::TransformRecord));
    return key;
}

constexpr size_t kMostMessages = 10;
// Thousands of shapes in one place would take too long.
constexpr size_t kMostPairs = 20'000'000;

// Faces that touch are moved apart by this part of the coordinates.
constexpr double kGap = 3e-6;
// No body is changed by more than this part of its size.
constexpr double kMostChange = 1e-3;

// The largest coordinate in the world of what an object with coordinates up to `largest` becomes, in the object's own lengths.
double reach_of_object(const Scene& scene, uint32_t set, double largest) {
    double most = 0.0;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        if (scene.instance_sets[i] != set) continue;
        const kernel::TransformRecord& t = scene.instances[i].transform;
        double coordinate = 0.0, shrink = 0.0;
        for (const kernel::vec4& row : {t.to0, t.to1, t.to2})
            coordinate = std::max(coordinate, glm::length(dvec3(row)) * largest + std::abs(double(row.w)));
        for (const kernel::vec4& row : {t.from0, t.from1, t.from2}) shrink = std::max(shrink, glm::length(dvec3(row)));
        most = std::max(most, coordinate * shrink);
    }
    return most;
}

// Moves faces of a geometry to its inside.
class Inset {
 public:
    // Asks for a gap between the face in which t lies and what it touches.
    void add(const PlaneTriangle& t, double gap) {
        planes_.add(t);
        gap_ = std::max(gap_, gap);
    }
    bool contains(const PlaneTriangle& t) const { return planes_.contains(t); }

    void apply(Scene& scene, uint32_t geometry) const {
        std::map<std::array<float, 3>, std::vector<dvec3>> normals;  // of the faces to be moved, by vertex
        const kernel::GeometryRecord& g = scene.geometries[geometry];
        std::set<size_t> vertices;
        for (uint32_t i = 0; i < plane_triangle_count(g); ++i) {
            const PlaneTriangle t = plane_triangle(scene, geometry, i);
            vertices.insert(t.vertices.begin(), t.vertices.end());
            if (t.normal == dvec3(0.0) || !planes_.contains(t)) continue;
            for (const size_t v : t.vertices) normals[position(scene, v)].push_back(t.normal);
        }
        for (const size_t v : vertices) {
            const auto found = normals.find(position(scene, v));
            if (found == normals.end()) continue;
            const dvec3 by = displacement(found->second);
            for (size_t axis = 0; axis < 3; ++axis) {
                float& x = scene.positions[3 * v + axis];
                x = float(double(x) + by[int(axis)]);
            }
        }
    }

 private:
    static std::array<float, 3> position(const Scene& scene, size_t v) {
        return {scene.positions[3 * v], scene.positions[3 * v + 1], scene.positions[3 * v + 2]};
    }

    // The vertex lies on all of these faces, and goes below each by the gap (projections onto half-spaces in turns).
    dvec3 displacement(const std::vector<dvec3>& normals) const {
        constexpr int kRounds = 32;
        dvec3 by(0.0);
        for (int round = 0; round < kRounds; ++round) {
            bool moved = false;
            for (const dvec3& n : normals) {
                const double missing = gap_ + glm::dot(by, n);
                if (missing > 1e-3 * gap_) by -= missing * n, moved = true;
            }
            if (!moved) break;
        }
        // At a sharp tip, the half-spaces meet far away.
        const double length = glm::length(by), most = 4.0 * gap_;
        return length > most ? by * (most / length) : by;
    }

    PlaneSet planes_;
    double gap_ = 0.0;
};

// The search through one set, and what comes of it.
class Search {
 public:
    Search(BuildContext& context, const std::vector<Location>& places)
        : context_(context), scene_(context.scene), places_(places), passes_(scene_) {}

    void run(uint32_t set_index) {
        const GeometrySet& set = scene_.sets[set_index];
        if (set.geometry_count < 2) return;
        equal_quadrics(set);
        TriangleTree passing;
        double largest = 0.0;
        for_each_triangle(set, [&](const PlaneTriangle& t, uint32_t index) {
            largest = std::max(largest, t.largest);
            if (passes_(scene_.geometries[t.geometry])) passing.add(t, index);
        });
        if (passing.empty()) return;
        passing.build();
        object_reach_ = set_index == 0 ? 0.0 : reach_of_object(scene_, set_index, largest);
        for_each_triangle(set, [&](const PlaneTriangle& t, uint32_t) {
            passing.near(t, [&](uint32_t geometry, uint32_t index) {
                if (++pairs_ > kMostPairs) return false;
                if (told_.contains(std::minmax(t.geometry, geometry))) return true;
                const PlaneTriangle other = plane_triangle(scene_, geometry, index);
                if (in_one_plane(other, t) && overlap(other, t)) touch(t, other);
                return true;
            });
        });
        for (const auto& [geometry, inset] : insets_) inset.apply(scene_, geometry);
        insets_.clear();
    }

    // For the user to know.
    void report() {
        size_t left = moved_.size();
        for (const auto& [pair, gap] : moved_) {
            if (moved_.size() - left == kMostMessages) break;
            --left;
            scene_.notes.push_back(fmt::format(
                "{} (Shape): a face lies on one of the shape at {}, where light passes: it is moved inwards by {:.1g}",
                where(pair.first), where(pair.second), gap));
        }
        if (left > 0) scene_.notes.push_back(fmt::format("{} more shapes touch, and are moved as well", left));
        if (pairs_ > kMostPairs)
            scene_.notes.push_back(
                "not all shapes were looked at for faces in the same place: there are too many of them");
    }

 private:
    template <typename Visit>
    void for_each_triangle(const GeometrySet& set, const Visit& visit) const {
        for (uint32_t g = set.first_geometry; g < set.first_geometry + set.geometry_count; ++g)
            for (uint32_t i = 0; i < plane_triangle_count(scene_.geometries[g]); ++i) {
                const PlaneTriangle t = plane_triangle(scene_, g, i);
                if (t.normal != dvec3(0.0)) visit(t, i);
            }
    }

    // Curved shapes: those that are the same.
    void equal_quadrics(const GeometrySet& set) {
        std::map<std::string, uint32_t> first_of;
        for (uint32_t g = set.first_geometry; g < set.first_geometry + set.geometry_count; ++g) {
            const kernel::GeometryRecord& record = scene_.geometries[g];
            if (record.kind <= kernel::GEOMETRY_BILINEAR) continue;
            const auto [first, is_first] = first_of.try_emplace(quadric_key(scene_, record), g);
            if (!is_first && (passes_(record) || passes_(scene_.geometries[first->second]))) warn(first->second, g);
        }
    }

    // `a` and `b` overlap in one plane.
    void touch(const PlaneTriangle& a, const PlaneTriangle& b) {
        const bool a_can = passes_.is_boundary(scene_.geometries[a.geometry]),
                   b_can = passes_.is_boundary(scene_.geometries[b.geometry]);
        // Of two bodies, one ends where the other begins: the later one gives way. If both are on the same side, nobody knows
        // which is to be inside of the other.
        const bool unclear = a_can && b_can && glm::dot(a.normal, b.normal) > 0.0;
        if (unclear || (!a_can && !b_can)) return warn(a.geometry, b.geometry);
        const bool a_moves = a_can && (!b_can || a.geometry > b.geometry);
        const PlaneTriangle& moved = a_moves ? a : b;
        const PlaneTriangle& fixed = a_moves ? b : a;
        Inset& inset = insets_[moved.geometry];
        if (inset.contains(moved)) return;
        const double gap = kGap * std::max({a.largest, b.largest, object_reach_}) + distance_from_plane(fixed, moved);
        if (gap > kMostChange * size_of(moved.geometry)) return warn(a.geometry, b.geometry);
        inset.add(moved, gap);
        double& largest_gap = moved_[{moved.geometry, fixed.geometry}];
        largest_gap = std::max(largest_gap, gap);
    }

    void warn(uint32_t a, uint32_t b) {
        const auto pair = std::minmax(a, b);
        if (!told_.insert(pair).second || told_.size() > kMostMessages) return;
        context_.diagnostics.warning(
            places_[pair.second],
            fmt::format("a surface of this shape lies in the same place as one of the shape at {}, and light that "
                        "passes through one of them misses the other",
                        where(pair.first)),
            fmt::format("a gap of {:g} of the coordinates is enough, or let the shapes overlap", kGap));
    }

    // The diagonal of a mesh's box.
    double size_of(uint32_t geometry) {
        const auto [known, is_new] = sizes_.try_emplace(geometry, 0.0);
        if (!is_new) return known->second;
        dvec3 low(1e300), high(-1e300);
        for (uint32_t i = 0; i < plane_triangle_count(scene_.geometries[geometry]); ++i)
            for (const dvec3& p : plane_triangle(scene_, geometry, i).corners)
                low = glm::min(low, p), high = glm::max(high, p);
        return known->second = glm::length(high - low);
    }

    std::string where(uint32_t geometry) const { return context_.description.sources->describe(places_[geometry]); }

    BuildContext& context_;
    Scene& scene_;
    const std::vector<Location>& places_;
    Passing passes_;
    double object_reach_ = 0.0;  // of the set that is searched; 0: the world
    size_t pairs_ = 0;
    std::set<std::pair<uint32_t, uint32_t>> told_;
    std::map<std::pair<uint32_t, uint32_t>, double> moved_;  // geometry and the one that it touches; the gap
    std::map<uint32_t, Inset> insets_;
    std::map<uint32_t, double> sizes_;
};

}  // namespace

void separate_touching_surfaces(BuildContext& context, const std::vector<Location>& places) {
    Search search(context, places);
    for (uint32_t set = 0; set < context.scene.sets.size(); ++set) search.run(set);
    search.report();
}

}  // namespace lampyris
