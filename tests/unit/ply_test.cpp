// Reads PLY meshes of every format from memory, and reports errors in damaged ones.
#include "core/scene/ply.h"

#include "core/base/error.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>

using namespace lampyris;

namespace {

template <typename T>
void put(std::string& bytes, T value, bool big_endian = false) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (big_endian) std::reverse(raw, raw + sizeof(T));
    bytes.append(raw, sizeof(T));
}

std::string gzip(const std::string& text) {
    std::string packed(text.size() + 1000, '\0');
    z_stream stream{};
    EXPECT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
    stream.avail_in = static_cast<uInt>(text.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    return packed;
}

std::string error_of(const std::string& bytes) {
    try {
        read_ply_bytes("mesh.ply", bytes);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

const std::string kAscii =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 5\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "element face 3\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0.5 0.5 1e-1\n3 0 1 2\n4 0 1 2 3\n5 0 1 2 3 4\n";

// Four vertices with normals and texture coordinates, one triangle and one quad, with indices of faces.
std::string binary(bool big, const std::string& index_type = "int", bool is_short = false) {
    std::string bytes =
        std::string("ply\nformat binary_") + (big ? "big" : "little") +
        "_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty double nx\nproperty double ny\nproperty double nz\n"
        "property float s\nproperty float t\nelement edge 2\nproperty int a\nproperty list uchar short b\n"
        "element face 2\nproperty list uchar " +
        index_type + " vertex_index\nproperty int face_indices\nend_header\n";
    for (int i = 0; i < 4; ++i) {
        for (int c = 0; c < 3; ++c) put(bytes, 1.5f * static_cast<float>(3 * i + c), big);
        put(bytes, uint8_t{200});
        for (int c = 0; c < 3; ++c) put(bytes, c == 2 ? 1.0 : 0.0, big);
        put(bytes, 0.25f * static_cast<float>(i), big);
        put(bytes, -0.5f, big);
    }
    for (int i = 0; i < 2; ++i) {
        put(bytes, int32_t{7}, big);
        put(bytes, uint8_t{2});
        put(bytes, int16_t{1}, big);
        put(bytes, int16_t{2}, big);
    }
    const auto put_face = [&](const std::vector<int>& face, int index) {
        put(bytes, static_cast<uint8_t>(face.size()));
        for (int v : face)
            if (is_short)
                put(bytes, static_cast<int16_t>(v), big);
            else
                put(bytes, int32_t{v}, big);
        put(bytes, int32_t{index}, big);
    };
    put_face({0, 1, 2, 3}, 11);
    put_face({3, 2, 1}, 12);
    return bytes;
}

// A file that the reader handles by its fastest path.
std::string usual(const std::string& more = "") {
    std::string bytes =
        "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
        "property float z\nelement face 3\nproperty list uchar int vertex_indices\nend_header\n";
    for (int i = 0; i < 12; ++i) put(bytes, static_cast<float>(i));
    for (const std::vector<int>& face : {std::vector<int>{0, 1, 2}, {0, 1}, {0, 1, 2, 3}}) {
        put(bytes, static_cast<uint8_t>(face.size()));
        for (int v : face) put(bytes, int32_t{v});
    }
    return bytes + more;
}

}  // namespace

TEST(Ply, ReadsAscii) {
    const PlyMesh mesh = read_ply_bytes("mesh.ply", kAscii);
    EXPECT_EQ(mesh.positions.size(), 15u);
    EXPECT_EQ(mesh.positions[14], 0.1f);
    EXPECT_EQ(mesh.triangles, (std::vector<uint32_t>{0, 1, 2}));
    EXPECT_EQ(mesh.quads, (std::vector<uint32_t>{0, 1, 3, 2}));
    EXPECT_EQ(mesh.skipped_faces, 1u);
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_TRUE(mesh.uvs.empty());
    EXPECT_TRUE(mesh.face_indices.empty());
}

TEST(Ply, ReadsAsciiWithCarriageReturns) {
    std::string text;
    for (char c : kAscii) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
    EXPECT_EQ(read_ply_bytes("mesh.ply", text).positions, read_ply_bytes("mesh.ply", kAscii).positions);
}

TEST(Ply, ReadsBothByteOrdersAndSkipsTheUnknown) {
    for (bool big : {false, true}) {
        for (bool is_short : {false, true}) {
            const PlyMesh mesh = read_ply_bytes("mesh.ply", binary(big, is_short ? "short" : "uint", is_short));
            ASSERT_EQ(mesh.positions.size(), 12u);
            for (int i = 0; i < 12; ++i) EXPECT_EQ(mesh.positions[i], 1.5f * static_cast<float>(i));
            EXPECT_EQ(mesh.normals, (std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}));
            EXPECT_EQ(mesh.uvs, (std::vector<float>{0, -0.5f, 0.25f, -0.5f, 0.5f, -0.5f, 0.75f, -0.5f}));
            EXPECT_EQ(mesh.quads, (std::vector<uint32_t>{0, 1, 3, 2}));
            EXPECT_EQ(mesh.triangles, (std::vector<uint32_t>{3, 2, 1}));
            EXPECT_EQ(mesh.face_indices, (std::vector<int32_t>{12, 11}));
        }
    }
}

TEST(Ply, ReadsTheUsualLayout) {
    const PlyMesh mesh = read_ply_bytes("mesh.ply", usual("bytes after the end do not matter"));
    EXPECT_EQ(mesh.positions[11], 11.0f);
    EXPECT_EQ(mesh.triangles, (std::vector<uint32_t>{0, 1, 2}));
    EXPECT_EQ(mesh.quads, (std::vector<uint32_t>{0, 1, 3, 2}));
    EXPECT_EQ(mesh.skipped_faces, 1u);
}

TEST(Ply, ReadsGzip) {
    EXPECT_EQ(read_ply_bytes("mesh.ply.gz", gzip(kAscii)).positions, read_ply_bytes("mesh.ply", kAscii).positions);
    // gzip allows several members in a row.
    const std::string members = gzip(kAscii.substr(0, 100)) + gzip(kAscii.substr(100));
    EXPECT_EQ(read_ply_bytes("mesh.ply.gz", members).triangles.size(), 3u);
    const std::string packed = gzip(usual());
    EXPECT_NE(error_of(packed.substr(0, packed.size() / 2)).find("ends too early"), std::string::npos);
    std::string damaged = packed;
    damaged[12] = static_cast<char>(damaged[12] ^ 0x55);
    damaged[20] = static_cast<char>(damaged[20] ^ 0x55);
    EXPECT_NE(error_of(damaged), "no error");
}

TEST(Ply, ReadsFromAFile) {
    const test::TemporaryFolder folder;
    const std::string path = folder / "mesh.ply";
    std::ofstream(path, std::ios::binary) << usual();
    EXPECT_EQ(read_ply(path).triangles.size(), 3u);
    std::ofstream(path, std::ios::binary) << gzip(usual());  // recognised by its bytes, not by its name
    EXPECT_EQ(read_ply(path).triangles.size(), 3u);
    std::remove(path.c_str());
    EXPECT_THROW(read_ply(path), InputError);
    EXPECT_THROW(read_ply(folder.string()), InputError);  // a directory
    EXPECT_THROW(read_ply("/dev/zero"), InputError);      // a device, which never ends
}

TEST(Ply, EveryTruncationIsAnError) {
    // The ascii file's last number may be cut without notice if the rest is a number, too.
    for (const std::string& whole : {usual(), binary(true), binary(false), kAscii.substr(0, kAscii.size() - 1)})
        for (size_t size = 0; size < whole.size(); ++size)
            EXPECT_NE(error_of(whole.substr(0, size)), "no error") << "cut at byte " << size;
}

TEST(Ply, ALyingHeaderAllocatesNothing) {
    for (const char* count : {"4000000000", "18446744073709551615", "1000000000000"}) {
        for (std::string bytes : {usual(), kAscii, binary(true)}) {
            for (const char* element : {"element vertex ", "element face "}) {
                std::string lying = bytes;
                const size_t digit = lying.find(element) + std::strlen(element);
                lying.replace(digit, 1, count);
                const std::string error = error_of(lying);
                EXPECT_NE(error.find("the file ends before"), std::string::npos) << error;
            }
        }
    }
}

TEST(Ply, RefusesIndicesOfNoVertex) {
    std::string bytes = usual();
    const size_t first_index = bytes.size() - (1 + 16) - (1 + 8) - 12;
    for (int32_t index : {4, 1000000, -1}) {
        std::memcpy(bytes.data() + first_index, &index, 4);
        EXPECT_EQ(error_of(bytes), "mesh.ply: error: triangle 0 has the vertex index " + std::to_string(index) +
                                       ", but there are 4 vertices");
    }
}

TEST(Ply, RefusesNumbersThatAreNotFinite) {
    std::string bytes = usual();
    const size_t body = bytes.find("end_header\n") + 11;
    const float infinite = std::numeric_limits<float>::infinity();
    std::memcpy(bytes.data() + body + 12 + 4, &infinite, 4);
    EXPECT_NE(error_of(bytes).find("property \"y\" of vertex 1 is not a finite float"), std::string::npos)
        << error_of(bytes);
}

// The shape reports errors in these, and continues without them.
TEST(Ply, PassesNormalsOnThatAreNotFinite) {
    std::string bytes = binary(false);
    const PlyMesh good = read_ply_bytes("mesh.ply", bytes);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::memcpy(bytes.data() + bytes.find("end_header\n") + 11 + 13, &nan, sizeof nan);  // after x, y, z and red
    const PlyMesh mesh = read_ply_bytes("mesh.ply", bytes);
    EXPECT_EQ(mesh.positions, good.positions);
    EXPECT_EQ(mesh.uvs, good.uvs);
    EXPECT_TRUE(std::isnan(mesh.normals[0]));
    EXPECT_EQ(mesh.normals[3], good.normals[3]);
}

TEST(Ply, ErrorsNameTheirPlace) {
    struct Case {
        const char *text, *expected;
    };
    const Case cases[] = {
        {"plyx\n", "mesh.ply:1:1: error: this is not a PLY file"},
        {"ply\nformat ascii 1.0\nelement vertex 1\n", "mesh.ply:4:1: error: the header does not end"},
        {"ply\nformat asci 1.0\n", "mesh.ply:2:8: error: unknown PLY format \"asci\" (did you mean \"ascii\"?)"},
        {"ply\nformat ascii 2.0\n", "mesh.ply:2:14: error: the only PLY version is 1.0"},
        {"ply\nelemnt vertex 1\n", "mesh.ply:2:1: error: unknown header line \"elemnt\" (did you mean \"element\"?)"},
        {"ply\nelement vertex -1\n", "mesh.ply:2:16: error: \"-1\" is no count"},
        {"ply\nelement vertex 1\nproperty flaot x\n",
         "mesh.ply:3:10: error: unknown type \"flaot\" (did you mean \"float\"?)"},
        {"ply\nproperty float x\n", "mesh.ply:2:1: error: a property before the first element"},
        {"ply\nelement a 1\nelement a 1\n", "mesh.ply:3:9: error: element \"a\" is declared twice"},
        {"ply\nelement a 1\nproperty int x\nproperty int x\n",
         "mesh.ply:4:1: error: property \"x\" of \"a\" is declared twice"},
        {"ply\nelement a 1\nproperty list float int x\n", "mesh.ply:3:15: error: the count of a list is an integer"},
        {"ply\nend_header\n", "mesh.ply:1:1: error: the header has no \"format\" line"},
        {"ply\nformat ascii 1.0\nend_header\n", "error: the file has no element \"vertex\""},
        {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nelement face 0\nend_header\n0\n",
         "mesh.ply:3:1: error: vertices need the properties x, y and z"},
        {"ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face "
         "1\nproperty float vertex_indices\nend_header\n0\n",
         "mesh.ply:7:1: error: faces need the property list vertex_indices"},
    };
    for (const Case& c : cases) EXPECT_NE(error_of(c.text).find(c.expected), std::string::npos) << error_of(c.text);
    std::string bad = kAscii;
    bad.replace(bad.find("1 1 0"), 5, "1 x 0");
    EXPECT_EQ(error_of(bad), "mesh.ply:13:3: error: expected a number, found \"x\"\n1 x 0\n  ^");
    bad = kAscii;
    bad.replace(bad.find("3 0 1 2"), 7, "3 0 1.5");
    EXPECT_NE(error_of(bad).find("expected a 32-bit integer"), std::string::npos);
    bad = kAscii;
    bad.replace(bad.find("3 0 1 2"), 7, "3 -1 12");
    EXPECT_NE(error_of(bad).find("negative vertex index -1"), std::string::npos);
}
