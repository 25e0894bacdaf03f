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
    if (planes_.size() > planes_.count(kAllBodies)) split_shared_vertices(scene, geometry_, bodies());
    // A vertex lies at the same place as others of its body, which belong to other faces; those of another body may lie there, too.
    using Place = std::pair<std::array<float, 3>, uint32_t>;
    const uint32_t count = plane_triangle_count(scene.geometries[geometry_]);
    const auto position = [&scene](size_t v) {
        const float* p = &scene.positions[3 * v];
        return std::array<float, 3>{p[0], p[1], p[2]};
    };
    std::map<Place, Faces> faces;
    std::vector<bool> moved(count);
    for (uint32_t i = 0; i < count; ++i) {
        const PlaneTriangle t = plane_triangle(scene, geometry_, i);
        moved[i] = t.normal != dvec3(0.0) && moves(t);
        if (!moved[i]) continue;
        for (const size_t v : t.vertices) faces[{position(v), bodies().of_triangle[i]}].moved.push_back(t.normal);
    }
    std::map<size_t, Place> places;  // of vertices
    for (uint32_t i = 0; i < count; ++i) {
        const PlaneTriangle t = plane_triangle(scene, geometry_, i);
        for (const size_t v : t.vertices) {
            Place place{position(v), bodies().of_triangle[i]};
            if (t.normal == dvec3(0.0)) {  // it belongs to no body: any that is there
                const auto any = faces.lower_bound({place.first, 0u});
                if (any == faces.end() || any->first.first != place.first) continue;
                place.second = any->first.second;
            }
            const auto found = faces.find(place);
            if (found == faces.end()) continue;
            places.try_emplace(v, place);
            if (!moved[i] && t.normal != dvec3(0.0)) found->second.others.push_back(t.normal);
        }
    }
    for (const auto& [v, place] : places) {
        const dvec3 by = displacement(faces.at(place));
        for (size_t axis = 0; axis < 3; ++axis) {
            float& x = scene.positions[3 * v + axis];
            x = float(double(x) + by[int(axis)]);
        }
    }
}

// The vertex goes below each face that is moved by the gap, and not above any other one, which would then touch something else
// (projections onto half-spaces in turns).
dvec3 Inset::displacement(const Faces& faces) const {
    constexpr int kRounds = 64;
    constexpr double kMost = 10.0;  // at a sharp tip, the half-spaces meet far away
    dvec3 by(0.0);
    for (int round = 0; round < kRounds; ++round) {
        bool done = true;
        const auto keep = [&](const dvec3& n, double below) {
            const double missing = below + glm::dot(by, n);
            if (missing > 1e-3 * gap_) by -= missing * n, done = false;
        };
        for (const dvec3& n : faces.others) keep(n, 0.0);
        for (const dvec3& n : faces.moved) keep(n, gap_);
        if (done) break;
    }
    const double length = glm::length(by), most = kMost * gap_;
    return length > most ? by * (most / length) : by;
}

}  // namespace lampyris
