// Directives and their results: the graphics state, its snapshots in entities, names, blocks, included files.
#include "core/scene/description.h"
#include "support/temporary_folder.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <filesystem>
#include <fstream>

using namespace lampyris;

namespace {

struct Parsed {
    std::shared_ptr<Sources> sources = std::make_shared<Sources>();
    Diagnostics diagnostics{*sources};
    SceneDescription scene;
    explicit Parsed(const std::string& text, const std::string& directory = "") {
        scene = parse_scene_text("scene.pbrt", text, directory, sources, diagnostics);
    }
};

// The scene of a text that must be right.
SceneDescription parse(const std::string& text, const std::string& directory = "") {
    Parsed parsed(text, directory);
    EXPECT_FALSE(parsed.diagnostics.has_errors()) << parsed.diagnostics.errors()[0];
    return std::move(parsed.scene);
}

glm::vec3 transform_point(const glm::mat4& matrix, const glm::vec3& p) {
    return glm::vec3(matrix * glm::vec4(p, 1.0f));
}

void expect_near(const glm::vec3& a, const glm::vec3& b, float tolerance = 1e-6f) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "component " << i;
}

// The position of the shape's origin under the transforms of `text`.
glm::vec3 placed(const std::string& text, const glm::vec3& p) {
    const SceneDescription scene = parse("WorldBegin\n" + text + "\nShape \"sphere\"");
    return transform_point(scene.shapes.at(0).world_from_object.matrix[0], p);
}

class Folder {
 public:
    void write(const std::string& name, const std::string& text) {
        std::filesystem::create_directories(std::filesystem::path(path(name)).parent_path());
        std::ofstream(path(name), std::ios::binary) << text;
    }
    void write_gzip(const std::string& name, const std::string& text) {
        gzFile file = gzopen(path(name).c_str(), "wb");
        gzwrite(file, text.data(), static_cast<unsigned>(text.size()));
        gzclose(file);
    }
    std::string path(const std::string& name = "") const { return folder_ / name; }

 private:
    test::TemporaryFolder folder_;
};

}  // namespace

TEST(Parser, ReadsEveryDirective) {
    const SceneDescription scene = parse(R"(
Option "disable-pixel-jitter" true
Option "seed" 7
Option "msereferenceimage" "a.exr"
ColorSpace "rec2020"
Scale -1 1 1
LookAt 0 0 5  0 0 0  0 1 0
TransformTimes 0 2
MakeNamedMedium "fog" "string type" "homogeneous"
MediumInterface "" "fog"
Camera "perspective" "float fov" 40
Sampler "halton" "integer pixelsamples" [ 4 ]
Film "rgb" "string filename" "out.exr"
PixelFilter "box"
Integrator "path"
Accelerator "bvh"
WorldBegin
Identity Translate 1 2 3 Rotate 90 0 0 1 Scale 2 2 2
ConcatTransform [ 1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1 ]
CoordinateSystem "here"
Transform [ 1 0 0 0  0 1 0 0  0 0 1 0  5 6 7 1 ]
CoordSysTransform "here"
ActiveTransform EndTime Translate 0 0 1 ActiveTransform StartTime ActiveTransform All
Texture "t" "float" "constant" "float value" 0.5
Texture "t" "spectrum" "constant" "rgb value" [ 1 0 0 ]
MakeNamedMaterial "m" "string type" "diffuse"
NamedMaterial "m"
Material "conductor"
AttributeBegin
  Attribute "shape" "float radius" 2
  ReverseOrientation
  AreaLightSource "diffuse" "rgb L" [ 1 1 1 ]
  Shape "sphere"
AttributeEnd
TransformBegin
TransformEnd
LightSource "point" "rgb I" [ 1 2 3 ]
ObjectBegin "o"
  Shape "disk"
ObjectEnd
ObjectInstance "o"
)");
    EXPECT_EQ(scene.options.parameters.size(), 3u);
    EXPECT_EQ(scene.color_space, "rec2020");
    EXPECT_EQ(scene.transform_end_time, 2.0f);
    EXPECT_EQ(scene.camera.type, "perspective");
    EXPECT_EQ(scene.camera.medium, 0u);
    EXPECT_EQ(scene.sampler.type, "halton");
    EXPECT_EQ(scene.film.type, "rgb");
    EXPECT_EQ(scene.pixel_filter.type, "box");
    EXPECT_EQ(scene.integrator.type, "path");
    EXPECT_EQ(scene.accelerator.type, "bvh");
    ASSERT_EQ(scene.media.size(), 1u);
    EXPECT_EQ(scene.media[0].type, "homogeneous");
    ASSERT_EQ(scene.textures.size(), 2u);
    EXPECT_FALSE(scene.textures[0].is_spectrum);
    EXPECT_TRUE(scene.textures[1].is_spectrum);
    EXPECT_TRUE(scene.textures[0].world_from_texture.animated());
    ASSERT_EQ(scene.materials.size(), 2u);
    EXPECT_EQ(scene.materials[0].name, "m");
    EXPECT_EQ(scene.materials[0].type, "diffuse");
    EXPECT_EQ(scene.materials[1].type, "conductor");
    ASSERT_EQ(scene.shapes.size(), 1u);
    EXPECT_EQ(scene.shapes[0].material, 1u);
    EXPECT_EQ(scene.shapes[0].area_light, 0u);
    EXPECT_EQ(scene.shapes[0].exterior_medium, 0u);
    EXPECT_EQ(scene.shapes[0].interior_medium, kNone);
    EXPECT_TRUE(scene.shapes[0].reverse_orientation);
    EXPECT_TRUE(scene.shapes[0].parameters.has("radius"));
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.lights[0].medium, 0u);
    ASSERT_EQ(scene.objects.size(), 1u);
    EXPECT_EQ(scene.objects[0].shapes.size(), 1u);
    EXPECT_FALSE(scene.objects[0].shapes[0].parameters.has("radius"));
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(scene.instances[0].object, 0u);
}

