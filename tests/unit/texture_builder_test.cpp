// From Texture directives and image files to programs, packed texels and effects.
#include "core/image/image_io.h"
#include "core/scene/image_store.h"
#include "support/build_text.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

namespace lampyris {
namespace {

using namespace kernel;

// A triangle with the given material, preceded by the given textures.
BuiltText build_textured(const std::string& textures, const std::string& material, const std::string& directory = ".") {
    return build_text("Camera \"perspective\"\nWorldBegin\n" + textures + "\n" + material +
                          "\nShape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 2 ]\n",
                      false, {}, directory);
}
const char* kTextured = "Material \"diffuse\" \"texture reflectance\" \"t\"";

// The operations of the material's reflectance.
std::vector<TextureOp> program_of(const BuiltText& text) {
    const Scene& scene = text.scene();
    std::vector<TextureOp> ops;
    if (text.all_errors() != "" || scene.materials.empty() || scene.materials[0].color0_texture == NONE) {
        ADD_FAILURE() << "no program; " << text.all_errors();
        return {TextureOp{}};
    }
    for (size_t i = scene.materials[0].color0_texture; i < scene.texture_ops.size(); ++i) {
        ops.push_back(scene.texture_ops[i]);
        if (ops.back().flags & 1u) break;
    }
    return ops;
}
std::vector<uint32_t> kinds(const std::vector<TextureOp>& ops) {
    std::vector<uint32_t> result;
    for (const TextureOp& op : ops) result.push_back(op.operation);
    return result;
}
using Kinds = std::vector<uint32_t>;

void expect_error(const BuiltText& text, const std::string& part) {
    EXPECT_NE(text.all_errors().find(part), std::string::npos) << "no \"" << part << "\" in:\n" << text.all_errors();
}

TEST(TextureBuilder, CheckerboardOfConstants) {
    const BuiltText text = build_textured(
        "Texture \"t\" \"spectrum\" \"checkerboard\" \"float uscale\" 8 \"float vdelta\" 0.5 \"rgb tex1\" [ 0.8 0.7 "
        "0.6 ]",
        kTextured);
    const std::vector<TextureOp> ops = program_of(text);
    ASSERT_EQ(kinds(ops), (Kinds{TEXTURE_CONSTANT, TEXTURE_CONSTANT, TEXTURE_CHECKERBOARD})) << text.all_errors();
    EXPECT_EQ(vec3(ops[0].a), vec3(0.8f, 0.7f, 0.6f));
    EXPECT_EQ(vec3(ops[1].a), vec3(0.0f));
    EXPECT_EQ(ops[2].m0, vec4(8, 1, 0, 0.5f));
    EXPECT_EQ(ops[2].flags, MAPPING_UV << 8 | 1u);
    EXPECT_EQ(text.scene().effects.mask() & (EFFECT_TEXTURES | EFFECT_IMAGES | EFFECT_NOISE), EFFECT_TEXTURES);
}

TEST(TextureBuilder, TransformsReachMappings) {
    const std::string before = "Translate 10 0 0\nScale 2 2 2\n";
    const BuiltText space =
        build_textured(before + "Texture \"t\" \"spectrum\" \"checkerboard\" \"integer dimension\" 3", kTextured);
    EXPECT_EQ(program_of(space).back().flags >> 8, MAPPING_SPACE);
    EXPECT_EQ(program_of(space).back().m0, vec4(0.5f, 0, 0, -5));
    const BuiltText planar = build_textured(before +
                                                "Texture \"t\" \"spectrum\" \"dots\" \"string mapping\" \"planar\" "
                                                "\"vector3 v1\" [ 0 4 0 ] \"float udelta\" 7",
                                            kTextured);
    EXPECT_EQ(program_of(planar).back().m0, vec4(0, 2, 0, 7));
    EXPECT_EQ(program_of(planar).back().m1, vec4(0, 0.5f, 0, 0));
    EXPECT_TRUE(planar.scene().effects.has(EFFECT_NOISE));
    const BuiltText direction = build_textured(
        "Rotate 90 0 0 1\nTexture \"t\" \"spectrum\" \"directionmix\" \"vector3 dir\" [ 3 0 0 ]", kTextured);
    EXPECT_NEAR(program_of(direction).back().a.y, 1.0f, 1e-6f);
    expect_error(build_textured("Scale 1 0 1\nTexture \"t\" \"spectrum\" \"marble\"", kTextured), "cannot be inverted");
}

TEST(TextureBuilder, WhatIsConstantStaysConstant) {
    const BuiltText text = build_textured(
        "Texture \"a\" \"spectrum\" \"scale\" \"rgb tex\" [ 0.5 1 0.25 ] \"float scale\" 0.5\n"
        "Texture \"t\" \"spectrum\" \"mix\" \"texture tex1\" \"a\" \"rgb tex2\" [ 1 0 0 ] \"float amount\" 0.25",
        kTextured);
    const std::vector<TextureOp> ops = program_of(text);
    ASSERT_EQ(kinds(ops), Kinds{TEXTURE_CONSTANT});
    EXPECT_EQ(vec3(ops[0].a), vec3(0.4375f, 0.375f, 0.09375f));
}

TEST(TextureBuilder, FloatAndSpectrumNamesAreApart) {
    const BuiltText text = build_textured(
        "Texture \"t\" \"float\" \"constant\" \"float value\" 0.25\nTexture \"t\" \"spectrum\" \"constant\" \"rgb "
        "value\" [ 1 0 0 ]",
        std::string(kTextured) + " \"texture displacement\" \"t\"");
    ASSERT_EQ(text.all_errors(), "");
    const MaterialRecord& m = text.scene().materials[0];
    EXPECT_EQ(text.scene().texture_ops[m.color0_texture].a.y, 0.0f);
    EXPECT_EQ(text.scene().texture_ops[m.bump_texture].a.y, 0.25f);
}

TEST(TextureBuilder, UnusedTexturesCostNothingButAreChecked) {
    const test::TemporaryFolder folder;
    write_png(folder / "a.png", 1, 1, {10, 20, 30});
    const BuiltText fine =
        build_textured("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\"", "", folder.string());
    EXPECT_EQ(fine.all_errors(), "");
    EXPECT_TRUE(fine.scene().texture_ops.empty());
    EXPECT_TRUE(fine.scene().images.empty());
    EXPECT_FALSE(fine.scene().effects.has(EFFECT_IMAGES));
    expect_error(build_textured("Texture \"t\" \"spectrum\" \"checkerbord\"", ""), "did you mean \"checkerboard\"");
}

TEST(TextureBuilder, ErrorsSayWhatIsWrong) {
    const test::TemporaryFolder folder;
    write_png(folder / "wood.png", 1, 1, {10, 20, 30});
    std::ofstream(folder / "broken.png") << "this is no picture";
    const auto image = [&](const std::string& more) {
        return build_textured("Texture \"t\" \"spectrum\" \"imagemap\" " + more, kTextured, folder.string());
    };
    expect_error(image("\"string filename\" \"wod.png\""), "did you mean \"wood.png\"");
    expect_error(image("\"string filename\" \"broken.png\""), "cannot read the image");
    expect_error(image(""), "filename");
    expect_error(image("\"string filename\" \"wood.png\" \"string encoding\" \"gama 2\""), "\"gama 2\" is no encoding");
    expect_error(image("\"string filename\" \"wood.png\" \"string wrap\" \"repaet\""), "did you mean \"repeat\"");
    expect_error(image("\"string filename\" \"wood.png\" \"float uscal\" 2"), "did you mean \"uscale\"");
    expect_error(build_textured("", "Material \"diffuse\" \"texture reflectance\" \"wood\""),
                 "there is no spectrum texture \"wood\"");
    expect_error(build_textured("Texture \"t\" \"float\" \"constant\"", kTextured),
                 "\"t\" is a float texture, and this takes a spectrum texture");
    expect_error(build_textured("Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"later\"\nTexture \"later\" "
                                "\"spectrum\" \"constant\"",
                                kTextured),
                 "it is defined only at test.pbrt:4:1");
    expect_error(build_textured("Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"t\"", kTextured),
                 "there is no spectrum texture \"t\"");
    expect_error(build_textured("Texture \"t\" \"spectrum\" \"constant\" \"float value\" 1", kTextured),
                 "\"value\" of a spectrum texture is of type float");
    expect_error(build_textured("Texture \"t\" \"spectrum\" \"fbm\"", kTextured), "is a float texture");
    expect_error(build_textured("Texture \"t\" \"spectrum\" \"ptex\" \"string filename\" \"a.ptx\"", kTextured),
                 "ptex");
}

// A texture that doubles at each level would have 2^40 operations: it is refused, and quickly.
TEST(TextureBuilder, TexturesThatGrowWithoutBoundAreRefused) {
    std::string textures = "Texture \"t0\" \"spectrum\" \"checkerboard\"\n";
    for (int i = 1; i <= 40; ++i) {
        const std::string below = std::to_string(i - 1), name = std::to_string(i);
        textures += "Texture \"t" + name + "\" \"spectrum\" \"checkerboard\" \"texture tex1\" \"t" + below +
                    "\" \"texture tex2\" \"t" + below + "\"\n";
    }
    expect_error(build_textured(textures, "Material \"diffuse\" \"texture reflectance\" \"t40\""),
                 "at most 1024 operations");
}

// ---- Images ----------------------------------------------------------------------------------------------------------

TEST(TextureBuilder, OneFileIsLoadedOnce) {
    const test::TemporaryFolder folder;
    write_png(folder / "a.png", 2, 2, {0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255});
    const BuiltText text = build_textured(
        "Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\"\n"
        "Texture \"b\" \"spectrum\" \"imagemap\" \"string filename\" \"./a.png\" \"string wrap\" \"clamp\" \"float "
        "scale\" 0.5\n"
        "Texture \"c\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\" \"string encoding\" \"linear\" \"string "
        "filter\" \"EWA\"\n"
        "Texture \"ab\" \"spectrum\" \"mix\" \"texture tex1\" \"a\" \"texture tex2\" \"b\"\n"
        "Texture \"t\" \"spectrum\" \"mix\" \"texture tex1\" \"ab\" \"texture tex2\" \"c\"",
        kTextured, folder.string());
    ASSERT_EQ(text.all_errors(), "");
    const Scene& scene = text.scene();
    ASSERT_EQ(scene.images.size(), 3u);
    EXPECT_EQ(scene.images[0].first_texel, scene.images[1].first_texel) << "the same texels";
    EXPECT_NE(scene.images[0].decoding, scene.images[2].decoding) << "another encoding";
    EXPECT_EQ(scene.images[1].format, TEXEL_RGBA8 | WRAP_CLAMP << 8 | FILTER_BILINEAR << 16);
    EXPECT_EQ(scene.texels.size(), 2u * (256 + 4));
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_NE(scene.notes[0].find("EWA"), std::string::npos);
    EXPECT_TRUE(scene.effects.has(EFFECT_IMAGES));
    // A constant factor goes into the look-up.
    const BuiltText scaled = build_textured(
        "Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\" \"float scale\" 3\n"
        "Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"a\" \"float scale\" 0.5",
        kTextured, folder.string());
    ASSERT_EQ(kinds(program_of(scaled)), Kinds{TEXTURE_IMAGE});
    EXPECT_EQ(program_of(scaled)[0].a.x, 1.5f);
}

class StoredImage : public testing::TestWithParam<Image::Storage> {};

// A kernel decodes the image's values, to the precision of the format.
TEST_P(StoredImage, KeepsItsValues) {
    for (const bool grey : {false, true})
        for (const TexelEncoding::Kind kind :
             {TexelEncoding::Kind::kLinear, TexelEncoding::Kind::kSrgb, TexelEncoding::Kind::kGamma}) {
            const bool integers = GetParam() == Image::Storage::kUint8 || GetParam() == Image::Storage::kUint16;
            Image image(7, 5, grey ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B", "A"});
            image.storage = GetParam();
            const double levels = GetParam() == Image::Storage::kUint8 ? 255 : 65535;
            for (size_t i = 0; i < image.pixels.size(); ++i)
                image.pixels[i] =
                    integers ? float(double(i * 7919 % size_t(levels + 1)) / levels) : float(i) * 0.37f - 9.0f;
            Scene scene;
            const Sources sources;
            Diagnostics diagnostics(sources);
            ImageStore store(scene, diagnostics);
            const uint32_t index = store.add(image, {kind, 2.5f}, {WRAP_CLAMP, FILTER_POINT}, "test", {});
            EXPECT_EQ(scene.images[index].width, 7u);
            EXPECT_EQ(scene.images[index].height, 5u);
            const std::vector<glm::vec3> pixels = store.pixels(index);
            glm::dvec3 sum(0);
            for (size_t p = 0; p < pixels.size(); ++p)
                for (int c = 0; c < 3; ++c) {
                    double want = image.pixels[p * size_t(image.channels) + (grey ? 0 : size_t(c))];
                    if (integers && kind == TexelEncoding::Kind::kSrgb)
                        want = want <= 0.04045 ? want / 12.92 : std::pow((want + 0.055) / 1.055, 2.4);
                    if (integers && kind == TexelEncoding::Kind::kGamma) want = std::pow(want, 2.5);
                    // Halves have eleven bits; below 2^-14 their step is 2^-24.
                    ASSERT_NEAR(pixels[p][c], want, std::abs(want) * 0x1p-11 + 0x1p-24);
                    sum[c] += pixels[p][c];
                }
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(store.average(index)[c], sum[c] / 35, 1e-5);
        }
}

INSTANTIATE_TEST_SUITE_P(Storages, StoredImage,
                         testing::Values(Image::Storage::kUint8, Image::Storage::kUint16, Image::Storage::kHalf,
                                         Image::Storage::kFloat));

TEST(ImageStoreTest, NumbersThatAreNotFiniteAreReplacedAndTold) {
    Image image(2, 1, {"R", "G", "B"});
    image.storage = Image::Storage::kHalf;
    image.pixels = {NAN, 1, INFINITY, -INFINITY, 1e6f, 0.5f};
    Scene scene;
    const Sources sources;
    Diagnostics diagnostics(sources);
    ImageStore store(scene, diagnostics);
    const std::vector<glm::vec3> pixels = store.pixels(store.add(image, {}, {}, "sky.exr", {}));
    EXPECT_EQ(pixels[0], glm::vec3(0, 1, 65504));
    EXPECT_EQ(pixels[1], glm::vec3(-65504, 65504, 0.5f));
    ASSERT_EQ(diagnostics.warnings().size(), 1u);
    EXPECT_NE(diagnostics.warnings()[0].find("4 numbers"), std::string::npos) << diagnostics.warnings()[0];
}

TEST(ImageStoreTest, ChannelsAreFoundByName) {
    Image image(1, 1, {"B", "G", "R"});
    image.pixels = {1, 2, 3};
    Scene scene;
    const Sources sources;
    Diagnostics diagnostics(sources);
    ImageStore store(scene, diagnostics);
    EXPECT_EQ(store.pixels(store.add(image, {}, {}, "test", {}))[0], glm::vec3(3, 2, 1));
}

}  // namespace
}  // namespace lampyris
