// Surfaces in the same place: faces that are moved, and warnings.
#include "support/build_text.h"

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <ostream>
#include <string>
#include <vector>

namespace lampyris {
namespace {

// A box from (0, 0, 0) to (1, 1, 1).
const std::string kBox =
    "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1 ] \"integer indices\" "
    "[ 0 2 1 0 3 2  4 5 6 4 6 7  0 1 5 0 5 4  1 2 6 1 6 5  2 3 7 2 7 6  3 0 4 3 4 7 ]\n";

std::string moved(const std::string& by, const std::string& material) {
    return "AttributeBegin Translate " + by + " Material " + material + "\n" + kBox + "AttributeEnd\n";
}

struct Told {
    size_t warnings, moved;
    bool operator==(const Told&) const = default;
};
void PrintTo(const Told& told, std::ostream* out) { *out << told.warnings << " warnings, " << told.moved << " moved"; }

constexpr Told kNothing{0, 0}, kWarned{1, 0}, kMoved{0, 1};

Told told_of(const BuiltText& built) {
    EXPECT_EQ(built.all_errors(), "");
    const std::vector<std::string>& notes = built.scene().notes;
    return {built.warnings.size(), size_t(std::count_if(notes.begin(), notes.end(), [](const std::string& note) {
                return note.find("is moved inwards") != std::string::npos;
            }))};
}

Told told_of(const std::string& world) { return told_of(build_world(world)); }

size_t warnings_of(const std::string& world) { return told_of(world).warnings; }

// The corners of a shape's box.
std::array<glm::vec3, 2> bounds(const BuiltText& built, size_t shape) {
    std::array<glm::vec3, 2> box{glm::vec3(1e30f), glm::vec3(-1e30f)};
    const Scene& scene = built.scene();
    const kernel::GeometryRecord& g = scene.geometries[shape];
    for (uint32_t i = 0; i < 3 * g.primitive_count; ++i) {
        const size_t v = 3 * size_t(g.first_vertex + scene.indices[g.first_index + i]);
        const glm::vec3 p(scene.positions[v], scene.positions[v + 1], scene.positions[v + 2]);
        box[0] = glm::min(box[0], p), box[1] = glm::max(box[1], p);
    }
    return box;
}

const std::string kGlass = "\"dielectric\"", kPane = "\"thindielectric\"", kWood = "\"diffuse\"";

TEST(Touching, IsToldWithBothPlaces) {
    const BuiltText pane = build_world(moved("0 0 0", kWood) + moved("0.25 1 0.25", kPane));
    ASSERT_EQ(told_of(pane), kWarned);
    EXPECT_TRUE(pane.warnings[0].starts_with("test.pbrt:8:1: warning: a surface of this shape")) << pane.warnings[0];
    EXPECT_NE(pane.warnings[0].find("test.pbrt:5:1"), std::string::npos) << pane.warnings[0];
    const BuiltText glass = build_world(moved("0 0 0", kWood) + moved("0.25 1 0.25", kGlass));
    ASSERT_EQ(told_of(glass), kMoved);
    EXPECT_TRUE(
        glass.scene().notes[0].starts_with("test.pbrt:8:1 (Shape): a face lies on one of the shape at test.pbrt:5:1"))
        << glass.scene().notes[0];
}

TEST(Touching, ConcernsWhatLetsLightPass) {
    for (const char* material : {"\"dielectric\"", "\"interface\""})
        EXPECT_EQ(told_of(moved("0 0 0", kWood) + moved("0 1 0", material)), kMoved) << material;
    for (const char* material : {"\"thindielectric\"", "\"diffusetransmission\""})
        EXPECT_EQ(told_of(moved("0 0 0", kWood) + moved("0 1 0", material)), kWarned) << material;
    EXPECT_EQ(told_of(moved("0 0 0", kWood) + moved("0 1 0", "\"conductor\"")), kNothing);
    EXPECT_EQ(told_of("MakeNamedMaterial \"g\" \"string type\" \"dielectric\"\nMakeNamedMaterial \"d\" \"string type\" "
                      "\"diffuse\"\n" +
                      moved("0 0 0", kWood) + moved("0 0 1", "\"mix\" \"string materials\" [ \"d\" \"g\" ]")),
              kWarned);
    EXPECT_EQ(told_of("Shape \"trianglemesh\" \"float alpha\" 0.5 \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ]\n"
                      "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ]\n"),
              kWarned);
}

// Of two bodies the later one, and of a body and something else the body, whichever comes first.
TEST(Touching, MovesTheFaceOfABodyInwards) {
    for (const bool first : {true, false}) {
        const std::string glass = moved("0 1 0", kGlass);
        const BuiltText built = build_world(first ? glass + moved("0 0 0", kWood) : moved("0 0 0", kWood) + glass);
        ASSERT_EQ(told_of(built), kMoved);
        const auto wood = bounds(built, first ? 1 : 0), body = bounds(built, first ? 0 : 1);
        EXPECT_EQ(wood[0], glm::vec3(0.0f));
        EXPECT_EQ(wood[1], glm::vec3(1.0f));
        EXPECT_EQ(body[0], glm::vec3(0.0f, body[0].y, 0.0f));
        EXPECT_EQ(body[1], glm::vec3(1.0f, 2.0f, 1.0f));
        EXPECT_NEAR(body[0].y, 1.0 + 3e-6, 2e-7);  // 3e-6 of the largest coordinate
    }
    const BuiltText two = build_world(moved("0 0 0", kGlass) + moved("0 1 0", kGlass));
    ASSERT_EQ(told_of(two), kMoved);
    EXPECT_EQ(bounds(two, 0)[1], glm::vec3(1.0f));
    EXPECT_GT(bounds(two, 1)[0].y, 1.0000027f);
}

// A body that ends within rounding of where the other begins, or a little inside of it, has the same gap after it.
TEST(Touching, LeavesTheSameGapWhereFacesWereRounded) {
    for (const char* height : {"0.9999992", "0.9999998", "1.0000002", "1.000002"}) {
        const BuiltText built = build_world(moved("0 0 0", kWood) + moved(std::string("0 ") + height + " 0", kGlass));
        ASSERT_EQ(told_of(built), kMoved) << height;
        EXPECT_GT(bounds(built, 1)[0].y, 1.0 + 2.7e-6) << height;
        EXPECT_LT(bounds(built, 1)[0].y, 1.0 + 8e-6) << height;
    }
}

TEST(Touching, MovesAllFacesThatTouch) {
    // In the corner of three walls.
    const BuiltText built =
        build_world(moved("-1 0 0", kWood) + moved("0 -1 0", kWood) + moved("0 0 -1", kWood) + moved("0 0 0", kGlass));
    ASSERT_EQ(told_of(built), (Told{0, 3}));
    const auto body = bounds(built, 3);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(body[0][axis], 3e-6, 1e-7);
    EXPECT_EQ(body[1], glm::vec3(1.0f));
}

TEST(Touching, OnlyWarnsWhereMovingWouldNotBeRight) {
    // The same body twice: nobody knows which one is inside of the other.
    EXPECT_EQ(told_of(moved("0 0 0", kGlass) + moved("0 0 0", kGlass)), kWarned);
    // A lamp's samples are taken on its shape as it was.
    EXPECT_EQ(told_of(moved("0 0 0", kWood) + "AreaLightSource \"diffuse\"\n" + moved("0 1 0", kGlass)), kWarned);
    // As small as that, on a floor so wide that its rounding hides the gap.
    const std::string floor =
        "Material \"diffuse\" Shape \"trianglemesh\" \"point3 P\" [ -1e4 0 -1e4 -1e4 0 1e4 1e4 0 1e4 1e4 0 -1e4 ] "
        "\"integer indices\" [ 0 1 2 0 2 3 ]\n";
    for (const char* size : {"0.001", "0.02", "1"})
        EXPECT_EQ(told_of(floor + "Scale " + size + " " + size + " " + size + "\n" + moved("0.2 0 0.1", kGlass)),
                  kWarned)
            << size;
    // So far out that the gap would be a thirtieth of the body.
    EXPECT_EQ(told_of(moved("0 0 0", kWood) + moved("20000 0 0", kWood) + moved("20000 1 0", kGlass)), kWarned);
}

// Rays are rounded in the world, so that the instance that lies farthest out decides.
TEST(Touching, LeavesAGapForEveryInstance) {
    const BuiltText built = build_world("ObjectBegin \"o\"\n" + moved("0 0 0", kWood) + moved("0 1 0", kGlass) +
                                        "ObjectEnd\nScale 10 10 10\nObjectInstance \"o\"\nTranslate 100 0 0\n"
                                        "ObjectInstance \"o\"\n");
    ASSERT_EQ(told_of(built), kMoved);
    EXPECT_GT(bounds(built, 1)[0].y, 1.0f + 100 * 3e-6f);
    EXPECT_LT(bounds(built, 1)[0].y, 1.0f + 200 * 3e-6f);
}

// Corners and triangles of one box after another, as one mesh; with a vertex for each corner of each triangle, or welded where
// corners coincide.
enum class Vertices { kOfEachBox, kOfEachTriangle, kWelded };
std::string one_mesh(const std::vector<glm::vec3>& boxes, Vertices vertices) {
    constexpr int kCorners[36] = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                  1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};
    std::vector<glm::vec3> points;
    std::string indices;
    for (const glm::vec3& at : boxes) {
        const size_t first = points.size();
        if (vertices == Vertices::kOfEachBox)
            for (int k = 0; k < 8; ++k) points.push_back(at + glm::vec3((k & 1) ^ (k >> 1 & 1), k >> 1 & 1, k >> 2));
        for (const int k : kCorners) {
            const glm::vec3 p = at + glm::vec3((k & 1) ^ (k >> 1 & 1), k >> 1 & 1, k >> 2);
            size_t index = first + size_t(k);
            if (vertices != Vertices::kOfEachBox) {
                index = points.size();
                if (vertices == Vertices::kWelded)
                    index = size_t(std::find(points.begin(), points.end(), p) - points.begin());
                if (index == points.size()) points.push_back(p);
            }
            indices += fmt::format(" {}", index);
        }
    }
    std::string text;
    for (const glm::vec3& p : points) text += fmt::format(" {} {} {}", p.x, p.y, p.z);
    return "Shape \"trianglemesh\" \"point3 P\" [" + text + " ] \"integer indices\" [" + indices + " ]\n";
}

// Heights of a mesh's vertices, without those of its first `skipped` triangles.
std::vector<float> heights(const BuiltText& built, uint32_t skipped) {
    std::vector<float> all;
    const Scene& scene = built.scene();
    const kernel::GeometryRecord& g = scene.geometries[0];
    for (uint32_t i = 3 * skipped; i < 3 * g.primitive_count; ++i)
        all.push_back(scene.positions[3 * size_t(g.first_vertex + scene.indices[g.first_index + i]) + 1]);
    return all;
}

// Boxes from (0, 0, 0) to (1, 1, 1) and from (1, 0, 0) to (2, 0.6, 1.3), with (1, 0, 0) in common.
const std::string welded_at_a_vertex =
    "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1 2 0 0 2 .6 0 1 .6 0 1 0 1.3 "
    "2 0 1.3 2 "
    ".6 1.3 1 .6 1.3 ] \"integer indices\" [ 3 2 1 3 1 0 5 6 7 5 7 4 0 1 5 0 5 4 1 2 6 1 6 5 2 3 7 2 7 6 0 4 7 0 7 3 1 "
    "10 9 1 9 "
    "8 11 12 13 11 13 14 8 12 11 8 11 1 9 13 12 9 12 8 9 10 14 9 14 13 1 11 14 1 14 10 ]\n";

// The later body is moved, as a whole: none of its vertices stays in the plane. The first one keeps its shape.
TEST(Touching, MovesBodiesOfOneMeshApart) {
    const std::string glass = "Material " + kGlass + "\n";
    for (const Vertices vertices : {Vertices::kOfEachBox, Vertices::kOfEachTriangle, Vertices::kWelded})
        for (const glm::vec3 second : {glm::vec3(0, 1, 0), glm::vec3(0.25f, 1, 0.25f), glm::vec3(0.5f, 1, 0)}) {
            const BuiltText built = build_world(glass + one_mesh({glm::vec3(0.0f), second}, vertices));
            ASSERT_EQ(told_of(built), kMoved);
            EXPECT_NE(built.scene().notes[0].find("a face lies on another one of it"), std::string::npos);
            for (const float y : heights(built, 12)) EXPECT_TRUE(y == 2.0f || (y > 1.0000027f && y < 1.0000131f)) << y;
            size_t below = 0;
            for (const float y : heights(built, 0)) below += y == 0.0f || y == 1.0f;
            EXPECT_EQ(below, 36u);
        }
    // Three of them, and one beside.
    EXPECT_EQ(told_of(glass + one_mesh({{0, 0, 0}, {0, 1, 0}, {0, 2, 0}, {5, 0, 0}}, Vertices::kOfEachBox)), kMoved);
    EXPECT_EQ(told_of(glass + one_mesh({{0, 0, 0}, {2, 0, 0}, {0, 1.5f, 0}}, Vertices::kOfEachBox)), kNothing);
    // Edges in common, but no face.
    for (const Vertices vertices : {Vertices::kOfEachBox, Vertices::kOfEachTriangle, Vertices::kWelded})
        EXPECT_EQ(told_of(glass + one_mesh({{0, 0, 0}, {1, 1, 0}}, vertices)), kNothing);
    EXPECT_EQ(told_of(glass + welded_at_a_vertex), kMoved);
    // Of a body that is there twice, nobody knows what is inside.
    EXPECT_EQ(told_of(glass + one_mesh({{0, 0, 0}, {0, 0, 0}}, Vertices::kOfEachBox)), kWarned);
    EXPECT_EQ(told_of("Material " + kWood + "\n" + one_mesh({{0, 0, 0}, {0, 1, 0}}, Vertices::kOfEachBox)), kNothing);
}

TEST(Touching, ConcernsDisks) {
    const std::string disk = "AttributeBegin Rotate -90 1 0 0 Shape \"disk\" \"float radius\" 3 AttributeEnd\n";
    const BuiltText built = build_world("Material " + kWood + "\n" + disk + moved("0 0 0", kGlass));
    ASSERT_EQ(told_of(built), kMoved);
    EXPECT_GT(bounds(built, 1)[0].y, 2.7e-6f);
    EXPECT_EQ(told_of("Material " + kWood + "\n" + disk + moved("0 1e-4 0", kGlass)), kNothing);
    EXPECT_EQ(told_of("Material " + kWood + "\n" + disk + moved("3 0 0", kGlass)), kNothing);
    // A disk of glass is no body.
    EXPECT_EQ(told_of("Material " + kGlass + "\n" + disk + moved("0 -1 0", kWood)), kWarned);
    // Below the hole of a ring, or where a part of a disk is missing.
    const auto part = [&](const std::string& parameters) {
        return "AttributeBegin Rotate -90 1 0 0 Shape \"disk\" \"float radius\" 3 " + parameters + " AttributeEnd\n";
    };
    EXPECT_EQ(told_of(part("\"float innerradius\" 2") + moved("0 0 0", kGlass)), kNothing);
    EXPECT_EQ(told_of(part("\"float innerradius\" 1.2") + moved("0 0 0", kGlass)), kMoved);
    EXPECT_EQ(told_of(part("\"float phimax\" 80") + moved("0.1 0 0.1", kGlass)), kNothing);
    EXPECT_EQ(told_of(part("\"float phimax\" 80") + moved("0.1 0 -1.1", kGlass)), kMoved);
}

// Of instances, the face of the object is moved, by its own lengths.
TEST(Touching, ConcernsInstancesOfDifferentObjects) {
    const std::string cube = "ObjectBegin \"glass\"\n" + moved("0 0 0", kGlass) + "ObjectEnd\n";
    const std::string floor = moved("-5 -1 -5", kWood);
    const std::string wood = "ObjectBegin \"wood\"\n" + moved("0 0 0", kWood) + "ObjectEnd\n";
    const auto instance = [](const std::string& transform, const std::string& name = "glass") {
        return "AttributeBegin " + transform + " ObjectInstance \"" + name + "\" AttributeEnd\n";
    };
    const BuiltText built =
        build_world(cube + "Scale 10 10 10\n" + moved("0 0 0", kWood) + instance("Translate .2 1 .2 Scale .2 .2 .2"));
    ASSERT_EQ(told_of(built), kMoved);
    const auto low = [&](const BuiltText& text) {
        // Objects may come before or after the world's shapes.
        float y = 1e30f;
        for (size_t shape = 0; shape < text.scene().geometries.size(); ++shape)
            if (bounds(text, shape)[0].y != 0.0f) y = std::min(y, bounds(text, shape)[0].y);
        return y;
    };
    EXPECT_GT(low(built), 2.7e-6f * 10 / 2);  // the coordinate is 10, and a length of the object is 2 in the world
    EXPECT_LT(low(built), 6.1e-6f * 12 / 2);
    EXPECT_EQ(told_of(cube + floor + instance("Translate -4.5 0 -4.5")), kMoved);
    EXPECT_EQ(told_of(cube + floor + instance("Translate -4.5 .1 -4.5")), kNothing);
    EXPECT_EQ(told_of(cube + instance("Translate 3 0 0") + instance("Translate 3 1 0")), kMoved);
    EXPECT_EQ(told_of(cube + instance("Translate 3 0 0") + instance("Translate 3 1.1 0")), kNothing);
    EXPECT_EQ(told_of(cube + wood + instance("Translate 3 0 0") + instance("Translate 3 1 0", "wood")), kMoved);
    EXPECT_EQ(told_of(cube + wood + instance("Translate 3 2 0 Scale 1 -1 1", "wood") + instance("Translate 3 2 0")),
              kMoved);
    EXPECT_EQ(told_of(cube + instance("Translate 3 0 0") + instance("Translate 3 0 0")), kWarned);
    EXPECT_EQ(told_of(wood + instance("Translate 3 0 0", "wood") + instance("Translate 3 1 0", "wood")), kNothing);
    // Mirrored instances have their outside where the others have it.
    EXPECT_EQ(told_of(cube + instance("Translate 3 1 0 Scale 1 -1 1") + instance("Translate 3 1 0")), kMoved);
}

TEST(Touching, IsNotSharingAnEdgeNorAGap) {
    EXPECT_EQ(told_of(moved("0 0 0", kGlass) + moved("0 1 1", kGlass)), kNothing);        // an edge in common
    EXPECT_EQ(told_of(moved("0 0 0", kGlass) + moved("3 1 0", kGlass)), kNothing);        // one plane, apart
    EXPECT_EQ(told_of(moved("0 0 0", kGlass) + moved("0 1.00001 0", kGlass)), kNothing);  // a gap
    EXPECT_EQ(told_of(moved("0 0 0", kGlass) + moved("0.5 0.5 0.5", kGlass)), kNothing);  // they overlap
    EXPECT_EQ(told_of(moved("0 0.3 0", kGlass) + moved("0 1.3000001 0", kGlass)), kMoved);
}

TEST(Touching, IsFoundInTurnedScenesAndFarOut) {
    for (int i = 0; i < 50; ++i)
        for (const int far : {1, 30})
            EXPECT_EQ(told_of(fmt::format("Translate {0} 3 {1}\nRotate {2} 1 2 {1}\nScale 3 3 3\n", far * i, i, 7 * i) +
                              moved("0 0 0", kGlass) + moved("0.3 1 0.2", kGlass)),
                      kMoved)
                << i << " " << far;
}

TEST(Touching, ConcernsPatchesAndEqualQuadrics) {
    const std::string patch = "Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 1 1 0 ]\n";
    const std::string triangle = "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ]\n";
    const std::string pane = "Material " + kPane + "\n", glass = "Material " + kGlass + "\n";
    EXPECT_EQ(told_of(pane + patch + patch), kWarned);
    EXPECT_EQ(told_of(pane + patch + triangle), kWarned);
    EXPECT_EQ(told_of(triangle + glass + patch), kMoved);
    EXPECT_EQ(told_of(patch + glass + triangle), kMoved);
    EXPECT_EQ(told_of(glass + patch + "Translate 0 1 0\n" + patch), kNothing);
    for (const std::string shape : {"\"sphere\"", "\"disk\"", "\"cylinder\""}) {
        EXPECT_EQ(told_of("Shape " + shape + "\nShape " + shape + "\n"), kNothing);
        EXPECT_EQ(told_of("Shape " + shape + "\n" + glass + "Shape " + shape + "\n"), kWarned) << shape;
        EXPECT_EQ(told_of(glass + "Shape " + shape + "\nTranslate 0 0 3\nShape " + shape + "\n"), kNothing) << shape;
    }
}

// A plane mesh of 2 n^2 triangles.
std::string grid(int n) {
    std::string points, indices;
    for (int i = 0; i <= n; ++i)
        for (int k = 0; k <= n; ++k) points += fmt::format(" {} {} 0", i, k);
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k) {
            const int a = (n + 1) * i + k, b = a + n + 1;
            indices += fmt::format(" {} {} {} {} {} {}", a, a + 1, b, a + 1, b + 1, b);
        }
    return "Shape \"trianglemesh\" \"point3 P\" [" + points + " ] \"integer indices\" [" + indices + " ]\n";
}