TEST(Parser, TransformsApplyLastWrittenFirst) {
    expect_near(placed("Translate 1 2 3 Scale 2 3 4", {1, 1, 1}), {3, 5, 7});
    expect_near(placed("Scale 2 3 4 Translate 1 2 3", {1, 1, 1}), {4, 9, 16});
    expect_near(placed("Rotate 90 0 0 1", {1, 0, 0}), {0, 1, 0});
    expect_near(placed("Rotate 90 0 0 7", {1, 0, 0}), {0, 1, 0});  // the axis need not be a unit vector
    expect_near(placed("Rotate 90 1 0 0", {0, 1, 0}), {0, 0, 1});
    expect_near(placed("Rotate 90 0 1 0", {0, 0, 1}), {1, 0, 0});
    expect_near(placed("Rotate 120 1 1 1", {1, 0, 0}), {0, 1, 0});
    expect_near(placed("Translate 9 9 9 Identity", {1, 2, 3}), {1, 2, 3});
}

TEST(Parser, MatricesAreWrittenByColumns) {
    // The translation stands in the last four numbers.
    expect_near(placed("Transform [ 1 0 0 0  0 1 0 0  0 0 1 0  5 6 7 1 ]", {1, 1, 1}), {6, 7, 8});
    // x goes to y: the first column is (0, 1, 0).
    expect_near(placed("Translate 1 0 0 ConcatTransform [ 0 1 0 0  -1 0 0 0  0 0 1 0  0 0 0 1 ]", {2, 0, 0}),
                {1, 2, 0});
}

TEST(Parser, TheCameraLooksAlongZWithXToTheRight) {
    const SceneDescription scene = parse("LookAt 0 1 4  0 1 0  0 1 0\nCamera \"perspective\"\nWorldBegin");
    const glm::mat4& world_from_camera = scene.camera.world_from_camera.matrix[0];
    expect_near(transform_point(world_from_camera, {0, 0, 0}), {0, 1, 4});
    expect_near(transform_point(world_from_camera, {0, 0, 1}), {0, 1, 3});  // forward
    expect_near(transform_point(world_from_camera, {0, 1, 0}), {0, 2, 4});  // up
    // Left-handed: right = up x direction, so the image's right is world -x here.
    expect_near(transform_point(world_from_camera, {1, 0, 0}), {-1, 1, 4});
    EXPECT_LT(std::abs(glm::determinant(world_from_camera) - 1.0f), 1e-6f);
}

