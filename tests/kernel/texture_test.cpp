// Every operation, mapping, wrap mode and texel format, on every backend, against double precision.
#include "support/texture_reference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lampyris::test {
namespace {

constexpr const char* kFile = "kernel/texture_probe.kernel.h";
constexpr size_t kPoints = 2000;

struct Probe {
    glm::uvec4 what;
    glm::vec4 position, normal, uv;
};

using Random = std::mt19937;

float number(Random& random, float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); }
glm::vec3 color(Random& random) { return {number(random, 0, 1), number(random, 0, 1), number(random, 0, 1)}; }

TexturePoint point_of(const Probe& probe) {
    return {glm::dvec3(probe.position), glm::dvec3(probe.normal), glm::dvec2(probe.uv)};
}

std::vector<Probe> random_probes(Random& random, uint32_t mode, uint32_t index, size_t count) {
    std::vector<Probe> probes(count);
    for (Probe& probe : probes) {
        probe.what = {mode, index, 0, 0};
        probe.position = {number(random, -4, 4), number(random, -4, 4), number(random, -4, 4), 0};
        probe.normal = glm::vec4(
            glm::normalize(glm::dvec3(number(random, -1, 1), number(random, -1, 1), number(random, 0.1f, 1))), 0);
        probe.uv = {number(random, -2, 3), number(random, -2, 3), 0, 0};
    }
    return probes;
}

// Runs one program at the probes on every backend; all must give the same bits, close to the reference unless it jumps there.
void expect_program(TextureScene& scene, const TextureNode& node, Random& random, double tolerance,
                    const ImageReference& images = {}) {
    const uint32_t program = scene.add_program(postfix(node));
    const std::vector<Probe> probes = random_probes(random, 0, program, kPoints);
    std::vector<glm::vec4> first;
    for (const std::string& backend : backend_names()) {
        SCOPED_TRACE(backend);
        const std::vector<glm::vec4> got = scene.run<glm::vec4>(backend, kFile, probes);
        if (first.empty()) first = got;
        EXPECT_TRUE(same_bits(got, first)) << "differs from " << backend_names().front();
        size_t compared = 0;
        for (size_t i = 0; i < probes.size(); ++i) {
            double margin = 1;
            const glm::dvec3 want = reference_color(node, point_of(probes[i]), images, margin);
            if (margin < 1e-4) continue;
            ++compared;
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(got[i][c], want[c], tolerance * std::max(1.0, std::abs(want[c])))
                    << "channel " << c << " of point " << i;
            ASSERT_EQ(got[i].w, got[i].x) << "the value as a float";
        }
        EXPECT_GT(compared, kPoints * 9 / 10);
    }
}

TextureNode constant_node(Random& random) { return {constant_op(color(random)), {}}; }

void set_rows(TextureOp& op, Random& random) {
    for (glm::vec4* row : {&op.m0, &op.m1, &op.m2})
        *row = {number(random, -1, 1), number(random, -1, 1), number(random, -1, 1), number(random, -1, 1)};
}

// Its value is (s, t, 0), which shows the mapping itself.
TextureNode st_node(uint32_t mapping, Random& random) {
    TextureOp op = operation(kernel::TEXTURE_BILERP, mapping);
    if (mapping == kernel::MAPPING_UV)
        op.m0 = {number(random, -3, 3), number(random, -3, 3), number(random, -1, 1), number(random, -1, 1)};
    else
        set_rows(op, random);
    return {op,
            {{constant_op({0, 0, 0}), {}},
             {constant_op({0, 1, 0}), {}},
             {constant_op({1, 0, 0}), {}},
             {constant_op({1, 1, 0}), {}}}};
}

TEST(Texture, Mappings) {
    for (uint32_t mapping :
         {kernel::MAPPING_UV, kernel::MAPPING_SPHERICAL, kernel::MAPPING_CYLINDRICAL, kernel::MAPPING_PLANAR}) {
        SCOPED_TRACE(mapping);
        Random random(mapping);
        TextureScene scene;
        expect_program(scene, st_node(mapping, random), random, 2e-6);
    }
}

TEST(Texture, Constant) {
    Random random(1);
    TextureScene scene;
    expect_program(scene, constant_node(random), random, 0.0);
}

