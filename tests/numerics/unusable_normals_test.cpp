// Meshes with normals or texture coordinates that are not finite: faces that use them are rendered as those of a mesh without
// them, as pbrt-v4 shades a triangle whose interpolated normal is NaN; all other faces keep theirs. Equal means equal to the
// bit.
#include "support/build_text.h"
#include "support/render.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

namespace lampyris::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

const std::string kView =
    "LookAt 0 0 4  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 40\n"
    "Film \"rgb\" \"integer xresolution\" 12 \"integer yresolution\" 12\nWorldBegin\n"
    "LightSource \"distant\" \"point3 from\" [ 1 2 3 ]\n"
    "Texture \"t\" \"spectrum\" \"checkerboard\" \"float uscale\" 5 \"float vscale\" 5\n"
    "Material \"diffuse\" \"texture reflectance\" \"t\"\n";

// Two triangles side by side that share no vertex; the last two numbers of a vertex are u and v.
struct Vertex {
    float position[3], normal[3], uv[2];
};
using Vertices = std::array<Vertex, 6>;
constexpr Vertices kGood{{{{-1, -1, 0}, {-0.5f, 0, 1}, {0, 0}},
                          {{0, -1, 0}, {0.25f, 0.5f, 1}, {1, 0}},
                          {{0, 1, 0}, {0.5f, 0.5f, 1}, {1, 0.5f}},
                          {{0.25f, -1, 0}, {-0.5f, 0, 1}, {0, 0.25f}},
                          {{1, -1, 0}, {0, 0.5f, 1}, {1, 0}},
                          {{1, 1, 0}, {0.5f, 0, 1}, {1, 1}}}};

class UnusableNormals : public testing::TestWithParam<std::string> {
 protected:
    std::string ply(const Vertices& vertices) const {
        std::ofstream file(folder_ / "mesh.ply", std::ios::binary);
        file << "ply\nformat binary_little_endian 1.0\nelement vertex 6\n";
        for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "u", "v"}) file << "property float " << name << "\n";
        file << "element face 2\nproperty list uint8 int vertex_indices\nend_header\n";
        file.write(reinterpret_cast<const char*>(vertices.data()), sizeof vertices);
        for (const int32_t first : {0, 3}) {
            const int32_t corners[] = {first, first + 1, first + 2};
            file.put(3);
            file.write(reinterpret_cast<const char*>(corners), sizeof corners);
        }
        return kView + "Shape \"plymesh\" \"string filename\" \"mesh.ply\"\n";
    }
    // One of the two triangles as text.
    static std::string triangle(size_t first, bool normals, bool uvs) {
        std::string p, n, uv;
        for (size_t i = first; i < first + 3; ++i) {
            for (const float x : kGood[i].position) p += std::to_string(x) + " ";
            for (const float x : kGood[i].normal) n += std::to_string(x) + " ";
            for (const float x : kGood[i].uv) uv += std::to_string(x) + " ";
        }
        return "Shape \"trianglemesh\" \"point3 P\" [ " + p + "]" + (normals ? " \"normal N\" [ " + n + "]" : "") +
               (uvs ? " \"point2 uv\" [ " + uv + "]" : "") + "\n";
    }
    Rendered render(const std::string& scene) const {
        RenderSettings s;
        s.backend = GetParam();
        s.samples = 4;
        return render_text(scene, s, folder_.string());
    }
    void expect_same(const std::string& a, const std::string& b) const {
        const Rendered left = render(a), right = render(b);
        EXPECT_EQ(left.summary.non_finite, 0u);
        ASSERT_EQ(left.pixels.size(), right.pixels.size());
        for (size_t i = 0; i < left.pixels.size(); ++i)
            ASSERT_EQ(std::memcmp(&left.pixels[i], &right.pixels[i], sizeof left.pixels[i]), 0) << "pixel " << i;
    }
    std::vector<std::string> warnings(const std::string& scene) const {
        return build_text(scene, false, {}, folder_.string()).warnings;
    }
    const TemporaryFolder folder_;
};

TEST_P(UnusableNormals, FacesThatUseThemAreFlat) {
    for (const float bad : {kNan, kInfinity, -kInfinity}) {
        Vertices vertices = kGood;
        vertices[0].normal[0] = bad;
        const std::string scene = ply(vertices);
        expect_same(scene, kView + triangle(3, true, true) + triangle(0, false, true));
        const std::vector<std::string> told = warnings(scene);
        ASSERT_EQ(told.size(), 1u);
        EXPECT_NE(
            told[0].find("test.pbrt:8:35: warning: 1 of the mesh's 6 normals are not finite, the first is that of "
                         "vertex 0: 1 of its 2 triangles are shaded flat"),
            std::string::npos)
            << told[0];
    }
}

TEST_P(UnusableNormals, WhereAllAreTheMeshIsFlat) {
    Vertices vertices = kGood;
    vertices[1].normal[2] = vertices[5].normal[1] = kNan;
    expect_same(ply(vertices), kView + triangle(0, false, true) + triangle(3, false, true));
}

TEST_P(UnusableNormals, TextureCoordinatesAreThoseOfAMeshWithout) {
    Vertices vertices = kGood;
    vertices[4].uv[0] = kNan;
    const std::string scene = ply(vertices);
    expect_same(scene, kView + triangle(0, true, true) + triangle(3, true, false));
    EXPECT_EQ(warnings(scene).size(), 1u);
    vertices[4].normal[0] = kNan;
    const std::string both = ply(vertices);
    expect_same(both, kView + triangle(0, true, true) + triangle(3, false, false));
    EXPECT_EQ(warnings(both).size(), 2u);
}

TEST_P(UnusableNormals, GoodOnesAreNotTouched) {
    const std::string scene = ply(kGood);
    EXPECT_TRUE(warnings(scene).empty());
    expect_same(scene, kView + triangle(0, true, true) + triangle(3, true, true));
}

INSTANTIATE_TEST_SUITE_P(Backends, UnusableNormals, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return info.param == "cpu-bvh2" ? "cpu_bvh2" : info.param; });

}  // namespace
}  // namespace lampyris::test
