// Warnings of surfaces in the same place.
#include "support/build_text.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

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

TEST(Touching, TakesLinearTime) {
    // Two plane meshes of 20,000 triangles in one plane: of their pairs, only so many are looked at.
    std::string points, indices;
    for (int i = 0; i <= 100; ++i)
        for (int k = 0; k <= 100; ++k) points += fmt::format(" {} {} 0", i, k);
    for (int i = 0; i < 100; ++i)
        for (int k = 0; k < 100; ++k) {
            const int a = 101 * i + k;
            indices += fmt::format(" {} {} {} {} {} {}", a, a + 1, a + 101, a + 1, a + 102, a + 101);
        }
    const std::string mesh =
        "Shape \"trianglemesh\" \"point3 P\" [" + points + " ] \"integer indices\" [" + indices + " ]\n";
    EXPECT_EQ(warnings_of("Material \"dielectric\"\n" + mesh + "Translate 1000 0 0\n" + mesh), 0u);
    EXPECT_EQ(warnings_of("Material \"dielectric\"\n" + mesh + mesh), 1u);
}

}  // namespace
}  // namespace lampyris
