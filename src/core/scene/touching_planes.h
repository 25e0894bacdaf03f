// Triangles by the planes in which they lie, for the search of surfaces in the same place.
#pragma once

#include "core/scene/scene.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <map>
#include <set>
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

// Triangles of several geometries, to be found by their place: a tree of boxes.
class TriangleTree {
 public:
    void add(const PlaneTriangle& t, uint32_t index);
    void build();  // after the last one
    bool empty() const { return entries_.empty(); }

    // Calls visit(geometry, index) for the triangles of other geometries whose boxes are near that of t. Stops where it returns false.
    template <typename Visit>
    bool near(const PlaneTriangle& t, const Visit& visit) const {
        return entries_.empty() || near(0, Box(t), t.geometry, visit);
    }

 private:
    // Wider than the triangle by what counts as the same place.
    struct Box {
        glm::vec3 low, high;
        explicit Box(const PlaneTriangle& t);
        bool meets(const Box& other) const;
        void add(const Box& other);
    };
    struct Entry {
        Box box;
        uint32_t geometry, index;
    };
    struct Node {
        Box box;
        uint32_t lowest, highest;  // of its geometries
        uint32_t first, count;     // entries; count = 0: the children are the next node and `first`
    };
    uint32_t build(size_t first, size_t count);

    template <typename Visit>
    bool near(uint32_t at, const Box& box, uint32_t geometry, const Visit& visit) const {
        const Node& node = nodes_[at];
        if (!node.box.meets(box) || (node.lowest == geometry && node.highest == geometry)) return true;
        if (node.count == 0) return near(at + 1, box, geometry, visit) && near(node.first, box, geometry, visit);
        for (uint32_t i = node.first; i < node.first + node.count; ++i) {
            const Entry& entry = entries_[i];
            if (entry.geometry != geometry && entry.box.meets(box) && !visit(entry.geometry, entry.index)) return false;
        }
        return true;
    }

    std::vector<Entry> entries_;
    std::vector<Node> nodes_;
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

}  // namespace lampyris
