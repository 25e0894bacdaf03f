// OpenEXR files: every bit comes back, other readers find it, and damaged files are told at once.
#include "support/image_files.h"

#include <OpenImageIO/deepdata.h>
#include <OpenImageIO/imageio.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace lampyris::test {
namespace {

using Exr = ImageFiles;

TEST_F(Exr, ExrKeepsEveryBitOfEveryChannel) {
    // 67 x 41 is not a multiple of the tile size.
    const Image image = sample_image(67, 41,
                                     {"R", "G", "B", "albedo.R", "albedo.G", "albedo.B", "depth.Z", "normal.X",
                                      "normal.Y", "normal.Z", "samples", "variance.B", "variance.G", "variance.R"});
    write_image(path("a.exr"), image);
    const Image read = read_image(path("a.exr"));
    expect_same_bits(image, read.select(image.channel_names));
    EXPECT_EQ(read.storage, Image::Storage::kFloat);
    EXPECT_EQ(read.encoding, Image::Encoding::kLinear);
}

TEST_F(Exr, ExrIsTiledAndKeepsMetadata) {
    Image image = sample_image(100, 70, {"R", "G", "B"});
    image.metadata = {{"lampyris:scene", "scenes/demo.pbrt"},
                      {"lampyris:seed", "7"},
                      {"lampyris:parameters", "{\"maxdepth\": 12}"},
                      {"Software", "lampyris 0.1.0"}};
    write_image(path("a.exr"), image);
    EXPECT_EQ(read_image(path("a.exr")).metadata, image.metadata);
    const auto file = OIIO::ImageInput::open(path("a.exr"));
    ASSERT_TRUE(file);
    EXPECT_EQ(file->spec().tile_width, 64);
    EXPECT_EQ(file->spec().get_string_attribute("compression"), "zip");
}

TEST_F(Exr, HalfExrRoundsColourAndKeepsTheRest) {
    Image image(5, 3, {"R", "G", "B", "depth.Z", "samples"});
    for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = 0.1f + float(i);
    image.at(1, 1, 3) = 123456.789f;  // more than half holds, in a channel that stays float
    image.at(2, 2, 0) = 1e6f;         // more than half holds, in one that does not
    WriteOptions options;
    options.half = true;
    EXPECT_EQ(write_image(path("h.exr"), image, options).clamped, 1u);
    const Image read = read_image(path("h.exr"));
    EXPECT_EQ(read.at(2, 2, read.find_channel("R")), 65504.0f);
    EXPECT_EQ(read.at(1, 1, read.find_channel("depth.Z")), 123456.789f);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < 3; ++c) {
                const float expected = image.at(x, y, c);
                if (expected >= 65504.0f) continue;
                EXPECT_NEAR(read.at(x, y, c), expected, expected / 2048.0f);  // half's rounding: 2^-11
            }
    const auto file = OIIO::ImageInput::open(path("h.exr"));
    ASSERT_TRUE(file);
    EXPECT_EQ(file->spec().channelformat(file->spec().channelindex("R")), OIIO::TypeDesc::HALF);
    EXPECT_EQ(file->spec().channelformat(file->spec().channelindex("samples")), OIIO::TypeDesc::FLOAT);
}

TEST_F(Exr, ExrKeepsTheWindowOfACrop) {
    const Image image = sample_image(40, 30, {"R", "G", "B"});
    const Image crop = image.crop({10, 5, 20, 25});
    ASSERT_EQ(crop.size_text(), "10x20");
    EXPECT_EQ(crop.at(0, 0, 1), image.at(10, 5, 1));
    EXPECT_EQ(crop.at(9, 19, 2), image.at(19, 24, 2));
    write_image(path("crop.exr"), crop);
    const Image read = read_image(path("crop.exr"));
    expect_same_bits(crop, read);
    EXPECT_EQ(read.x, 10);
    EXPECT_EQ(read.y, 5);
    EXPECT_EQ(read.full_width, 40);
    EXPECT_EQ(read.full_height, 30);
    EXPECT_THROW(image.crop({10, 5, 41, 25}), InputError);
    EXPECT_THROW(image.crop({10, 5, 10, 25}), InputError);
}

