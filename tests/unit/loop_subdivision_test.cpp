#include "core/scene/shapes/loop_subdivision.h"

#include <glm/glm.hpp>
#include <gtest/gtest.h>

namespace lampyris {
namespace {

using Face = std::array<uint32_t, 3>;

// An octahedron: all vertices have four neighbours, so every level and the limit keep its symmetry.
const std::vector<glm::vec3> kOctahedron = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
const std::vector<Face> kFaces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                  {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};

TEST(LoopSubdivision, EulerCountsOfAClosedSurface) {
    for (int levels = 0; levels < 4; ++levels) {
        const SubdividedMesh mesh = loop_subdivide(kOctahedron, kFaces, levels);
        ASSERT_EQ(mesh.error, "");
        EXPECT_EQ(mesh.faces.size(), size_t(8) << (2 * levels));
        EXPECT_EQ(mesh.positions.size(), mesh.faces.size() / 2 + 2);  // V - E + F = 2 with E = 3 F / 2
    }
}

// The limit position of a vertex does not depend on how often the mesh was subdivided before.
TEST(LoopSubdivision, LimitPositionsDoNotDependOnTheLevel) {
    const SubdividedMesh first = loop_subdivide(kOctahedron, kFaces, 0), later = loop_subdivide(kOctahedron, kFaces, 4);
    for (size_t i = 0; i < kOctahedron.size(); ++i)
        EXPECT_LT(glm::length(first.positions[i] - later.positions[i]), 1e-5f) << i;
    // At valence 4 the limit is (1 - 4 g) v + g (sum of the ring), g = 1 / (4 + 3 / (8 b)), b = 3 / 32; the ring sums to 0.
    EXPECT_NEAR(first.positions[0].x, 1.0f - 4.0f / 8.0f, 1e-6f);
}

// The normals lie on the axes, on the side that pbrt-v4 chooses: opposite to the outside of counter-clockwise faces.
TEST(LoopSubdivision, NormalsAreTheLimitSurfaces) {
    const SubdividedMesh mesh = loop_subdivide(kOctahedron, kFaces, 2);
    for (size_t i = 0; i < kOctahedron.size(); ++i)
        EXPECT_GT(glm::dot(glm::normalize(mesh.normals[i]), -kOctahedron[i]), 0.9999f) << i;
}

TEST(LoopSubdivision, FlatSheetsStayFlatAndKeepTheirBoundary) {
    const SubdividedMesh mesh = loop_subdivide({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, 3);
    ASSERT_EQ(mesh.error, "");
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
        EXPECT_EQ(mesh.positions[i].z, 0.0f);
        EXPECT_LT(glm::normalize(mesh.normals[i]).z, -0.9999f);
        EXPECT_TRUE(mesh.positions[i].x >= 0.0f && mesh.positions[i].x <= 1.0f);
    }
}

// On a boundary, the limit is (1 - 2 g) v + g (both neighbours on the boundary) with g = 1/5, as in pbrt-v4.
TEST(LoopSubdivision, BoundariesHavePbrtsLimit) {
    const SubdividedMesh mesh = loop_subdivide({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, 0);
    ASSERT_EQ(mesh.error, "");
    EXPECT_LT(glm::length(mesh.positions[0] - glm::vec3(0.2f, 0.2f, 0.0f)), 1e-6f);
    EXPECT_LT(glm::length(mesh.positions[2] - glm::vec3(0.8f, 0.8f, 0.0f)), 1e-6f);
}

TEST(LoopSubdivision, BrokenMeshesAreTold) {
    EXPECT_NE(loop_subdivide({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 1}}, 1).error.find("twice"), std::string::npos);
    EXPECT_NE(loop_subdivide({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}, {0, 1, 3}}, 1)
                  .error.find("both run from"),
              std::string::npos);
    // Two fans that meet in one vertex: strange, but no crash.
    EXPECT_EQ(
        loop_subdivide({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}, 2).error, "");
}

}  // namespace
}  // namespace lampyris
