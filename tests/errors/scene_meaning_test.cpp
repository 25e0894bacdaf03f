// Scenes that parse but do not make sense: each error says where it is, what is wrong, and what would have been right.
#include "support/build_text.h"

#include <gtest/gtest.h>

namespace lampyris {
namespace {

// The errors of a world must be exactly one, at that line and column, containing those words.
void expect_error(const std::string& world, int line, int column, const std::vector<std::string>& words) {
    const BuiltText text = build_world(world);
    ASSERT_EQ(text.errors.size(), 1u) << world << "\n" << text.all_errors();
    const std::string& error = text.errors.front();
    EXPECT_TRUE(error.starts_with("test.pbrt:" + std::to_string(line + 3) + ":" + std::to_string(column) + ": error: "))
        << error;
    for (const std::string& word : words)
        EXPECT_NE(error.find(word), std::string::npos) << "no \"" << word << "\" in\n" << error;
}

// The same for features that are known but not simulated; with skip_unsupported, the scene must build.
void expect_unsupported(const std::string& world, const std::vector<std::string>& words) {
    const BuiltText text = build_world(world);
    ASSERT_EQ(text.errors.size(), 1u) << world << "\n" << text.all_errors();
    for (const std::string& word : words)
        EXPECT_NE(text.errors.front().find(word), std::string::npos) << "no \"" << word << "\" in\n"
                                                                     << text.errors.front();
    const BuiltText skipped = build_world(world, true);
    EXPECT_EQ(skipped.all_errors(), "");
    ASSERT_EQ(skipped.unsupported.size(), 1u);
    EXPECT_EQ(skipped.scene().unsupported, skipped.unsupported);
}

const std::string kTriangle =
    "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 2 ]\n";

TEST(SceneMeaning, UnknownNames) {
    expect_error("Shape \"sphre\"", 1, 7, {"unknown shape \"sphre\"", "did you mean \"sphere\"?", "trianglemesh"});
    expect_error("Material \"difuse\"\n" + kTriangle, 1, 10,
                 {"unknown material \"difuse\"", "did you mean \"diffuse\"?"});
    expect_error("LightSource \"pint\"", 1, 13, {"unknown light \"pint\"", "did you mean \"point\"?"});
    expect_error("AreaLightSource \"difuse\"\n" + kTriangle, 1, 17, {"unknown area light", "diffuse"});
}

TEST(SceneMeaning, UnknownParametersAreFatal) {
    expect_error("Shape \"sphere\" \"float radis\" 2", 1, 16,
                 {"\"radis\" is unknown to shape \"sphere\"", "did you mean \"radius\"?", "zmin"});
    expect_error("Material \"dielectric\" \"float ior\" 1.5\n" + kTriangle, 1, 23,
                 {"\"ior\" is unknown to material \"dielectric\"", "eta"});
}

TEST(SceneMeaning, MeshesMustFit) {
    expect_error("Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 3 ]", 1, 75,
                 {"index 3 (number 2", "outside of the 3 vertices", "0 to 2"});
    expect_error("Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 -1 ]", 1, 75,
                 {"index -1"});
    expect_error("Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 ]", 1, 75,
                 {"\"indices\" has 2 numbers", "3 a face"});
    expect_error("Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"point2 uv\" [ 0 0 1 0 ]", 1, 69,
                 {"\"uv\" has 4 numbers for 3 vertices", "6"});
    expect_error("Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 ]", 1, 1, {"needs the parameter \"point3 P\""});
    // A parameter that exists but cannot be read is reported once, and not as missing, too.
    expect_error("Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 ]", 1, 22, {"has 8 numbers", "multiple of 3"});
    expect_error("Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 1 1 0 ] \"integer indices\" [ 0 1 2 ]", 1, 81,
                 {"4 a face"});
    expect_error("Shape \"loopsubdiv\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 1 1 1 ] \"integer indices\" [ 0 1 2 0 1 3 ]", 1,
                 79, {"cannot be subdivided", "both run from vertex 0 to 1"});
    expect_error("Shape \"plymesh\" \"string filename\" \"nowhere.ply\"", 1, 35, {"there is no file", "nowhere.ply"});
}

TEST(SceneMeaning, ValuesMustBeInRange) {
    expect_error("Shape \"sphere\" \"float radius\" -2", 1, 31, {"\"radius\" is -2", "must be above 0"});
    expect_error("Shape \"sphere\" \"float radius\" 1 \"float zmin\" 2 \"float zmax\" 3", 1, 46,
                 {"leave nothing of the sphere"});
    expect_error("Shape \"disk\" \"float innerradius\" 1", 1, 34, {"leaves nothing of the disk"});
    expect_error("Material \"diffuse\" \"rgb reflectance\" [ 0.5 1.5 0.5 ]\n" + kTriangle, 1, 40,
                 {"component 1.5", "between 0 and 1"});
    expect_error(
        "Material \"mix\" \"string materials\" [ \"a\" \"b\" ] \"float amount\" 2\nMakeNamedMaterial \"a\" \"string "
        "type\" \"diffuse\"\nMakeNamedMaterial \"b\" \"string type\" \"diffuse\"\n" +
            kTriangle,
        1, 62, {"\"amount\" is 2", "0 to 1"});
    expect_error("Scale 1 0 1\n" + kTriangle, 2, 1, {"cannot be inverted"});
    expect_error("LightSource \"spot\" \"point3 from\" [ 1 2 3 ] \"point3 to\" [ 1 2 3 ]", 1, 58, {"the same point"});
}

TEST(SceneMeaning, SpectraMustMakeSense) {
    expect_error("Material \"conductor\" \"spectrum eta\" \"metal-Al-ta\"\n" + kTriangle, 1, 37,
                 {"neither a named spectrum nor a file", "did you mean \"metal-Al-eta\"?"});
    expect_error("LightSource \"point\" \"spectrum I\" [ 500 1 400 2 ]", 1, 21,
                 {"wavelengths of \"spectrum I\" do not increase"});
    expect_error("LightSource \"point\" \"float I\" 5", 1, 21,
                 {"\"I\" is of type float", "rgb, blackbody or spectrum"});
    expect_error("LightSource \"point\" \"blackbody I\" -5", 1, 35, {"temperature above 0 K"});
    expect_error("Material \"dielectric\" \"point2 eta\" [ 2 2 ]\n" + kTriangle, 1, 38,
                 {"\"eta\" is of type point2", "float, or spectrum"});
    expect_error("LightSource \"projection\" \"string filename\" \"\"", 1, 44, {"\"filename\" is empty"});
}

TEST(SceneMeaning, MixesRefer) {
    expect_error(
        "MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\nMaterial \"mix\" \"string materials\" [ \"a\" \"c\" ]\n" +
            kTriangle,
        2, 37, {"no material named \"c\""});
    expect_error(
        "MakeNamedMaterial \"a\" \"string type\" \"mix\" \"string materials\" [ \"a\" \"b\" ]\nMakeNamedMaterial \"b\" "
        "\"string type\" \"diffuse\"\nNamedMaterial \"a\"\n" +
            kTriangle,
        1, 64, {"contains itself"});
    expect_error("Material \"mix\" \"string materials\" [ \"a\" ]\n" + kTriangle, 1, 37, {"\"mix\" of 1 materials"});
    expect_error("Material \"mix\"\n" + kTriangle, 1, 1, {"needs the parameter \"string materials\""});
}

TEST(SceneMeaning, WhatIsNotSupportedIsToldAndCanBeSkipped) {
    expect_unsupported("Material \"dielectric\" \"spectrum eta\" \"glass-BK7\"\n" + kTriangle,
                       {"test.pbrt:4:38", "not supported", "dispersion", "1.5168"});
    expect_unsupported("Material \"subsurface\"\n" + kTriangle, {"test.pbrt:4:10", "material \"subsurface\""});
    expect_unsupported("ActiveTransform EndTime\nTranslate 1 0 0\nActiveTransform All\n" + kTriangle,
                       {"test.pbrt:7:1", "motion blur"});
    // pbrt-v4's defaults scatter. Reported once per medium, however often it is used.
    const std::string fog = "MakeNamedMedium \"fog\" \"string type\" ",
                      in_fog = "\nMediumInterface \"fog\" \"\"\n" + kTriangle;
    expect_unsupported(fog + "\"homogeneous\"" + in_fog + kTriangle,
                       {"test.pbrt:4:1", "participating medium \"fog\"", "scatters (\"sigma_s\" is 1)", "[ 0 0 0 ]"});
    expect_unsupported(fog + "\"homogeneous\" \"rgb sigma_s\" [ 0 0 1e-9 ]" + in_fog, {"test.pbrt:4:67", "scatters"});
    expect_unsupported(fog + "\"homogeneous\" \"string preset\" \"Coke\"" + in_fog, {"test.pbrt:4:67", "presets"});
    expect_unsupported(fog + "\"homogeneous\" \"rgb sigma_s\" [ 0 0 0 ] \"rgb Le\" [ 1 0 0 ]" + in_fog,
                       {"test.pbrt:4:86", "emits"});
    expect_unsupported(fog + "\"cloud\"" + in_fog, {"test.pbrt:4:37", "\"fog\"", "\"cloud\"", "only absorb"});
    expect_unsupported("Shape \"curve\" \"point3 P\" [ 0 0 0 1 0 0 2 0 0 3 0 0 ]",
                       {"test.pbrt:4:7", "shape \"curve\""});
    expect_unsupported("LightSource \"infinite\" \"point3 portal\" [ 0 0 0 1 0 0 1 1 0 0 1 0 ]", {"portal"});
}

TEST(SceneMeaning, MediaMustMakeSense) {
    const std::string fog = "MakeNamedMedium \"fog\" \"string type\" ";
    // Reported whether or not the medium contains anything.
    for (const std::string& use : {std::string(), "\nMediumInterface \"fog\" \"\"\n" + kTriangle}) {
        expect_error(fog + "\"homogenous\"" + use, 1, 37, {"unknown medium", "did you mean \"homogeneous\"?"});
        expect_error(fog + "\"homogeneous\" \"rgb sigmaa\" [ 1 1 1 ] \"rgb sigma_s\" [ 0 0 0 ]" + use, 1, 51,
                     {"\"sigmaa\" is unknown to medium \"homogeneous\"", "did you mean \"sigma_a\"?"});
    }
    const std::string in_fog = " \"rgb sigma_s\" [ 0 0 0 ]\nMediumInterface \"fog\" \"\"\n" + kTriangle;
    expect_error(fog + "\"homogeneous\" \"rgb sigma_a\" [ 1 -1 0 ]" + in_fog, 1, 67, {"-1", "at least 0"});
    expect_error(fog + "\"homogeneous\" \"float scale\" 1e20 \"rgb sigma_a\" [ 1 1e20 0 ]" + in_fog, 1, 86,
                 {"not finite"});
}

TEST(SceneMeaning, SeveralErrorsAreToldTogether) {
    const BuiltText text = build_world("Shape \"sphre\"\nShape \"sphere\" \"float radius\" -1\nLightSource \"pint\"\n");
    EXPECT_EQ(text.errors.size(), 3u);
}

TEST(SceneMeaning, FilmsAndCameras) {
    const auto errors = [](const std::string& text) { return build_text(text + "\nWorldBegin\n").all_errors(); };
    EXPECT_NE(errors("Film \"rgb\" \"integer xresolution\" 0")
                  .find("test.pbrt:1:34: error: \"xresolution\" is 0; must be 1 to 32768"),
              std::string::npos);
    EXPECT_NE(errors("Film \"rgb\" \"float cropwindow\" [ 0.5 0.5 0 1 ]").find("not a part of the 1280x720 picture"),
              std::string::npos);
    EXPECT_NE(
        errors("Film \"rgb\" \"integer pixelbounds\" [ 1280 1290 0 4 ]").find("are not a part of the 1280x720 picture"),
        std::string::npos);
    EXPECT_NE(errors("Film \"rgb\" \"float pixelbounds\" [ 0 1 0 1 ]").find("\"pixelbounds\" is of type float"),
              std::string::npos);
    EXPECT_NE(errors("Camera \"perspective\" \"float shutterclose\" 0").find("the shutter closes when it opens"),
              std::string::npos);
    EXPECT_NE(errors("Camera \"relistic\"").find("unknown camera \"relistic\""), std::string::npos);
    EXPECT_NE(errors("Camera \"realistic\"").find("camera \"realistic\" is not supported"), std::string::npos);
    EXPECT_NE(errors("Camera \"perspective\" \"float fov\" 180").find("must be above 0 to 179.9"), std::string::npos);
    EXPECT_NE(errors("Sampler \"random\"").find("unknown sampler \"random\""), std::string::npos);
    EXPECT_NE(errors("PixelFilter \"gausian\"").find("did you mean"), std::string::npos);
    EXPECT_NE(errors("Camera \"perspective\" \"spectrum screenwindow\" [ 400 1 700 2 ]").find("is of type spectrum"),
              std::string::npos);
    EXPECT_NE(errors("Film \"rgb\" \"point2 cropwindow\" [ 0 .5 0 .5 ]").find("is of type point2"), std::string::npos);
}

// If pbrt-v4 continues after an array of the wrong length, or values in the wrong order, so does Lampyris: as if they were
// absent or corrected, and with a warning.
TEST(SceneMeaning, FilmsAndCamerasThatPbrtMakesTheBestOf) {
    struct Case {
        std::string text, meant;
        int column;
        std::string warning;
    };
    const std::string film = "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 20 ",
                      perspective = "Camera \"perspective\" ", orthographic = "Camera \"orthographic\" ";
    const Case cases[] = {
        {perspective + "\"float screenwindow\" [ -0.5 0.5 ]", perspective, 45, "has 2 numbers, not 4"},
        {orthographic + "\"float screenwindow\" [ 1 2 3 4 5 ]", orthographic, 46, "has 5 numbers, not 4"},
        {film + "\"float cropwindow\" [ 0 0.5 ]", film, 83, "has 2 numbers, not 4"},
        {film + "\"float cropwindow\" [ 0.5 0.25 1 0 ]", film + "\"integer pixelbounds\" [ 10 20 0 20 ]", 0, ""},
        {film + "\"integer pixelbounds\" [ 1 2 3 ]", film, 86, "has 3 numbers, not 4"},
        {film + "\"integer pixelbounds\" [ 20 10 0 20 ]", film + "\"float cropwindow\" [ 0.25 0.5 0 1 ]", 0, ""},
        {film + "\"integer pixelbounds\" [ -2147483648 2147483647 5 20 ]", film + "\"float cropwindow\" [ 0 1 0.25 1 ]",
         86, "reach out of the 40x20 picture"},
        {film + "\"integer pixelbounds\" [ 0 1 0 1 ] \"float cropwindow\" [ 0.25 0.5 0 1 ]",
         film + "\"float cropwindow\" [ 0.25 0.5 0 1 ]", 117, "the crop window is used"},
        {perspective + "\"float shutteropen\" 0.75 \"float shutterclose\" 0.5",
         perspective + "\"float shutteropen\" 0.5 \"float shutterclose\" 0.75", 68, "the two are swapped"},
    };
    for (const Case& c : cases) {
        const BuiltText text = build_text(c.text + "\nWorldBegin\n"), meant = build_text(c.meant + "\nWorldBegin\n");
        EXPECT_EQ(text.all_errors() + meant.all_errors(), "") << c.text;
        EXPECT_TRUE(meant.warnings.empty()) << c.meant;
        EXPECT_EQ(text.scene().hash, meant.scene().hash) << c.text;
        EXPECT_EQ(text.built.settings.crop, meant.built.settings.crop) << c.text;
        ASSERT_EQ(text.warnings.size(), c.warning.empty() ? 0u : 1u) << c.text;
        if (c.warning.empty()) continue;
        const std::string place = "test.pbrt:1:" + std::to_string(c.column) + ": warning: ";
        EXPECT_TRUE(text.warnings[0].starts_with(place)) << text.warnings[0];
        EXPECT_NE(text.warnings[0].find(c.warning), std::string::npos) << text.warnings[0];
    }
}

}  // namespace
}  // namespace lampyris
