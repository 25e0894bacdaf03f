// Warnings of surfaces in the same place.
#include "support/build_text.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <ctime>
#include <string>

namespace lampyris {
namespace {

// A box from (0, 0, 0) to (1, 1, 1).
const std::string kBox =
    "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1 ] \"integer indices\" "
    "[ 0 2 1 0 3 2  4 5 6 4 6 7  0 1 5 0 5 4  1 2 6 1 6 5  2 3 7 2 7 6  3 0 4 3 4 7 ]\n";

std::string moved(const std::string& by, const std::string& material) {
    return "AttributeBegin Translate " + by + " Material " + material + "\n" + kBox + "AttributeEnd\n";
}

size_t warnings_of(const std::string& world) {
    const BuiltText built = build_world(world);
    EXPECT_EQ(built.all_errors(), "");
    return built.warnings.size();
}

TEST(Touching, IsToldWithBothPlaces) {
    const BuiltText built = build_world(moved("0 0 0", "\"dielectric\"") + moved("0.25 1 0.25", "\"dielectric\""));
    ASSERT_EQ(built.warnings.size(), 1u);
    EXPECT_TRUE(built.warnings[0].starts_with("test.pbrt:8:1: warning: a surface of this shape")) << built.warnings[0];
    EXPECT_NE(built.warnings[0].find("test.pbrt:5:1"), std::string::npos) << built.warnings[0];
}

TEST(Touching, ConcernsWhatLetsLightPass) {
    for (const char* material : {"\"dielectric\"", "\"thindielectric\"", "\"diffusetransmission\"", "\"interface\""})
        EXPECT_EQ(warnings_of(moved("0 0 0", "\"diffuse\"") + moved("0 1 0", material)), 1u) << material;
    EXPECT_EQ(warnings_of(moved("0 0 0", "\"diffuse\"") + moved("0 1 0", "\"conductor\"")), 0u);
    EXPECT_EQ(
        warnings_of("MakeNamedMaterial \"g\" \"string type\" \"dielectric\"\nMakeNamedMaterial \"d\" \"string type\" "
                    "\"diffuse\"\n" +
                    moved("0 0 0", "\"diffuse\"") + moved("0 0 1", "\"mix\" \"string materials\" [ \"d\" \"g\" ]")),
        1u);
    EXPECT_EQ(warnings_of("Shape \"trianglemesh\" \"float alpha\" 0.5 \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ]\n"
                          "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ]\n"),
              1u);
}

TEST(Touching, IsNotSharingAnEdgeNorAGap) {
    const std::string glass = "\"dielectric\"";
    EXPECT_EQ(warnings_of(moved("0 0 0", glass) + moved("0 1 1", glass)), 0u);            // an edge in common
    EXPECT_EQ(warnings_of(moved("0 0 0", glass) + moved("3 1 0", glass)), 0u);            // one plane, apart
    EXPECT_EQ(warnings_of(moved("0 0 0", glass) + moved("0 1.000002 0", glass)), 0u);     // a gap
    EXPECT_EQ(warnings_of(moved("0 0 0", glass) + moved("0.5 0.5 0.5", glass)), 0u);      // they overlap
    EXPECT_EQ(warnings_of(moved("0 0.3 0", glass) + moved("0 1.3000001 0", glass)), 1u);  // moved by rounding
}

TEST(Touching, IsFoundInTurnedScenes) {
    int found = 0;
    for (int i = 0; i < 50; ++i)
        found += int(warnings_of(fmt::format("Translate {0} 3 {0}\nRotate {1} 1 2 {0}\nScale 3 3 3\n", i, 7 * i) +
                                 moved("0 0 0", "\"dielectric\"") + moved("0.3 1 0.2", "\"dielectric\"")));
    EXPECT_GE(found, 40);  // in some, the border of a step lies in between (touching.cpp)
}

TEST(Touching, ConcernsPatchesAndEqualQuadrics) {
    const std::string patch = "Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 1 1 0 ]\n";
    const std::string triangle = "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ]\n";
    const std::string glass = "Material \"dielectric\"\n";
    EXPECT_EQ(warnings_of(glass + patch + patch), 1u);
    EXPECT_EQ(warnings_of(glass + patch + triangle), 1u);
    EXPECT_EQ(warnings_of(glass + patch + "Translate 0 1 0\n" + patch), 0u);
    for (const std::string shape : {"\"sphere\"", "\"disk\"", "\"cylinder\""}) {
        EXPECT_EQ(warnings_of("Shape " + shape + "\nShape " + shape + "\n"), 0u);
        EXPECT_EQ(warnings_of("Shape " + shape + "\n" + glass + "Shape " + shape + "\n"), 1u) << shape;
        EXPECT_EQ(warnings_of(glass + "Shape " + shape + "\nTranslate 0 0 3\nShape " + shape + "\n"), 0u) << shape;
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

// Each of these has 4 * 10^8 pairs or more in one plane, and would take minutes: of a mesh with itself, none is looked at, and of
// two meshes only so many.
TEST(Touching, TakesNoTimeForManyTrianglesInAPlane) {
    const std::string glass = "Material \"dielectric\"\n";
    const std::clock_t before = std::clock();
    EXPECT_EQ(warnings_of(glass + grid(300) + moved("0 0 1", "\"diffuse\"")), 0u);
    EXPECT_EQ(warnings_of(glass + grid(100) + "Translate 1000 0 0\n" + grid(100)), 0u);
    EXPECT_EQ(warnings_of(glass + grid(100) + grid(100)), 1u);
    EXPECT_LT(double(std::clock() - before) / CLOCKS_PER_SEC, 10.0);
}

}  // namespace
}  // namespace lampyris