TEST(Texture, Combinations) {
    for (uint32_t kind : {kernel::TEXTURE_SCALE, kernel::TEXTURE_MIX, kernel::TEXTURE_DIRECTION_MIX}) {
        SCOPED_TRACE(kind);
        Random random(kind);
        TextureScene scene;
        TextureNode node{operation(kind),
                         {st_node(kernel::MAPPING_UV, random), st_node(kernel::MAPPING_PLANAR, random)}};
        if (kind == kernel::TEXTURE_MIX) node.operands.push_back(constant_node(random));
        if (kind == kernel::TEXTURE_DIRECTION_MIX) node.op.a = glm::vec4(glm::normalize(glm::vec3(1, 2, -3)), 0);
        expect_program(scene, node, random, 2e-6);
    }
}

TEST(Texture, Checkerboards) {
    for (uint32_t dimension : {2u, 3u}) {
        SCOPED_TRACE(dimension);
        Random random(dimension);
        TextureScene scene;
        const uint32_t mapping = dimension == 3 ? kernel::MAPPING_SPACE : kernel::MAPPING_UV;
        TextureNode node{operation(kernel::TEXTURE_CHECKERBOARD, mapping),
                         {constant_node(random), constant_node(random)}};
        if (dimension == 3)
            set_rows(node.op, random);
        else
            node.op.m0 = {3, 5, 0.25f, -0.5f};
        expect_program(scene, node, random, 0.0);
    }
}

TEST(Texture, Dots) {
    Random random(3);
    TextureScene scene;
    TextureNode node{operation(kernel::TEXTURE_DOTS), {constant_node(random), constant_node(random)}};
    node.op.m0 = {7, 9, 0.1f, 0.2f};
    expect_program(scene, node, random, 0.0);
}

TEST(Texture, Noise) {
    for (uint32_t kind :
         {kernel::TEXTURE_FBM, kernel::TEXTURE_WRINKLED, kernel::TEXTURE_WINDY, kernel::TEXTURE_MARBLE}) {
        SCOPED_TRACE(kind);
        Random random(kind);
        TextureScene scene;
        TextureNode node{operation(kind, kernel::MAPPING_SPACE, 6), {}};
        set_rows(node.op, random);
        node.op.a = {0.6f, 1.3f, 0.4f, 0};
        // The sixth octave is 31 times as fine: a rounding error of 1e-6 in position grows as much.
        expect_program(scene, node, random, 2e-4);
    }
}

// Textures of textures, as large as the host allows.
TEST(Texture, RandomTrees) {
    Random random(11);
    const std::function<TextureNode(int)> tree = [&](int levels) -> TextureNode {
        constexpr uint32_t kKinds[] = {kernel::TEXTURE_SCALE, kernel::TEXTURE_MIX, kernel::TEXTURE_DIRECTION_MIX,
                                       kernel::TEXTURE_CHECKERBOARD};
        if (levels == 0) return random() % 2 ? constant_node(random) : st_node(kernel::MAPPING_UV, random);
        TextureNode node{operation(kKinds[random() % 4]), {}};
        if (node.op.operation == kernel::TEXTURE_DIRECTION_MIX) node.op.a = {0, 0, 1, 0};
        if (node.op.operation == kernel::TEXTURE_CHECKERBOARD) node.op.m0 = {2, 2, 0.3f, 0.3f};
        const size_t count = node.op.operation == kernel::TEXTURE_MIX ? 3 : 2;
        for (size_t i = 0; i < count; ++i)
            node.operands.push_back(i + 1 == count ? tree(levels - 1) : tree(int(random() % uint32_t(levels))));
        return node;
    };
    size_t deepest = 0;
    for (int i = 0; i < 12; ++i) {
        const TextureNode node = tree(1 + i % 6);
        const size_t depth = stack_depth(node);
        if (depth > kernel::TEXTURE_STACK || postfix(node).size() > kernel::TEXTURE_LENGTH) continue;
        deepest = std::max(deepest, depth);
        TextureScene scene;
        expect_program(scene, node, random, 1e-4);
    }
    EXPECT_GT(deepest, 7u);
}

// The deepest stack and the longest program that the layout guarantees.
TEST(Texture, Limits) {
    Random random(12);
    TextureNode deep = constant_node(random);
    for (uint32_t i = 1; i < kernel::TEXTURE_STACK; ++i)
        deep = {operation(kernel::TEXTURE_SCALE), {{constant_op(glm::vec3(0.9f)), {}}, deep}};
    ASSERT_EQ(stack_depth(deep), kernel::TEXTURE_STACK);
    TextureScene scene;
    expect_program(scene, deep, random, 1e-6);
    TextureNode longest = constant_node(random);
    while (postfix(longest).size() + 2 <= kernel::TEXTURE_LENGTH)
        longest = {operation(kernel::TEXTURE_MIX),
                   {longest, {constant_op(color(random)), {}}, {constant_op(glm::vec3(0.01f)), {}}}};
    if (postfix(longest).size() > kernel::TEXTURE_LENGTH) longest = longest.operands[0];
    TextureScene other;
    expect_program(other, longest, random, 1e-5);
}

