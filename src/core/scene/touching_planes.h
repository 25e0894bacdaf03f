// Triangles by the planes in which they lie, for the search of surfaces in the same place.
#pragma once

#include "core/scene/scene.h"

#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <unordered_map>
#include <vector>

namespace lampyris {

// Faces that are closer than this, in parts of the coordinates, are in the same place: rays start about 4e-7 beyond a face, and up to
// three times as far beyond oblique ones, and both faces are rounded.
constexpr double kSamePlane = 2.4e-6;

// A triangle of a mesh, or half of a patch (all of it, if it is plane), in the space of its set.
struct PlaneTriangle {
    std::array<glm::dvec3, 3> corners;
    std::array<size_t, 3> vertices{};  // in Scene::positions
    // To the outside, as kernels see it; unit length, and 0 for a triangle without area.
    glm::dvec3 normal{0.0};
    double largest = 0.0;         // coordinate
    double distance_error = 0.0;  // of Plane::distance, from the rounding of its corners
    uint32_t geometry = 0;
};

// How many triangles a geometry has here: none if it is a quadric.
uint32_t plane_triangle_count(const kernel::GeometryRecord& g);
PlaneTriangle plane_triangle(const Scene& scene, uint32_t geometry, uint32_t index);

// The largest distance of b's corners from the plane of a.
double distance_from_plane(const PlaneTriangle& a, const PlaneTriangle& b);
bool in_one_plane(const PlaneTriangle& a, const PlaneTriangle& b);
// Whether triangles of one plane share more than an edge.
bool overlap(const PlaneTriangle& a, const PlaneTriangle& b);

// A plane without a side: of its two normals, the same one is taken however the triangle is turned.
struct Plane {
    glm::dvec3 normal;
    double distance;  // from the origin, along the normal
    explicit Plane(const PlaneTriangle& t);
    // The cell of directions that the normal is in, and those that it may be in but for rounding.
    uint64_t cell() const;
    std::vector<uint64_t> cells() const;
};

// Triangles, to be found by the plane of another one.
class TrianglesByPlane {
 public:
    // Those of a geometry one after the other. sort() comes after the last.
    void add(const PlaneTriangle& t);
    void sort();
    bool empty() const { return by_cell_.empty(); }

    // Calls visit(triangle) for those that may lie in the plane of t; geometries for which wanted(geometry) is false are left out.
    // Stops with a geometry where `visit` returns false.
    template <typename Wanted, typename Visit>
    void near(const PlaneTriangle& t, const Wanted& wanted, const Visit& visit) const;

 private:
    struct Entry {
        double distance;
        PlaneTriangle triangle;
    };
    struct Group {
        uint32_t geometry;
        std::vector<Entry> entries;  // by distance
        double error = 0.0;          // largest of theirs
    };
    std::unordered_map<uint64_t, std::vector<Group>> by_cell_;
};

// Planes of one geometry.
class PlaneSet {
 public:
    void add(const PlaneTriangle& t);
    bool contains(const PlaneTriangle& t) const;

 private:
    std::map<uint64_t, std::set<double>> by_cell_;
    double error_ = 0.0;  // largest of its triangles'
};

template <typename Wanted, typename Visit>
void TrianglesByPlane::near(const PlaneTriangle& t, const Wanted& wanted, const Visit& visit) const {
    const Plane plane(t);
    for (const uint64_t cell : plane.cells()) {
        const auto found = by_cell_.find(cell);
        if (found == by_cell_.end()) continue;
        for (const Group& group : found->second) {
            if (!wanted(group.geometry)) continue;
            const double error = t.distance_error + group.error;
            auto entry = std::lower_bound(group.entries.begin(), group.entries.end(), plane.distance - error,
                                          [](const Entry& e, double d) { return e.distance < d; });
            for (; entry != group.entries.end() && entry->distance <= plane.distance + error; ++entry)
                if (!visit(entry->triangle)) break;
        }
    }
}

}  // namespace lampyris
