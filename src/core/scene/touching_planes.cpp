#include "core/scene/touching_planes.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>

namespace lampyris {

using glm::dvec2;
using glm::dvec3;

namespace {

// Of a patch, the triangles on either side of a diagonal.
constexpr std::array<std::array<uint32_t, 3>, 2> kHalves{{{0, 1, 3}, {0, 3, 2}}};

// Cells of directions are this wide, and normals are known this well.
constexpr double kCell = 1e-3, kNormalError = 1e-4;
// Coordinates and what is computed of them, in parts of the largest.
constexpr double kRounding = 4e-7;
// Six roundings.
constexpr double kGamma6 = 6.0 * 0x1p-24;
// Slivers may be turned by more, and are missed.
constexpr double kMostTurned = 1e-3;

uint64_t hash_of(const std::array<int64_t, 3>& cell) {
    uint64_t hash = 0xcbf29ce484222325ull;
    for (const int64_t x : cell) hash = (hash ^ uint64_t(x)) * 0x100000001b3ull, hash ^= hash >> 29;
    return hash;
}

dvec3 vector_at(const std::vector<float>& all, size_t index) {
    return {all[3 * index], all[3 * index + 1], all[3 * index + 2]};
}

dvec3 transformed(const kernel::TransformRecord& t, const dvec3& p) {
    const glm::dvec4 point(p, 1.0);
    return {glm::dot(glm::dvec4(t.to0), point), glm::dot(glm::dvec4(t.to1), point), glm::dot(glm::dvec4(t.to2), point)};
}

// A disk is a ring of so many quadrangles, whose corners lie on its circles.
constexpr uint32_t kDiskParts = 64;

// Corners of a disk's triangle, about its axis.
std::array<dvec3, 3> disk_corners(const kernel::Quadric& q, uint32_t index) {
    const auto at = [&](uint32_t part, float radius) {
        const double phi = double(q.phi_max) * part / kDiskParts;
        return dvec3(radius * std::cos(phi), radius * std::sin(phi), q.height);
    };
    const uint32_t part = index / 2;
    if (index % 2 == 0) return {at(part, q.inner_radius), at(part, q.radius), at(part + 1, q.radius)};
    return {at(part, q.inner_radius), at(part + 1, q.radius), at(part + 1, q.inner_radius)};
}

// What follows from its corners; its normal is that of their order.
void complete(PlaneTriangle& t) {
    t.largest = 0.0;
    for (const dvec3& p : t.corners)
        for (int axis = 0; axis < 3; ++axis) t.largest = std::max(t.largest, std::abs(p[axis]));
    const dvec3 n = glm::cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]);
    const double length = glm::length(n);
    t.normal = dvec3(0.0);
    if (!(length > 0.0)) return;
    t.normal = n / length;
    double longest = 0.0;
    for (size_t k = 0; k < 3; ++k) longest = std::max(longest, glm::distance(t.corners[k], t.corners[(k + 1) % 3]));
    t.height = length / longest;
    const dvec3 e1 = t.corners[1] - t.corners[0], e2 = t.corners[2] - t.corners[0];
    const dvec3 from = glm::max(glm::abs(e1), glm::abs(e2));
    const dvec3 products =
        glm::abs(dvec3(e1.y * e2.z, e1.z * e2.x, e1.x * e2.y)) + glm::abs(dvec3(e1.z * e2.y, e1.x * e2.z, e1.y * e2.x));
    t.plane_error = kGamma6 * std::min(glm::dot(from, products) / length, 16.0 * (from.x + from.y + from.z));
    // A height that is wrong by the rounding of coordinates turns the plane about the triangle, and the origin may be far away.
    t.distance_error = t.largest * (kSamePlane + std::min(kRounding * t.largest / t.height, kMostTurned));
}

}  // namespace

uint32_t plane_triangle_count(const kernel::GeometryRecord& g) {
    switch (g.kind) {
        case kernel::GEOMETRY_TRIANGLES: return g.primitive_count;
        case kernel::GEOMETRY_BILINEAR: return 2 * g.primitive_count;
        case kernel::GEOMETRY_DISK: return 2 * kDiskParts;
        default: return 0;
    }
}