// An up vector of any length that leans forward: the axes are unit vectors nevertheless.
TEST(Parser, TheCamerasAxesAreOfUnitLength) {
    const SceneDescription scene = parse("LookAt 5 6 7  5 6 9  0 3 4\nCamera \"perspective\"\nWorldBegin");
    const glm::mat4& world_from_camera = scene.camera.world_from_camera.matrix[0];
    expect_near(transform_point(world_from_camera, {1, 0, 0}), {6, 6, 7});
    expect_near(transform_point(world_from_camera, {0, 1, 0}), {5, 7, 7});
    expect_near(transform_point(world_from_camera, {0, 0, 1}), {5, 6, 8});
}

TEST(Parser, CameraTransformIsTheInverseOfTheCurrentOne) {
    const SceneDescription scene = parse(R"(Translate 0 0 10 Scale 2 2 2 Camera "perspective" WorldBegin
CoordSysTransform "camera" Shape "sphere"
CoordSysTransform "world" Shape "sphere")");
    expect_near(transform_point(scene.camera.world_from_camera.matrix[0], {0, 0, 0}), {0, 0, -5});
    // "camera" names camera space: a shape in it moves with the camera. The world starts with the identity.
    expect_near(transform_point(scene.shapes[0].world_from_object.matrix[0], {0, 0, 10}), {0, 0, 0});
    expect_near(transform_point(scene.shapes[1].world_from_object.matrix[0], {1, 2, 3}), {1, 2, 3});
}

TEST(Parser, ActiveTransformChoosesTheEndOfTheShutter) {
    const SceneDescription scene = parse(R"(WorldBegin
ActiveTransform EndTime Translate 1 0 0
ActiveTransform StartTime Scale 2 2 2
ActiveTransform All Translate 0 1 0
Shape "sphere")");
    const AnimatedTransform& transform = scene.shapes[0].world_from_object;
    EXPECT_TRUE(transform.animated());
    expect_near(transform_point(transform.matrix[0], {0, 0, 0}), {0, 2, 0});
    expect_near(transform_point(transform.matrix[1], {0, 0, 0}), {1, 1, 0});
}

// Each entity looks through the parameters that Attribute set: so many different ones are an error, at once.
TEST(Parser, AttributeKeepsAsManyParametersAsAnEntityMayHave) {
    std::string text = "WorldBegin\n";
    for (int i = 0; i < 256; ++i) text += "Attribute \"shape\" \"float a" + std::to_string(i) + "\" 1\n";
    EXPECT_TRUE(Parsed(text).diagnostics.errors().empty());
    EXPECT_TRUE(Parsed(text + "Attribute \"shape\" \"float a7\" 2\n").diagnostics.errors().empty());
    for (int i = 256; i < 100000; ++i) text += "Attribute \"shape\" \"float a" + std::to_string(i) + "\" 1\n";
    const auto errors = Parsed(text).diagnostics.errors();
    ASSERT_FALSE(errors.empty());
    EXPECT_NE(errors[0].find("scene.pbrt:258:1: error: Attribute has set 257 parameters of shape"), std::string::npos)
        << errors[0];
}

TEST(Parser, AttributeBlocksRestoreEverything) {
    const SceneDescription scene = parse(R"(WorldBegin
MakeNamedMedium "fog" "string type" "homogeneous"
Material "diffuse"
AttributeBegin
  Translate 1 1 1 ReverseOrientation Material "conductor" AreaLightSource "diffuse" MediumInterface "fog" "fog"
  ColorSpace "aces2065-1" ActiveTransform EndTime Attribute "shape" "float radius" 3 "float alpha" 0.5
  AttributeBegin
    Attribute "shape" "float radius" 4
    Shape "sphere" "float alpha" 1
  AttributeEnd
AttributeEnd
Translate 2 2 2
Shape "sphere" "rgb x" [ 1 1 1 ])");
    const ShapeDescription& inner = scene.shapes[0];
    EXPECT_EQ(inner.material, 1u);
    EXPECT_EQ(inner.area_light, 0u);
    EXPECT_EQ(inner.interior_medium, 0u);
    Diagnostics diagnostics(*scene.sources);
    // The shape's own parameters win, then those of the innermost Attribute.
    EXPECT_EQ(inner.parameters.get_float("alpha", 0.0f, diagnostics), 1.0f);
    EXPECT_EQ(inner.parameters.get_float("radius", 0.0f, diagnostics), 4.0f);
    const ShapeDescription& outer = scene.shapes[1];
    EXPECT_EQ(outer.material, 0u);
    EXPECT_EQ(outer.area_light, kNone);
    EXPECT_EQ(outer.interior_medium, kNone);
    EXPECT_FALSE(outer.reverse_orientation);
    EXPECT_FALSE(outer.world_from_object.animated());
    EXPECT_EQ(outer.parameters.parameters.size(), 1u);
    EXPECT_EQ(outer.parameters.parameters[0].color_space, "srgb");
    expect_near(transform_point(outer.world_from_object.matrix[1], {0, 0, 0}), {2, 2, 2});
}

