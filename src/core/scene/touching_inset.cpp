#include "core/scene/touching_inset.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <utility>

namespace lampyris {

using glm::dvec3;

const MeshBodies& Inset::bodies() {
    if (!bodies_) bodies_ = bodies_of_mesh(scene_, geometry_);
    return *bodies_;
}

void Inset::add(const PlaneTriangle& t, double gap, bool of_its_body) {
    planes_[of_its_body ? bodies().of_triangle[t.index] : kAllBodies].add(t);
    gap_ = std::max(gap_, gap);
}

bool Inset::moves(const PlaneTriangle& t) {
    const auto all = planes_.find(kAllBodies);
    if (all != planes_.end() && all->second.contains(t)) return true;
    if (planes_.size() == (all != planes_.end() ? 1u : 0u)) return false;
    const auto own = planes_.find(bodies().of_triangle[t.index]);
    return own != planes_.end() && own->second.contains(t);
}

bool Inset::has(const PlaneTriangle& t, double gap) { return gap <= gap_ && moves(t); }

void Inset::apply(Scene& scene) {
    // A vertex lies at the same place as others of its body, which belong to other faces; those of another body may lie there, too.
    using Place = std::pair<std::array<float, 3>, uint32_t>;
    const uint32_t count = plane_triangle_count(scene.geometries[geometry_]);
    const auto position = [&scene](size_t v) {
        const float* p = &scene.positions[3 * v];
        return std::array<float, 3>{p[0], p[1], p[2]};
    };
    std::map<Place, std::vector<dvec3>> normals;  // of the faces to be moved
    for (uint32_t i = 0; i < count; ++i) {
        const PlaneTriangle t = plane_triangle(scene, geometry_, i);
        if (t.normal == dvec3(0.0) || !moves(t)) continue;
        for (const size_t v : t.vertices) normals[{position(v), bodies().of_triangle[i]}].push_back(t.normal);
    }
    std::map<size_t, Place> places;  // of vertices
    for (uint32_t i = 0; i < count; ++i) {
        const PlaneTriangle t = plane_triangle(scene, geometry_, i);
        for (const size_t v : t.vertices) {
            Place place{position(v), bodies().of_triangle[i]};
            if (t.normal == dvec3(0.0)) {  // it belongs to no body: any that is there
                const auto any = normals.lower_bound({place.first, 0u});
                if (any == normals.end() || any->first.first != place.first) continue;
                place.second = any->first.second;
            }
            places.try_emplace(v, place);
        }
    }
    for (const auto& [v, place] : places) {
        const auto found = normals.find(place);
        if (found == normals.end()) continue;
        const dvec3 by = displacement(found->second);
        for (size_t axis = 0; axis < 3; ++axis) {
            float& x = scene.positions[3 * v + axis];
            x = float(double(x) + by[int(axis)]);
        }
    }
}

// The vertex lies on all of these faces, and goes below each by the gap (projections onto half-spaces in turns).
dvec3 Inset::displacement(const std::vector<dvec3>& normals) const {
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

}  // namespace lampyris
