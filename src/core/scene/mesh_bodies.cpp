#include "core/scene/mesh_bodies.h"

#include "core/scene/touching_planes.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

namespace lampyris {
namespace {

using glm::dvec3;

// Of an edge that has more triangles, none are paired: that would take too long.
constexpr size_t kMostAtEdge = 100;

// Sets that are united.
class Union {
 public:
    explicit Union(uint32_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0u); }
    uint32_t find(uint32_t i) {
        while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
        return i;
    }
    // The smaller number stays.
    void unite(uint32_t a, uint32_t b) {
        a = find(a), b = find(b);
        parents_[std::max(a, b)] = std::min(a, b);
    }

 private:
    std::vector<uint32_t> parents_;
};

// A triangle's edge. Its triangle lies to the left of the way from the first end to the second one, seen from outside.
struct Edge {
    std::array<uint32_t, 2> ends;  // numbers of positions, the smaller one first
    uint32_t triangle;
    bool backwards;  // from the second end to the first one
    bool operator<(const Edge& other) const { return std::tie(ends, triangle) < std::tie(other.ends, other.triangle); }
};

// Numbers of the corners' positions, which are equal where these are.
std::vector<std::array<uint32_t, 3>> numbered_corners(const Scene& scene, uint32_t geometry, uint32_t count) {
    std::vector<std::tuple<float, float, float, uint32_t>> all;
    all.reserve(3 * size_t(count));
    for (uint32_t i = 0; i < count; ++i) {
        const PlaneTriangle t = plane_triangle(scene, geometry, i);
        for (uint32_t k = 0; k < 3; ++k) all.emplace_back(t.corners[k].x, t.corners[k].y, t.corners[k].z, 3 * i + k);
    }
    std::sort(all.begin(), all.end());
    std::vector<std::array<uint32_t, 3>> numbers(count);
    uint32_t number = 0;
    for (size_t i = 0; i < all.size(); ++i) {
        const auto& [x, y, z, corner] = all[i];
        if (i > 0 &&
            std::tie(x, y, z) != std::tie(std::get<0>(all[i - 1]), std::get<1>(all[i - 1]), std::get<2>(all[i - 1])))
            ++number;
        numbers[corner / 3][corner % 3] = number;
    }
    return numbers;
}

// How far a is turned about the edge that leads along e, through its inside, until it meets b.
double angle_inside(const PlaneTriangle& a, const PlaneTriangle& b, const dvec3& e) {
    constexpr double kCoincident = 1e-4;
    const dvec3 into_a = glm::cross(a.normal, e), into_b = glm::cross(e, b.normal);
    const double angle = std::atan2(-glm::dot(into_b, a.normal), glm::dot(into_b, into_a));
    return angle < kCoincident ? angle + 2.0 * std::numbers::pi : angle;
}

}  // namespace

MeshBodies bodies_of_mesh(const Scene& scene, uint32_t geometry) {
    const uint32_t count = plane_triangle_count(scene.geometries[geometry]);
    const std::vector<std::array<uint32_t, 3>> corners = numbered_corners(scene, geometry, count);
    std::vector<Edge> edges;
    edges.reserve(3 * size_t(count));
    for (uint32_t i = 0; i < count; ++i) {
        const PlaneTriangle t = plane_triangle(scene, geometry, i);
        if (t.normal == dvec3(0.0)) continue;
        const bool turned =
            glm::dot(glm::cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]), t.normal) < 0.0;
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t from = corners[i][k], to = corners[i][(k + 1) % 3];
            edges.push_back({{std::min(from, to), std::max(from, to)}, i, (from > to) != turned});
        }
    }
    std::sort(edges.begin(), edges.end());

    Union bodies(count);
    for (size_t first = 0, end = 0; first < edges.size(); first = end) {
        for (end = first + 1; end < edges.size() && edges[end].ends == edges[first].ends;) ++end;
        if (end - first == 2) bodies.unite(edges[first].triangle, edges[first + 1].triangle);
        if (end - first == 2 || end - first > kMostAtEdge) continue;
        for (size_t i = first; i < end; ++i) {
            const PlaneTriangle t = plane_triangle(scene, geometry, edges[i].triangle);
            std::array<dvec3, 2> ends;
            for (size_t k = 0; k < 3; ++k)
                for (size_t side = 0; side < 2; ++side)
                    if (corners[edges[i].triangle][k] == edges[i].ends[side]) ends[side] = t.corners[k];
            const dvec3 e = glm::normalize(edges[i].backwards ? ends[0] - ends[1] : ends[1] - ends[0]);
            std::pair<double, size_t> nearest{1e30, i};
            for (size_t k = first; k < end; ++k)
                if (edges[k].backwards != edges[i].backwards)
                    nearest =
                        std::min(nearest, {angle_inside(t, plane_triangle(scene, geometry, edges[k].triangle), e), k});
            bodies.unite(edges[i].triangle, edges[nearest.second].triangle);
        }
    }

    MeshBodies result;
    result.of_triangle.resize(count);
    std::vector<std::pair<size_t, uint32_t>> owners;  // vertex and body
    owners.reserve(3 * size_t(count));
    for (uint32_t i = 0; i < count; ++i) {
        const PlaneTriangle t = plane_triangle(scene, geometry, i);
        result.of_triangle[i] = bodies.find(i);
        if (t.normal != dvec3(0.0))
            for (const size_t v : t.vertices) owners.emplace_back(v, result.of_triangle[i]);
    }
    std::sort(owners.begin(), owners.end());
    for (size_t i = 1; i < owners.size(); ++i)
        if (owners[i].first == owners[i - 1].first && owners[i].second != owners[i - 1].second)
            result.share_vertices = true;
    return result;
}