TEST(Parser, AttributesDefaultsNeedNotBeUsed) {
    const Parsed parsed(
        "WorldBegin Attribute \"light\" \"float scale\" 2 AreaLightSource \"diffuse\" LightSource \"point\" \"float "
        "power\" 1");
    EXPECT_TRUE(parsed.scene.area_lights.at(0).parameters.has("scale"));
    Diagnostics diagnostics(*parsed.sources);
    parsed.scene.area_lights.at(0).parameters.report_unused("x", {}, diagnostics);
    EXPECT_FALSE(diagnostics.has_errors());
    parsed.scene.lights.at(0).parameters.report_unused("x", {}, diagnostics);
    EXPECT_EQ(diagnostics.error_count(), 1u);
}

TEST(Parser, WorldBeginResetsTransformsOnly) {
    const SceneDescription scene = parse(
        "Translate 5 5 5 ColorSpace \"dci-p3\" ActiveTransform EndTime Camera \"perspective\"\n"
        "WorldBegin Shape \"sphere\" \"rgb x\" [ 1 1 1 ]");
    expect_near(transform_point(scene.shapes[0].world_from_object.matrix[0], {1, 1, 1}), {1, 1, 1});
    EXPECT_EQ(scene.shapes[0].parameters.parameters[0].color_space, "dci-p3");
    EXPECT_EQ(scene.color_space, "srgb");  // there is no Film: pbrt's default
}

TEST(Parser, NamesMayBeDefinedLater) {
    const SceneDescription scene = parse(R"(WorldBegin
NamedMaterial "late" MediumInterface "fog" ObjectInstance "o"
Shape "sphere"
AttributeBegin MakeNamedMaterial "late" "string type" "diffuse" AttributeEnd
MakeNamedMedium "fog" "string type" "homogeneous"
ObjectBegin "o" Shape "disk" ObjectEnd)");
    EXPECT_EQ(scene.shapes[0].material, 0u);
    EXPECT_EQ(scene.shapes[0].interior_medium, 0u);
    EXPECT_EQ(scene.shapes[0].exterior_medium, 0u);  // one name is for both sides
    EXPECT_EQ(scene.instances[0].object, 0u);
}

TEST(Parser, ObjectsKeepTheTransformOfTheirDefinition) {
    const SceneDescription scene = parse(R"(WorldBegin
Translate 1 0 0
ObjectBegin "o" Scale 2 2 2 Shape "sphere" ObjectEnd
Translate 0 1 0
ObjectInstance "o")");
    const glm::vec3 in_object = transform_point(scene.objects[0].shapes[0].world_from_object.matrix[0], {1, 0, 0});
    expect_near(in_object, {3, 0, 0});
    expect_near(transform_point(scene.instances[0].world_from_object.matrix[0], in_object), {4, 1, 0});
    EXPECT_TRUE(scene.shapes.empty());
}