std::array<size_t, 3> triangle_vertices(const Scene& scene, uint32_t geometry, uint32_t index) {
    const kernel::GeometryRecord& g = scene.geometries[geometry];
    const bool patch = g.kind == kernel::GEOMETRY_BILINEAR;
    std::array<size_t, 3> vertices;
    for (uint32_t k = 0; k < 3; ++k) {
        const size_t corner = patch ? 4 * size_t(index / 2) + kHalves[index % 2][k] : 3 * size_t(index) + k;
        vertices[k] = size_t(g.first_vertex) + scene.indices[g.first_index + corner];
    }
    return vertices;
}

PlaneTriangle plane_triangle(const Scene& scene, uint32_t geometry, uint32_t index) {
    const kernel::GeometryRecord& g = scene.geometries[geometry];
    PlaneTriangle t;
    t.geometry = geometry, t.index = index;
    if (g.kind == kernel::GEOMETRY_DISK) {
        t.corners = disk_corners(g.quadric, index);
        for (dvec3& p : t.corners) p = transformed(scene.transforms[g.transform], p);
        complete(t);
        return t;  // it has no inside
    }
    const bool smooth = g.first_normal != kernel::NONE;
    dvec3 side(0.0);
    t.vertices = triangle_vertices(scene, geometry, index);
    for (size_t k = 0; k < 3; ++k) {
        t.corners[k] = vector_at(scene.positions, t.vertices[k]);
        if (smooth) side += vector_at(scene.normals, g.first_normal + (t.vertices[k] - g.first_vertex));
    }
    complete(t);
    // Kernels turn normals in the same way (triangle_surface, bilinear_fill).
    const bool turn = smooth ? glm::dot(t.normal, side) < 0.0 : (g.flags & kernel::GEOMETRY_FLIP) != 0u;
    if (turn) t.normal = -t.normal;
    return t;
}

PlaneTriangle in_world(const Scene& scene, const PlaneTriangle& t, uint32_t instance) {
    const kernel::TransformRecord& transform = scene.instances[instance].transform;
    PlaneTriangle world = t;
    world.instance = instance;
    for (dvec3& p : world.corners) p = transformed(transform, p);
    complete(world);
    // Normals go by the transposed inverse, and so does their length.
    const dvec3 n =
        t.normal.x * dvec3(transform.from0) + t.normal.y * dvec3(transform.from1) + t.normal.z * dvec3(transform.from2);
    if (glm::dot(world.normal, n) < 0.0) world.normal = -world.normal;
    world.scale = glm::length(n);
    // Rays are rounded in the object's space, too.
    world.largest = std::max(world.largest, t.largest / world.scale);
    world.plane_error = std::max(world.plane_error, t.plane_error / world.scale);
    return world;
}

double same_place(const PlaneTriangle& a, const PlaneTriangle& b) {
    // A ray starts outside of the error of one plane, which its hit has as well, and meets the other one up to its error nearer.
    return kSamePlane * std::max(a.largest, b.largest) + 2.0 * (a.plane_error + b.plane_error);
}

double distance_from_plane(const PlaneTriangle& a, const PlaneTriangle& b) {
    double largest = 0.0;
    for (const dvec3& p : b.corners) largest = std::max(largest, std::abs(glm::dot(p - a.corners[0], a.normal)));
    return largest;
}

bool in_one_plane(const PlaneTriangle& a, const PlaneTriangle& b) {
    return distance_from_plane(a, b) <= same_place(a, b);
}