std::string many_instances(int n) {
    std::string all;
    for (int i = 0; i < n; ++i) all += "Translate 0 0 1\nObjectInstance \"o\"\n";
    return all;
}

#ifdef __SANITIZE_ADDRESS__
constexpr double kSeconds = 50.0;  // everything takes several times as long
#else
constexpr double kSeconds = 10.0;
#endif

// Each of these has 4 * 10^8 pairs or more in one plane, and would take minutes: of a mesh with itself, none is looked at, and of
// two meshes only so many.
TEST(Touching, TakesNoTimeForManyTrianglesInAPlane) {
    const std::string glass = "Material " + kGlass + "\n";
    const std::clock_t before = std::clock();
    EXPECT_EQ(warnings_of(glass + grid(300) + moved("0 0 1", "\"diffuse\"")), 0u);
    EXPECT_EQ(told_of("ObjectBegin \"o\"\n" + glass + grid(30) + "ObjectEnd\n" + many_instances(5000)), kNothing);
    EXPECT_EQ(warnings_of(glass + grid(100) + "Translate 1000 0 0\n" + grid(100)), 0u);
    EXPECT_EQ(warnings_of(glass + grid(100) + grid(100)), 1u);
    EXPECT_LT(double(std::clock() - before) / CLOCKS_PER_SEC, kSeconds);
}