TEST(Parser, IncludeSharesTheStateAndImportDoesNot) {
    Folder folder;
    folder.write("parts/a.pbrt", "Translate 1 0 0 Material \"diffuse\" Include \"parts/b.pbrt\"");
    folder.write_gzip("parts/b.pbrt",
                      "Shape \"sphere\"\n");  // names are relative to the scene, and gzip'd files are fine
    folder.write(
        "c.pbrt",
        "Translate 0 5 0 Material \"conductor\" MakeNamedMaterial \"m\" \"string type\" \"diffuse\" Shape \"disk\"");
    folder.write("main.pbrt",
                 "WorldBegin Include \"parts/a.pbrt\" Import \"c.pbrt\" Shape \"cylinder\" NamedMaterial \"m\" "
                 "Shape \"sphere\" Include \"parts/b.pbrt\"");
    auto sources = std::make_shared<Sources>();
    Diagnostics diagnostics(*sources);
    const SceneDescription scene = parse_scene_file(folder.path("main.pbrt"), sources, diagnostics);
    ASSERT_FALSE(diagnostics.has_errors()) << diagnostics.errors()[0];
    ASSERT_EQ(scene.shapes.size(), 5u);
    EXPECT_EQ(scene.folder.name() + "/", folder.path());
    expect_near(transform_point(scene.shapes[1].world_from_object.matrix[0], {0, 0, 0}), {1, 5, 0});
    expect_near(transform_point(scene.shapes[2].world_from_object.matrix[0], {0, 0, 0}), {1, 0, 0});
    EXPECT_EQ(scene.shapes[1].material, 1u);
    EXPECT_EQ(scene.shapes[2].material, 0u);
    EXPECT_EQ(scene.shapes[3].material, 2u);  // named things are global
    EXPECT_EQ(sources->describe(scene.shapes[0].location), folder.path("parts/b.pbrt") + ":1:1");
}

TEST(Parser, FilesThatIncludeEachOtherEnd) {
    Folder folder;
    folder.write("a.pbrt", "Include \"b.pbrt\"");
    folder.write("b.pbrt", "Include \"./../" +
                               std::filesystem::path(folder.path("x")).parent_path().filename().string() + "/a.pbrt\"");
    auto sources = std::make_shared<Sources>();
    Diagnostics diagnostics(*sources);
    parse_scene_file(folder.path("a.pbrt"), sources, diagnostics);
    ASSERT_EQ(diagnostics.error_count(), 1u);
    EXPECT_NE(diagnostics.errors()[0].find("b.pbrt:1:9: error: Include cannot read"), std::string::npos);
    EXPECT_NE(diagnostics.errors()[0].find("it includes itself"), std::string::npos);
    EXPECT_THROW(parse_scene_file(folder.path("none.pbrt"), sources, diagnostics), InputError);
    EXPECT_THROW(parse_scene_file("/dev/zero", sources, diagnostics), InputError);
}

TEST(Parser, LaterSettingsWinWithAWarning) {
    const Parsed parsed("Film \"rgb\" \"integer xresolution\" 5\nFilm \"gbuffer\"\nWorldBegin");
    EXPECT_EQ(parsed.scene.film.type, "gbuffer");
    EXPECT_FALSE(parsed.scene.film.parameters.has("xresolution"));
    ASSERT_EQ(parsed.diagnostics.warnings().size(), 1u);
    EXPECT_NE(parsed.diagnostics.warnings()[0].find("scene.pbrt:2:1: warning: Film is given a second time"),
              std::string::npos);
}

TEST(Parser, ShapesOfObjectsDoNotEmit) {
    const Parsed parsed(
        "WorldBegin AreaLightSource \"diffuse\" ObjectBegin \"o\" Shape \"sphere\" ObjectEnd Shape \"disk\"");
    EXPECT_EQ(parsed.scene.objects.at(0).shapes.at(0).area_light, kNone);
    EXPECT_EQ(parsed.scene.shapes.at(0).area_light, 0u);
    EXPECT_EQ(parsed.diagnostics.warnings().size(), 1u);
}

TEST(Parser, GoesOnAfterErrors) {
    const Parsed parsed(
        "WorldBegin\nShape \"sphere\" \"float radius\" x\nShpe \"a\" [ 1 2 ] \"b\"\nShape \"disk\" \"float r\" [ "
        "1\nShape "
        "\"cylinder\"\n");
    EXPECT_EQ(parsed.diagnostics.error_count(), 3u);
    ASSERT_EQ(parsed.scene.shapes.size(), 3u);
    EXPECT_EQ(parsed.scene.shapes[2].type, "cylinder");
}

TEST(Parser, DeepNestingAndManyErrorsEnd) {
    std::string text = "WorldBegin\n";
    for (int i = 0; i < 20000; ++i) text += "AttributeBegin x ";
    const Parsed parsed(text);
    EXPECT_EQ(parsed.diagnostics.error_count(), 40000u);
    EXPECT_EQ(parsed.diagnostics.errors().size(), Diagnostics::kMaxShown);
}
