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
// three times as far beyond oblique ones, and both faces are rounded. The error of their planes comes on top of it.
constexpr double kSamePlane = 2.4e-6;

// A triangle of a mesh, half of a patch (all of it, if it is plane) or a part of a disk, in the space of its set or in the world.
struct PlaneTriangle {
    std::array<glm::dvec3, 3> corners;
    std::array<size_t, 3> vertices{};  // in Scene::positions; not of disks
    // To the outside, as kernels see it; unit length, and 0 for a triangle without area.
    glm::dvec3 normal{0.0};
    double largest = 0.0;         // coordinate that rays have there
    double plane_error = 0.0;     // how far from it tracers may find its plane (triangle_plane_error, shapes.h)
    double height = 0.0;          // on its longest side
    double distance_error = 0.0;  // of Plane::distance, from the rounding of its corners
    double scale = 1.0;           // a length along the normal in the space of its set, over the same one here
    uint32_t instance = 0, geometry = 0, index = 0;
};

// How many triangles a geometry has here: none if it is a sphere or a cylinder.
uint32_t plane_triangle_count(const kernel::GeometryRecord& g);
PlaneTriangle plane_triangle(const Scene& scene, uint32_t geometry, uint32_t index);
// The vertices of a mesh's triangle, in Scene::positions.
std::array<size_t, 3> triangle_vertices(const Scene& scene, uint32_t geometry, uint32_t index);
// The same in the world, as part of an instance of its set.
PlaneTriangle in_world(const Scene& scene, const PlaneTriangle& t, uint32_t instance);

// The distance up to which triangles are in the same place.
double same_place(const PlaneTriangle& a, const PlaneTriangle& b);
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

// A box that is wider than what it holds by what counts as the same place.
struct PlaceBox {
    glm::vec3 low, high;
    explicit PlaceBox(const PlaneTriangle& t);
    bool meets(const PlaceBox& other) const;
    void add(const PlaceBox& other);
    void widen(double margin);
};

// Triangles to be found by their place: a tree of boxes.
class TriangleTree {
 public:
    struct Entry {
        PlaceBox box;
        glm::vec3 normal;
        float height, largest, plane_error;  // of the triangle
        uint32_t group, instance, geometry, index;
        // False if their normals differ by so much that they are not in one plane. It is cheap.
        bool may_be_in_one_plane(const PlaneTriangle& t) const;
    };
    static constexpr uint32_t kNoGroup = ~0u;

    void add(const PlaneTriangle& t, uint32_t group);
    void build();  // after the last one
    bool empty() const { return entries_.empty(); }
    size_t size() const { return entries_.size(); }

    // Calls visit(entry) for the triangles whose boxes meet this one, but for those of one group. Stops where it returns false.
    template <typename Visit>
    bool near(const PlaceBox& box, uint32_t skipped_group, const Visit& visit) const {
        return entries_.empty() || near(0, box, skipped_group, visit);
    }

 private:
    struct Node {
        PlaceBox box;
        uint32_t lowest, highest;  // of its groups
        uint32_t first, count;     // entries; count = 0: the children are the next node and `first`
    };
    uint32_t build(size_t first, size_t count);

    template <typename Visit>
    bool near(uint32_t at, const PlaceBox& box, uint32_t skipped, const Visit& visit) const {
        const Node& node = nodes_[at];
        if (!node.box.meets(box) || (node.lowest == skipped && node.highest == skipped)) return true;
        if (node.count == 0) return near(at + 1, box, skipped, visit) && near(node.first, box, skipped, visit);
        for (uint32_t i = node.first; i < node.first + node.count; ++i) {
            const Entry& entry = entries_[i];
            if (entry.group != skipped && entry.box.meets(box) && !visit(entry)) return false;
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
    std::map<uint64_t, std::set<double>> by_cell_;  // distances of planes
    double error_ = 0.0;                            // largest of its triangles'
};

}  // namespace lampyris