void split_shared_vertices(Scene& scene, uint32_t geometry, const MeshBodies& bodies) {
    if (!bodies.share_vertices) return;
    kernel::GeometryRecord& g = scene.geometries[geometry];
    const uint32_t corners = g.kind == kernel::GEOMETRY_TRIANGLES ? 3 : 4;
    const uint32_t triangles_each = plane_triangle_count(g) / g.primitive_count;
    // The vertices that there will be, by their old numbers: one for each body that has them.
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> numbers;  // of vertex and body
    std::vector<uint32_t> old;
    for (uint32_t i = 0; i < g.primitive_count; ++i)
        for (uint32_t k = 0; k < corners; ++k) {
            uint32_t& index = scene.indices[g.first_index + corners * i + k];
            const auto [known, is_new] =
                numbers.try_emplace({index, bodies.of_triangle[triangles_each * i]}, uint32_t(old.size()));
            if (is_new) old.push_back(index);
            index = known->second;
        }
    const auto append = [&](std::vector<float>& all, uint32_t& first, size_t size) {
        if (first == kernel::NONE) return;
        const size_t from = size * first;
        first = uint32_t(all.size() / size);
        all.reserve(all.size() + size * old.size());
        for (const uint32_t v : old)
            for (size_t c = 0; c < size; ++c) all.push_back(all[from + size * v + c]);
    };
    append(scene.positions, g.first_vertex, 3);
    append(scene.normals, g.first_normal, 3);
    append(scene.uvs, g.first_uv, 2);
}

bool may_have_bodies(const Scene& scene, uint32_t geometry) {
    const kernel::GeometryRecord& g = scene.geometries[geometry];
    const uint32_t count = plane_triangle_count(g);
    size_t highest = g.first_vertex;
    for (uint32_t i = 0; i < count; ++i)
        for (const size_t v : triangle_vertices(scene, geometry, i)) highest = std::max(highest, v);
    const uint32_t vertices = uint32_t(highest - g.first_vertex + 1);

    // Where edges lead to, and their triangles, by the vertex that they come from.
    using End = std::pair<uint32_t, uint32_t>;
    std::vector<uint32_t> first(size_t(vertices) + 1, 0);
    std::vector<End> ends(3 * size_t(count));
    const auto for_each_edge = [&](const auto& visit) {
        for (uint32_t i = 0; i < count; ++i) {
            const std::array<size_t, 3> v = triangle_vertices(scene, geometry, i);
            for (size_t k = 0; k < 3; ++k)
                visit(uint32_t(v[k] - g.first_vertex), uint32_t(v[(k + 1) % 3] - g.first_vertex), i);
        }
    };
    for_each_edge([&](uint32_t from, uint32_t, uint32_t) { ++first[from]; });
    std::exclusive_scan(first.begin(), first.end(), first.begin(), 0u);
    std::vector<uint32_t> next = first;
    for_each_edge([&](uint32_t from, uint32_t to, uint32_t triangle) { ends[next[from]++] = {to, triangle}; });
    for (uint32_t v = 0; v < vertices; ++v) {
        const auto begin = ends.begin() + first[v], end = ends.begin() + first[v + 1];
        std::sort(begin, end);
        const auto same = [](const End& a, const End& b) { return a.first == b.first; };
        if (std::adjacent_find(begin, end, same) != end) return true;
    }
    Union connected(count);
    for_each_edge([&](uint32_t from, uint32_t to, uint32_t triangle) {
        const auto begin = ends.begin() + first[to], end = ends.begin() + first[to + 1];
        const auto back = std::lower_bound(begin, end, End{from, 0u});
        if (back != end && back->first == from) connected.unite(triangle, back->second);
    });
    for (uint32_t i = 1; i < count; ++i)
        if (connected.find(i) != connected.find(0)) return true;
    return false;
}

}  // namespace lampyris
