#include "core/scene/shapes/loop_subdivision.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <cmath>
#include <numbers>
#include <unordered_map>

namespace lampyris {

namespace {

constexpr uint32_t kNoFace = 0xffffffffu;
using Face = std::array<uint32_t, 3>;

// Adjacency: neighbour[3 f + k] is the face across the edge from corner k of f to the next corner.
struct Topology {
    std::vector<uint32_t> neighbour;
    std::vector<uint32_t> first_face;  // one face of each vertex; kNoFace if it has none
    std::string error;
};

uint64_t edge_key(uint32_t from, uint32_t to) { return uint64_t(from) << 32 | to; }

Topology connect(size_t vertices, const std::vector<Face>& faces) {
    Topology topology{std::vector<uint32_t>(3 * faces.size(), kNoFace), std::vector<uint32_t>(vertices, kNoFace), {}};
    std::unordered_map<uint64_t, uint32_t> sides;  // directed edge -> 3 f + k
    sides.reserve(3 * faces.size());
    for (uint32_t f = 0; f < faces.size(); ++f)
        for (uint32_t k = 0; k < 3; ++k) {
            const uint32_t from = faces[f][k], to = faces[f][(k + 1) % 3];
            topology.first_face[from] = f;
            if (from == to) {
                topology.error = fmt::format("face {} has the vertex {} twice", f, from);
                return topology;
            }
            const auto [other, is_new] = sides.emplace(edge_key(from, to), 3 * f + k);
            if (!is_new) {
                topology.error =
                    fmt::format("faces {} and {} both run from vertex {} to {}", other->second / 3, f, from, to);
                return topology;
            }
        }
    for (const auto& [key, side] : sides) {
        const auto across = sides.find(key << 32 | key >> 32);
        if (across != sides.end()) topology.neighbour[side] = across->second / 3;
    }
    return topology;
}

uint32_t corner_of(const Face& face, uint32_t vertex) { return face[0] == vertex ? 0u : face[1] == vertex ? 1u : 2u; }

// The neighbours of a vertex. Those of an interior vertex are in clockwise order. Those of a boundary vertex run
// counter-clockwise from one end of the boundary to the other (seen from the side where the faces are counter-clockwise).
struct Ring {
    std::vector<uint32_t> vertices;
    bool boundary = false;
};

void walk_ring(const std::vector<Face>& faces, const Topology& topology, uint32_t vertex, Ring& ring) {
    ring.vertices.clear();
    ring.boundary = false;
    const uint32_t start = topology.first_face[vertex];
    const auto clockwise = [&](uint32_t f) { return topology.neighbour[3 * f + corner_of(faces[f], vertex)]; };
    const auto counter_clockwise = [&](uint32_t f) {
        return topology.neighbour[3 * f + (corner_of(faces[f], vertex) + 2) % 3];
    };
    uint32_t face = start;
    do {
        ring.vertices.push_back(faces[face][(corner_of(faces[face], vertex) + 1) % 3]);
        const uint32_t next = clockwise(face);
        if (next == kNoFace) {
            ring.boundary = true;
            break;
        }
        face = next;
    } while (face != start);
    if (!ring.boundary) return;
    ring.vertices.assign(1, faces[face][(corner_of(faces[face], vertex) + 1) % 3]);
    while (face != kNoFace) {
        ring.vertices.push_back(faces[face][(corner_of(faces[face], vertex) + 2) % 3]);
        face = counter_clockwise(face);
    }
}

// Warren's weights for the vertices around an interior one (Warren and Weimer 2002, "Subdivision methods for geometric
// design"; used by pbrt, 3rd edition, section 3.8).
float beta(size_t valence) { return valence == 3 ? 3.0f / 16.0f : 3.0f / (8.0f * float(valence)); }

glm::vec3 smoothed(const std::vector<glm::vec3>& p, uint32_t vertex, const Ring& ring, float interior_weight,
                   float boundary_weight) {
    const size_t n = ring.vertices.size();
    if (ring.boundary)
        return (1.0f - 2.0f * boundary_weight) * p[vertex] +
               boundary_weight * (p[ring.vertices.front()] + p[ring.vertices.back()]);
    glm::vec3 sum(0.0f);
    for (const uint32_t other : ring.vertices) sum += p[other];
    return (1.0f - float(n) * interior_weight) * p[vertex] + interior_weight * sum;
}

void subdivide_once(std::vector<glm::vec3>& positions, std::vector<Face>& faces, const Topology& topology) {
    std::vector<glm::vec3> next(positions.size());
    Ring ring;
    for (uint32_t v = 0; v < positions.size(); ++v) {
        if (topology.first_face[v] == kNoFace) {
            next[v] = positions[v];
            continue;
        }
        walk_ring(faces, topology, v, ring);
        next[v] = smoothed(positions, v, ring, beta(ring.vertices.size()), 1.0f / 8.0f);
    }
    // A new vertex on every edge, made by the first of the edge's faces.
    std::vector<uint32_t> middle(3 * faces.size(), kNoFace);
    for (uint32_t f = 0; f < faces.size(); ++f)
        for (uint32_t k = 0; k < 3; ++k) {
            if (middle[3 * f + k] != kNoFace) continue;
            const uint32_t a = faces[f][k], b = faces[f][(k + 1) % 3], across = topology.neighbour[3 * f + k];
            glm::vec3 p = 0.5f * (positions[a] + positions[b]);
            if (across != kNoFace) {
                const uint32_t other = (corner_of(faces[across], a) + 2) % 3;  // in the neighbour, the edge is b -> a
                p = 3.0f / 8.0f * (positions[a] + positions[b]) +
                    1.0f / 8.0f *
                        (positions[faces[f][(k + 2) % 3]] +
                         positions[faces[across][(corner_of(faces[across], a) + 1) % 3]]);
                middle[3 * across + other] = uint32_t(next.size());
            }
            middle[3 * f + k] = uint32_t(next.size());
            next.push_back(p);
        }
    std::vector<Face> smaller;
    smaller.reserve(4 * faces.size());
    for (uint32_t f = 0; f < faces.size(); ++f) {
        const uint32_t m0 = middle[3 * f], m1 = middle[3 * f + 1], m2 = middle[3 * f + 2];
        smaller.push_back({faces[f][0], m0, m2});
        smaller.push_back({m0, faces[f][1], m1});
        smaller.push_back({m2, m1, faces[f][2]});
        smaller.push_back({m0, m1, m2});
    }
    positions = std::move(next);
    faces = std::move(smaller);
}

// Two tangents of the limit surface at a vertex (Hoppe et al. 1994, "Piecewise smooth surface reconstruction").
glm::vec3 limit_normal(const std::vector<glm::vec3>& p, uint32_t vertex, const Ring& ring) {
    const size_t n = ring.vertices.size();
    const auto at = [&](size_t i) { return p[ring.vertices[i]]; };
    glm::vec3 s(0.0f), t(0.0f);
    if (!ring.boundary) {
        for (size_t j = 0; j < n; ++j) {
            const float angle = 2.0f * std::numbers::pi_v<float> * float(j) / float(n);
            s += std::cos(angle) * at(j);
            t += std::sin(angle) * at(j);
        }
        return glm::cross(s, t);
    }
    s = at(n - 1) - at(0);
    if (n == 2) {
        t = at(0) + at(1) - 2.0f * p[vertex];
    } else if (n == 3) {
        t = at(1) - p[vertex];
    } else if (n == 4) {
        t = -at(0) + 2.0f * at(1) + 2.0f * at(2) - at(3) - 2.0f * p[vertex];
    } else {
        const float theta = std::numbers::pi_v<float> / float(n - 1);
        t = std::sin(theta) * (at(0) + at(n - 1));
        for (size_t k = 1; k + 1 < n; ++k) t += (2.0f * std::cos(theta) - 2.0f) * std::sin(float(k) * theta) * at(k);
        t = -t;
    }
    return glm::cross(s, t);
}

}  // namespace

SubdividedMesh loop_subdivide(std::vector<glm::vec3> positions, std::vector<Face> faces, int levels) {
    SubdividedMesh result;
    Topology topology = connect(positions.size(), faces);
    for (int level = 0; level < levels && topology.error.empty(); ++level) {
        subdivide_once(positions, faces, topology);
        topology = connect(positions.size(), faces);
    }
    result.error = topology.error;
    if (!result.error.empty()) return result;
    result.positions.resize(positions.size());
    Ring ring;
    for (uint32_t v = 0; v < positions.size(); ++v) {
        if (topology.first_face[v] == kNoFace) {
            result.positions[v] = positions[v];
            continue;
        }
        walk_ring(faces, topology, v, ring);
        const size_t n = ring.vertices.size();
        result.positions[v] = smoothed(positions, v, ring, 1.0f / (float(n) + 3.0f / (8.0f * beta(n))), 1.0f / 5.0f);
    }
    result.normals.resize(positions.size(), glm::vec3(0.0f, 0.0f, 1.0f));
    for (uint32_t v = 0; v < positions.size(); ++v) {
        if (topology.first_face[v] == kNoFace) continue;
        walk_ring(faces, topology, v, ring);
        result.normals[v] = limit_normal(result.positions, v, ring);
    }
    result.faces = std::move(faces);
    return result;
}

}  // namespace lampyris