// OpenImageIO, which has nothing of ours, finds what was written.
TEST_F(Exr, OtherReadersFindWhatAnExrHolds) {
    const Image image = sample_image(90, 70, {"R", "G", "B", "variance.R"}).crop({3, 5, 80, 69});
    for (const char* compression : {"none", "rle", "zip", "zips", "piz"}) {
        for (const int tile_size : {0, 16, 64}) {
            WriteOptions options;
            options.compression = compression;
            options.tile_size = tile_size;
            write_image(path("a.exr"), image, options);
            expect_same_bits(image, read_image(path("a.exr")));
            const auto file = OIIO::ImageInput::open(path("a.exr"));
            ASSERT_TRUE(file) << OIIO::geterror();
            const OIIO::ImageSpec& spec = file->spec();
            EXPECT_EQ(spec.get_string_attribute("compression"), compression);
            EXPECT_EQ(spec.tile_width, tile_size);
            EXPECT_EQ(std::vector<int>({spec.x, spec.y, spec.full_width, spec.full_height}),
                      std::vector<int>({3, 5, 90, 70}));
            Image found(spec.width, spec.height, spec.channelnames);
            ASSERT_TRUE(file->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, found.pixels.data()));
            expect_same_bits(image, found);
        }
    }
}

// Colour of other primaries becomes Rec.709's: red, green and blue of the file's primaries make its white, which is D65 there.
TEST_F(Exr, ExrOfOtherPrimariesIsConverted) {
    OIIO::ImageSpec spec(2, 1, 3, OIIO::TypeDesc::HALF);
    const float p3[8] = {0.68f, 0.32f, 0.265f, 0.69f, 0.15f, 0.06f, 0.3127f, 0.329f};
    spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), p3);
    const auto output = OIIO::ImageOutput::create(path("p3.exr"));
    ASSERT_TRUE(output && output->open(path("p3.exr"), spec));
    const float pixels[6] = {0.5f, 0.5f, 0.5f, 1.0f, 0.0f, 0.0f};
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, pixels) && output->close());
    const Image read = read_image(path("p3.exr"));
    EXPECT_EQ(read.storage, Image::Storage::kHalf);
    EXPECT_EQ(read.channel_names, (std::vector<std::string>{"R", "G", "B"}));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(read.at(0, 0, c), 0.5f, 1e-4f);
    // Display P3's red in Rec.709 (SMPTE EG 432-1's primaries by SMPTE RP 177).
    EXPECT_NEAR(read.at(1, 0, 0), 1.2249f, 1e-3f);
    EXPECT_NEAR(read.at(1, 0, 1), -0.0420f, 1e-3f);
    EXPECT_NEAR(read.at(1, 0, 2), -0.0196f, 1e-3f);
}

TEST_F(Exr, ExrsThatAreNoPicturesAreRefused) {
    OIIO::ImageSpec spec(4, 4, 1, OIIO::TypeDesc::FLOAT);
    spec.deep = true;
    OIIO::DeepData deep;
    deep.init(spec);
    const auto output = OIIO::ImageOutput::create(path("deep.exr"));
    ASSERT_TRUE(output && output->open(path("deep.exr"), spec) && output->write_deep_image(deep) && output->close());
    EXPECT_NE(message_of([&] { read_image(path("deep.exr")); }, ExitCode::kBadInput).find("deep image"),
              std::string::npos);

    // An attribute that claims 2 GB, which OpenEXR would make room for.
    write_image(path("whole.exr"), sample_image(8, 8, {"R", "G", "B"}));
    std::ifstream whole(path("whole.exr"), std::ios::binary);
    std::string bytes(std::istreambuf_iterator<char>(whole), {});
    const std::string name = std::string("channels\0chlist\0", 16);
    const size_t at = bytes.find(name) + name.size();
    ASSERT_LT(at, bytes.size());
    bytes.replace(at, 4, "\xff\xff\xff\x7f");
    write_bytes("large.exr", bytes);
    EXPECT_NE(message_of([&] { read_image(path("large.exr")); }, ExitCode::kBadInput).find("header is damaged"),
              std::string::npos);
    // One of negative length, after which a reader would go back for ever.
    const std::string loops = bytes.substr(0, 8) + std::string("a\0string\0\xf3\xff\xff\xff", 13) + bytes.substr(8);
    write_bytes("loops.exr", loops);
    EXPECT_NE(message_of([&] { read_image(path("loops.exr")); }, ExitCode::kBadInput).find("is said to have -13 bytes"),
              std::string::npos);
    // Channels without end, which take OpenEXR seconds.
    std::vector<std::string> names;
    for (int c = 0; c < 8193; ++c) names.push_back("c" + std::to_string(c));
    write_image(path("channels.exr"), Image(1, 1, names));
    EXPECT_NE(
        message_of([&] { read_image(path("channels.exr")); }, ExitCode::kBadInput).find("more than 8192 channels"),
        std::string::npos);
    write_image(path("chroma.exr"), Image(2, 2, {"Y", "RY", "BY"}));
    EXPECT_NE(message_of([&] { read_image(path("chroma.exr")); }, ExitCode::kBadInput).find("luminance and chroma"),
              std::string::npos);
    // And a chunk of a PNG, of which libpng does.
    write_bytes("large.png",
                std::string("\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\0\1\0\0\0\1\x8\2\0\0\0\x90\x77\x53\xde", 33) +
                    std::string("\x7f\xff\xff\xff"
                                "zTXtabc",
                                11));
    EXPECT_NE(
        message_of([&] { read_image(path("large.png")); }, ExitCode::kBadInput).find("2147483647 bytes, and 3 follow"),
        std::string::npos);
    write_bytes("short.exr", bytes.substr(0, 20));
    EXPECT_NE(message_of([&] { read_image(path("short.exr")); }, ExitCode::kBadInput).find("header is damaged"),
              std::string::npos);
}