// A program without an end is an error, not an image.
TEST(Texture, EndlessProgramIsReported) {
    TextureScene scene;
    scene.scene.texture_ops.assign(2 * kernel::TEXTURE_LENGTH, operation(kernel::TEXTURE_CONSTANT));
    for (size_t i = 1; i < scene.scene.texture_ops.size(); i += 2)
        scene.scene.texture_ops[i].operation = kernel::TEXTURE_SCALE;
    scene.scene.texture_ops.insert(scene.scene.texture_ops.begin(), constant_op(glm::vec3(1)));
    for (const std::string& backend : backend_names())
        EXPECT_ANY_THROW(scene.run<glm::vec4>(backend, kFile, std::vector<Probe>(1))) << backend;
}

// ---- Images ----------------------------------------------------------------------------------------------------------

uint32_t bits(float x) { return std::bit_cast<uint32_t>(x); }

// Independent of the host's packing: random codes, and the values that they represent.
PlainImage random_image(TextureScene& scene, Random& random, uint32_t format, uint32_t wrap, uint32_t filtering,
                        uint32_t& index) {
    PlainImage image{5, 4, wrap, filtering, {}};
    if (wrap == kernel::WRAP_OCTAHEDRAL) image.width = image.height = 6;
    const size_t count = size_t(image.width) * image.height;
    std::vector<uint32_t> words;
    const uint32_t table = uint32_t(scene.scene.texels.size());
    std::vector<double> meaning;
    for (int i = 0; i < 256; ++i) {
        const double v = i / 255.0;
        meaning.push_back(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
        scene.scene.texels.push_back(bits(float(meaning.back())));
    }
    if (format == kernel::TEXEL_R8) words.assign((count + 3) / 4, 0);
    for (size_t p = 0; p < count; ++p) {
        glm::dvec3 value;
        glm::uvec3 code;
        for (int c = 0; c < 3; ++c) {
            code[c] = random() % 256;
            value[c] = meaning[code[c]];
        }
        if (format == kernel::TEXEL_RGBA8)
            words.push_back(code.x | code.y << 8 | code.z << 16 | uint32_t(random()) << 24);
        if (format == kernel::TEXEL_R8) {
            words[p / 4] |= code.x << (8 * (p % 4));
            value = glm::dvec3(value.x);
        }
        if (format == kernel::TEXEL_RGBA16F) {
            // Halves are sign, exponent and ten bits: multiples of 2^-10 in [1, 2).
            for (int c = 0; c < 3; ++c) value[c] = -(1 + code[c] / 1024.0);
            words.push_back((0xbc00u + code.x) | (0xbc00u + code.y) << 16);
            words.push_back((0xbc00u + code.z) | uint32_t(random()) << 16);
        }
        if (format == kernel::TEXEL_RGB32F || format == kernel::TEXEL_R32F) {
            value = glm::dvec3(color(random) * 100.0f - 50.0f);
            if (format == kernel::TEXEL_R32F) value = glm::dvec3(value.x);
            for (int c = 0; c < (format == kernel::TEXEL_R32F ? 1 : 3); ++c) words.push_back(bits(float(value[c])));
        }
        image.texels.push_back(value);
    }
    index = scene.add_image(words, image.width, image.height, format, wrap, filtering, table);
    return image;
}

class ImageLookups : public testing::TestWithParam<uint32_t> {};  // texel format

TEST_P(ImageLookups, WrapsAndFilters) {
    for (uint32_t wrap : {kernel::WRAP_REPEAT, kernel::WRAP_BLACK, kernel::WRAP_CLAMP, kernel::WRAP_OCTAHEDRAL})
        for (uint32_t filtering : {kernel::FILTER_POINT, kernel::FILTER_BILINEAR}) {
            SCOPED_TRACE(testing::Message() << "wrap " << wrap << ", filter " << filtering);
            Random random(17 + GetParam());
            TextureScene scene;
            uint32_t index = 0;
            const PlainImage image = random_image(scene, random, GetParam(), wrap, filtering, index);
            std::vector<Probe> probes = random_probes(random, 1, index, kPoints);
            if (wrap == kernel::WRAP_OCTAHEDRAL)
                for (Probe& probe : probes) probe.uv = {number(random, 0, 1), number(random, 0, 1), 0, 0};
            std::vector<glm::vec4> first;
            for (const std::string& backend : backend_names()) {
                SCOPED_TRACE(backend);
                const std::vector<glm::vec4> got = scene.run<glm::vec4>(backend, kFile, probes);
                if (first.empty()) first = got;
                EXPECT_TRUE(same_bits(got, first));
                for (size_t i = 0; i < probes.size(); ++i) {
                    double margin = 1;
                    const glm::dvec3 want = image.lookup(glm::dvec2(probes[i].uv), margin);
                    if (margin < 1e-4) continue;
                    for (int c = 0; c < 3; ++c)
                        ASSERT_NEAR(got[i][c], want[c], 1e-6 * 100)
                            << "at " << probes[i].uv.x << ", " << probes[i].uv.y;
                    ASSERT_EQ(got[i].w, 1.0f);
                }
            }
        }
}

INSTANTIATE_TEST_SUITE_P(Formats, ImageLookups,
                         testing::Values(kernel::TEXEL_RGBA8, kernel::TEXEL_R8, kernel::TEXEL_RGBA16F,
                                         kernel::TEXEL_RGB32F, kernel::TEXEL_R32F));

// All finite half floats, decoded exactly.
TEST(Image, HalfFloats) {
    TextureScene scene;
    std::vector<uint32_t> words;
    for (uint32_t code = 0; code < 65536; ++code) words.insert(words.end(), {code | code << 16, code});
    const uint32_t image =
        scene.add_image(words, 256, 256, kernel::TEXEL_RGBA16F, kernel::WRAP_CLAMP, kernel::FILTER_POINT);
    std::vector<Probe> probes(65536);
    for (uint32_t code = 0; code < 65536; ++code) {
        probes[code].what = {1, image, 0, 0};
        probes[code].uv = {(float(code % 256) + 0.5f) / 256.0f, (float(code / 256) + 0.5f) / 256.0f, 0, 0};
    }
    for (const std::string& backend : backend_names()) {
        const std::vector<glm::vec4> got = scene.run<glm::vec4>(backend, kFile, probes);
        for (uint32_t code = 0; code < 65536; ++code) {
            const int exponent = int(code >> 10 & 31), fraction = int(code & 1023);
            if (exponent == 31) continue;  // infinities and NaN are not stored
            const double magnitude =
                exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
            for (int c = 0; c < 3; ++c)
                ASSERT_EQ(got[code][c], float(code >> 15 ? -magnitude : magnitude)) << backend << ", " << code;
        }
    }
}

// The image operation: t runs upwards, values are scaled, then inverted.
TEST(Image, InPrograms) {
    for (uint32_t invert : {0u, 1u}) {
        Random random(23 + invert);
        TextureScene scene;
        uint32_t index = 0;
        const PlainImage image =
            random_image(scene, random, kernel::TEXEL_RGBA8, kernel::WRAP_REPEAT, kernel::FILTER_BILINEAR, index);
        TextureNode node{operation(kernel::TEXTURE_IMAGE, kernel::MAPPING_UV, invert), {}};
        node.op.image = index;
        node.op.a = {1.5f, 0.5f, 2.0f, 0};
        node.op.m0 = {2, -3, 0.25f, 0.5f};
        expect_program(scene, node, random, 1e-5,
                       [&](uint32_t, glm::dvec2 st, double& margin) { return image.lookup(st, margin); });
    }
}

// Whatever the coordinates are, a texel of the image is read: results stay within the image's range.
TEST(Image, WildCoordinates) {
    const float wild[] = {NAN,    INFINITY, -INFINITY, 1e38f, -1e38f, 1e10f,      -1e10f,
                          1e-38f, -1e-38f,  -1e-7f,    1.0f,  0.0f,   0.99999994f};
    for (uint32_t wrap : {kernel::WRAP_REPEAT, kernel::WRAP_BLACK, kernel::WRAP_CLAMP, kernel::WRAP_OCTAHEDRAL})
        for (uint32_t filtering : {kernel::FILTER_POINT, kernel::FILTER_BILINEAR}) {
            TextureScene scene;
            const uint32_t image =
                scene.add_image({bits(1.0f), bits(1.0f), bits(1.0f)}, 3, 1, kernel::TEXEL_R32F, wrap, filtering);
            std::vector<Probe> probes;
            for (float s : wild)
                for (float t : wild) probes.push_back({{1, image, 0, 0}, {}, {}, {s, t, 0, 0}});
            for (const std::string& backend : backend_names())
                for (const glm::vec4& value : scene.run<glm::vec4>(backend, kFile, probes)) {
                    ASSERT_GE(value.x, 0.0f) << backend;
                    ASSERT_LE(value.x, 1.0f + 1e-6f) << backend;
                }
        }
}

}  // namespace
}  // namespace lampyris::test