// Boxes of glass side by side, so far apart.
std::string boxes(int n, double distance) {
    std::string all;
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k) all += moved(fmt::format("{} {} 0", distance * i, distance * k), kGlass);
    return all;
}

// A fan around one edge: every triangle's box meets all others.
std::string fan(int n) {
    std::string points = "0 0 0 0 0 1", indices;
    for (int i = 0; i < n; ++i) {
        points += fmt::format(" {} {} 0.5", std::cos(6.2831853 * i / n), std::sin(6.2831853 * i / n));
        indices += fmt::format(" 0 1 {}", i + 2);
    }
    return "Shape \"trianglemesh\" \"point3 P\" [" + points + " ] \"integer indices\" [" + indices + " ]\n";
}

// With so many shapes in few planes, comparing each triangle with those of its plane would take minutes.
TEST(Touching, TakesNoTimeForManyShapes) {
    const std::clock_t before = std::clock();
    EXPECT_EQ(told_of(boxes(60, 1.5)), kNothing);
    EXPECT_EQ(told_of(boxes(60, 1.0)), (Told{0, 10}));  // and a line about the others
    EXPECT_EQ(told_of("Material " + kGlass + "\n" + fan(30000)), kNothing);
    EXPECT_LT(double(std::clock() - before) / CLOCKS_PER_SEC, kSeconds);
}

// A ball of glass of 5 cm beside a sphere whose surface is rounded by as much.
TEST(Touching, SmallGlassBesideALargeSphereIsTold) {
    const auto told = [](double radius, double gap, double ball) {
        return warnings_of(
            fmt::format("AttributeBegin Translate 0 0 {} Shape \"sphere\" \"float radius\" {} AttributeEnd\n"
                        "Material \"dielectric\" Translate 0 0 {} Shape \"sphere\" \"float radius\" {}\n",
                        -radius, radius, gap + ball, ball));
    };
    EXPECT_EQ(told(1e5, 0.05, 0.05), 1u);
    EXPECT_EQ(told(5e4, 0.05, 0.05), 1u);
    EXPECT_EQ(told(1e4, 0.05, 0.05), 0u);
    EXPECT_EQ(told(1e5, 1, 0.05), 0u);
    EXPECT_EQ(told(1e5, 0.05, 100), 0u) << "of glass in proportion, next to nothing is missing";
    EXPECT_EQ(told(1, 0, 0.5), 0u);
}

}  // namespace
}  // namespace lampyris
