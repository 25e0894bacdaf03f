// Faces of a mesh that are moved to the inside of its bodies.
#pragma once

#include "core/scene/mesh_bodies.h"
#include "core/scene/touching_planes.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace lampyris {

class Inset {
 public:
    Inset(const Scene& scene, uint32_t geometry) : scene_(scene), geometry_(geometry) {}

    // Which triangles bound one body; found when it is first asked for.
    const MeshBodies& bodies();
    // The face in which t lies is to be moved by the gap: that of its own body, or those of all bodies in the same plane.
    void add(const PlaneTriangle& t, double gap, bool of_its_body);
    // Whether the face has a gap as large as that.
    bool has(const PlaneTriangle& t, double gap);

    void apply(Scene& scene);

 private:
    static constexpr uint32_t kAllBodies = ~0u;

    // Normals of the faces at one place that are moved, and of the others.
    struct Faces {
        std::vector<glm::dvec3> moved, others;
    };

    bool moves(const PlaneTriangle& t);
    glm::dvec3 displacement(const Faces& faces) const;

    const Scene& scene_;
    uint32_t geometry_;
    std::optional<MeshBodies> bodies_;
    std::map<uint32_t, PlaneSet> planes_;  // by body
    double gap_ = 0.0;                     // of all its faces
};

}  // namespace lampyris