// No edge's line separates them.
bool overlap(const PlaneTriangle& a, const PlaneTriangle& b) {
    // Of a small face on a large one, the small one's own rounding counts.
    const double error = 1e-5 * std::min(a.largest, b.largest);
    const dvec3 size = glm::abs(a.normal);
    const int dropped = size.x > size.y && size.x > size.z ? 0 : (size.y > size.z ? 1 : 2);
    const auto flat = [&](const dvec3& p) { return dvec2(p[(dropped + 1) % 3], p[(dropped + 2) % 3]); };
    for (const PlaneTriangle* edges : {&a, &b}) {
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

// Normals of surfaces are seldom perpendicular to this direction, where rounding would choose between the two.
Plane::Plane(const PlaneTriangle& t) : normal(t.normal) {
    if (glm::dot(normal, dvec3(0.8713, 0.4331, 0.2317)) < 0.0) normal = -normal;
    distance = glm::dot(t.corners[0], normal);
}

uint64_t Plane::cell() const {
    std::array<int64_t, 3> cell{};
    for (int axis = 0; axis < 3; ++axis) cell[size_t(axis)] = int64_t(std::floor(normal[axis] / kCell + 0.5));
    return hash_of(cell);
}

std::vector<uint64_t> Plane::cells() const {
    std::vector<uint64_t> all;
    for (int corner = 0; corner < 8; ++corner) {
        std::array<int64_t, 3> cell{};
        for (int axis = 0; axis < 3; ++axis) {
            const double moved = normal[axis] + ((corner >> axis & 1) != 0 ? kNormalError : -kNormalError);
            cell[size_t(axis)] = int64_t(std::floor(moved / kCell + 0.5));
        }
        const uint64_t hash = hash_of(cell);
        if (std::find(all.begin(), all.end(), hash) == all.end()) all.push_back(hash);
    }
    return all;
}

PlaceBox::PlaceBox(const PlaneTriangle& t) : low(t.corners[0]), high(t.corners[0]) {
    for (const dvec3& p : t.corners) low = glm::min(low, glm::vec3(p)), high = glm::max(high, glm::vec3(p));
    widen((kSamePlane + kRounding) * t.largest + 2.0 * t.plane_error);
}

void PlaceBox::widen(double margin) { low -= float(margin), high += float(margin); }

bool PlaceBox::meets(const PlaceBox& other) const {
    return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y && other.low.y <= high.y &&
           low.z <= other.high.z && other.low.z <= high.z;
}

void PlaceBox::add(const PlaceBox& other) { low = glm::min(low, other.low), high = glm::max(high, other.high); }

// The corners of the smaller one are that close to the plane of the other one.
bool TriangleTree::Entry::may_be_in_one_plane(const PlaneTriangle& t) const {
    const double distance =
        kSamePlane * std::max(t.largest, double(largest)) + 2.0 * (t.plane_error + double(plane_error));
    const double turned = 4.0 * distance / std::min(t.height, double(height)) + 1e-5;
    return glm::length(glm::cross(t.normal, dvec3(normal))) <= turned;
}

void TriangleTree::add(const PlaneTriangle& t, uint32_t group) {
    entries_.push_back({PlaceBox(t), glm::vec3(t.normal), float(t.height), float(t.largest), float(t.plane_error),
                        group, t.instance, t.geometry, t.index});
}

void TriangleTree::build() {
    nodes_.reserve(entries_.size());
    if (!entries_.empty()) build(0, entries_.size());
}

uint32_t TriangleTree::build(size_t first, size_t count) {
    constexpr size_t kLeaf = 4;
    const auto begin = entries_.begin() + ptrdiff_t(first), end = begin + ptrdiff_t(count);
    Node node{begin->box, begin->group, begin->group, uint32_t(first), uint32_t(count)};
    for (auto entry = begin; entry != end; ++entry) {
        node.box.add(entry->box);
        node.lowest = std::min(node.lowest, entry->group), node.highest = std::max(node.highest, entry->group);
    }
    const uint32_t at = uint32_t(nodes_.size());
    nodes_.push_back(node);
    if (count <= kLeaf) return at;
    const glm::vec3 size = node.box.high - node.box.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const size_t half = count / 2;
    std::nth_element(begin, begin + ptrdiff_t(half), end, [axis](const Entry& a, const Entry& b) {
        return a.box.low[axis] + a.box.high[axis] < b.box.low[axis] + b.box.high[axis];
    });
    nodes_[at].count = 0;
    build(first, half);
    nodes_[at].first = build(first + half, count - half);
    return at;
}

void PlaneSet::add(const PlaneTriangle& t) {
    const Plane plane(t);
    for (const uint64_t cell : plane.cells()) by_cell_[cell].insert(plane.distance);
    error_ = std::max(error_, t.distance_error);
}

bool PlaneSet::contains(const PlaneTriangle& t) const {
    const Plane plane(t);
    const auto found = by_cell_.find(plane.cell());
    if (found == by_cell_.end()) return false;
    const double error = t.distance_error + error_;
    const auto next = found->second.lower_bound(plane.distance - error);
    return next != found->second.end() && *next <= plane.distance + error;
}

}  // namespace lampyris