// OpenEXR reads a value of its type's size, and goes on after it: as attributes, it then takes whatever is there, of any length.
TEST_F(Exr, ValuesEndWhereTheirAttributesDo) {
    write_image(path("plain.exr"), sample_image(4, 4, {"R", "G", "B"}));
    std::ifstream plain(path("plain.exr"), std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(plain), {});
    const auto with = [&](const std::string& type, const std::string& value) {
        std::string attribute = std::string("x") + '\0' + type + '\0';
        for (int byte = 0; byte < 4; ++byte) attribute += char(value.size() >> (8 * byte));
        write_bytes("value.exr", bytes.substr(0, 8) + attribute + value + bytes.substr(8));
        return path("value.exr");
    };
    const std::string refused = "the attribute 'x' of type '";
    for (const auto& [type, value] :
         std::vector<std::pair<std::string, std::string>>{{"v3f", std::string(8, '\0')},
                                                          {"v3f", std::string(16, '\0')},
                                                          {"timecode", std::string(7, '\0')},
                                                          {"preview", std::string(8, '\1')},
                                                          {"preview", std::string("\1\0\0\0\2\0\0\0abcd", 12)},
                                                          {"preview", "abc"},
                                                          {"stringvector", std::string("\5\0\0\0abcd", 8)},
                                                          {"stringvector", std::string("\xff\xff\xff\xff", 4)},
                                                          {"stringvector", "ab"}})
        EXPECT_NE(message_of([&] { read_image(with(type, value)); }, ExitCode::kBadInput).find(refused + type + "'"),
                  std::string::npos)
            << type << " " << value.size();
    for (const auto& [type, value] :
         std::vector<std::pair<std::string, std::string>>{{"v3f", std::string(12, '\0')},
                                                          {"preview", std::string("\1\0\0\0\1\0\0\0abcd", 12)},
                                                          {"stringvector", std::string("\4\0\0\0abcd\0\0\0\0", 12)},
                                                          {"somebody's own", "abc"}}) {
        // What is wrong then is the place of the chunks.
        const std::string said = message_of([&] { read_image(with(type, value)); }, ExitCode::kBadInput);
        EXPECT_EQ(said.find(refused), std::string::npos) << type << ": " << said;
    }
}

// And makes room for a whole tile, whatever its size.
TEST_F(Exr, TilesAreNotMuchLargerThanThePicture) {
    OIIO::ImageSpec spec(8, 8, 3, OIIO::TypeDesc::FLOAT);
    spec.tile_width = spec.tile_height = 64;
    const auto output = OIIO::ImageOutput::create(path("tiles.exr"));
    const std::vector<float> pixels(8 * 8 * 3, 0.5f);
    ASSERT_TRUE(output && output->open(path("tiles.exr"), spec) &&
                output->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) && output->close());
    EXPECT_EQ(read_image(path("tiles.exr")).at(7, 7, 2), 0.5f);
    std::ifstream file(path("tiles.exr"), std::ios::binary);
    std::string bytes(std::istreambuf_iterator<char>(file), {});
    const size_t at = bytes.find("tiledesc") + 9 + 4;
    ASSERT_EQ(bytes.substr(at, 4), std::string("\x40\0\0\0", 4));
    bytes.replace(at, 8, std::string("\0\x50\0\0\0\x50\0\0", 8));
    write_bytes("large_tiles.exr", bytes);
    EXPECT_NE(message_of([&] { read_image(path("large_tiles.exr")); }, ExitCode::kBadInput).find("20480x20480"),
              std::string::npos);
}

TEST_F(Exr, UnsignedChannelsOfAnExrAreCounts) {
    OIIO::ImageSpec spec(2, 1, 1, OIIO::TypeDesc::UINT32);
    spec.channelnames = {"samples"};
    const auto output = OIIO::ImageOutput::create(path("count.exr"));
    ASSERT_TRUE(output && output->open(path("count.exr"), spec));
    const uint32_t counts[2] = {512, 7};
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::UINT32, counts) && output->close());
    const Image read = read_image(path("count.exr"));
    EXPECT_FLOAT_EQ(read.pixels[0], 512.0f);
    EXPECT_FLOAT_EQ(read.pixels[1], 7.0f);
}

}  // namespace
}  // namespace lampyris::test
