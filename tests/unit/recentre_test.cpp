#include "core/scene/recentre.h"

#include "support/build_text.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace lampyris {
namespace {

constexpr const char* kFilm = "Film \"rgb\" \"integer xresolution\" 4 \"integer yresolution\" 4\n";

// A scene of everything that has a position in the world, moved by x along each axis.
BuiltText moved(double x, const std::string& more = {}) {
    return build_text(
        fmt::format("LookAt {0} {0} {1}  {0} {0} {0}  0 1 0\nCamera \"perspective\"\n{2}WorldBegin\n"
                    "ObjectBegin \"o\"\nShape \"sphere\" \"float radius\" 0.3\nObjectEnd\n"
                    "Translate {0} {0} {0}\n"
                    "Texture \"t\" \"spectrum\" \"checkerboard\" \"string mapping\" \"planar\"\n"
                    "LightSource \"point\" \"point3 from\" [ 0.1 0.9 0.2 ]\n"
                    "Material \"diffuse\" \"texture reflectance\" \"t\"\n"
                    "Shape \"trianglemesh\" \"point3 P\" [ -1 0 -1 .3 0 1.1 1 0 -1 ] \"integer indices\" [ 0 1 2 ]\n"
                    "Shape \"sphere\" \"float radius\" 0.7\n"
                    "AttributeBegin Translate .1 .2 .3 ObjectInstance \"o\" AttributeEnd\n{3}",
                    x, x + 4, kFilm, more));
}

TEST(Recentre, AScenesPlaceIsNotRounded) {
    const BuiltText here = moved(0), there = moved(1048576);
    ASSERT_EQ(there.all_errors(), "");
    EXPECT_EQ(here.scene().positions, there.scene().positions);
    EXPECT_EQ(here.scene().record.bounds, there.scene().record.bounds);
    ASSERT_EQ(here.scene().transforms.size(), there.scene().transforms.size());
    for (size_t i = 0; i < here.scene().transforms.size(); ++i)
        EXPECT_EQ(here.scene().transforms[i].to1, there.scene().transforms[i].to1);
    EXPECT_EQ(here.scene().instances[1].transform.to0, there.scene().instances[1].transform.to0);
    EXPECT_EQ(here.scene().lights[0].p0, there.scene().lights[0].p0);
    for (size_t i = 0; i < here.scene().texture_ops.size(); ++i)
        EXPECT_EQ(here.scene().texture_ops[i].m0, there.scene().texture_ops[i].m0);
    // The camera's transform is an inverse, which doubles round at 1e6.
    EXPECT_NEAR(there.scene().record.camera.to2.w, 4.0f, 1e-6f);
    EXPECT_NEAR(there.scene().record.camera.to0.w, 0.0f, 1e-6f);
}

TEST(Recentre, OrdinaryScenesStayWhereTheyAre) {
    // 16 and more sizes away, a factor of 4 below the limit.
    const BuiltText built = moved(32);
    EXPECT_EQ(built.scene().record.camera.to0.w, 32.0f);
    EXPECT_EQ(built.scene().positions[0], 31.0f);
    // With a floor that reaches to the origin the scene is not far out.
    const BuiltText wide = moved(1024, "Shape \"disk\" \"float radius\" 2000\n");
    EXPECT_EQ(wide.scene().positions[0], 1023.0f);
}

TEST(Recentre, VerticesThatAreFarOutThemselvesCountToo) {
    const auto triangle = [](int x) {
        return build_text(
            fmt::format("Translate {} 0 0\nCamera \"perspective\"\n{}WorldBegin\nShape \"trianglemesh\" \"point3 P\" [ "
                        "{} 0 0 {} 0 0 {} 1 0 ] \"integer indices\" [ 0 1 2 ]\n",
                        -x, kFilm, x, x + 1, x));
    };
    const BuiltText far = triangle(4096);
    EXPECT_LE(std::abs(far.scene().positions[0]), 1.0f);
    EXPECT_EQ(far.scene().positions[3] - far.scene().positions[0], 1.0f);
    EXPECT_EQ(far.scene().record.camera.to0.w, far.scene().positions[0]);
}

TEST(Recentre, WhatIsOutOfTheWorldIsRefusedAsBefore) {
    EXPECT_NE(moved(1e20).all_errors().find("farther out than"), std::string::npos);
}

}  // namespace
}  // namespace lampyris
