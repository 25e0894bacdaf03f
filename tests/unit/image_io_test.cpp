// Images to files and back: the data that must survive do, and errors of reading or writing give a reason.
#include "core/image/image_io.h"

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/image/pfm.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>
#include <OpenImageIO/deepdata.h>
#include <OpenImageIO/imageio.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <limits>

namespace lampyris {
namespace {

namespace fs = std::filesystem;

class ImageIo : public testing::Test {
 protected:
    std::string path(const std::string& name) const { return folder_ / name; }
    void write_bytes(const std::string& name, const std::string& bytes) const {
        std::ofstream(path(name), std::ios::binary) << bytes;
    }
    const test::TemporaryFolder folder_;
};

// No two pixels or channels alike, and negative, tiny, huge and non-finite numbers among them.
Image sample_image(int width, int height, std::vector<std::string> names) {
    Image image(width, height, std::move(names));
    for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = float(i) * 0.37f - 3.0f;
    image.pixels[0] = std::numeric_limits<float>::infinity();
    image.pixels[1] = 1e-42f;
    image.pixels[2] = 3e38f;
    image.pixels[4] = std::numeric_limits<float>::quiet_NaN();
    return image;
}

void expect_same_bits(const Image& a, const Image& b) {
    ASSERT_EQ(a.size_text(), b.size_text());
    ASSERT_EQ(a.channel_names, b.channel_names);
    for (size_t i = 0; i < a.pixels.size(); ++i)
        ASSERT_EQ(std::bit_cast<uint32_t>(a.pixels[i]), std::bit_cast<uint32_t>(b.pixels[i])) << "value " << i;
}

template <class F>
std::string message_of(F&& f, ExitCode expected) {
    try {
        f();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), expected) << error.what();
        return error.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return {};
}

TEST_F(ImageIo, ExrKeepsEveryBitOfEveryChannel) {
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

TEST_F(ImageIo, ExrIsTiledAndKeepsMetadata) {
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

TEST_F(ImageIo, HalfExrRoundsColourAndKeepsTheRest) {
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

TEST_F(ImageIo, ExrKeepsTheWindowOfACrop) {
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

TEST_F(ImageIo, ChannelsAreFoundByNameWhateverTheirOrder) {
    Image image(1, 1, {"B", "A", "R", "G"});
    image.pixels = {3, 4, 1, 2};
    EXPECT_EQ(image.rgb().pixels, (std::vector<float>{1, 2, 3}));
    write_image(path("order.exr"), image);
    EXPECT_EQ(read_image(path("order.exr"), {.rgb = true}).pixels, (std::vector<float>{1, 2, 3}));
    Image grey(1, 1, {"Y"});
    grey.pixels = {5};
    write_image(path("grey.exr"), grey);
    EXPECT_EQ(read_image(path("grey.exr")).channels, 1);
    EXPECT_EQ(read_image(path("grey.exr"), {.rgb = true}).pixels, (std::vector<float>{5, 5, 5}));
    Image odd(1, 1, {"depth.Z", "samples"});
    write_image(path("odd.exr"), odd);
    const std::string message = message_of([&] { read_image(path("odd.exr"), {.rgb = true}); }, ExitCode::kBadInput);
    EXPECT_NE(message.find("depth.Z"), std::string::npos) << message;
    EXPECT_NE(message.find("odd.exr"), std::string::npos) << message;
}

// OpenImageIO, which has nothing of ours, finds what was written.
TEST_F(ImageIo, OtherReadersFindWhatAnExrHolds) {
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
TEST_F(ImageIo, ExrOfOtherPrimariesIsConverted) {
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

TEST_F(ImageIo, ExrsThatAreNoPicturesAreRefused) {
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

TEST_F(ImageIo, UnsignedChannelsOfAnExrAreCounts) {
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

TEST_F(ImageIo, PfmKeepsEveryBitAndTheRowsOrder) {
    const Image image = sample_image(7, 5, {"R", "G", "B"});
    write_image(path("a.pfm"), image);
    expect_same_bits(image, read_image(path("a.pfm")));
    const Image grey = sample_image(3, 2, {"Y"});
    write_image(path("g.pfm"), grey);
    expect_same_bits(grey, read_image(path("g.pfm")));
}

TEST_F(ImageIo, PfmIsReadAsTheFormatIsDefined) {
    // Netpbm: rows from the bottom up; a positive scale means big-endian. 1.0f is 3f 80 00 00, 2.0f is 40 00 00 00.
    const std::string one("\x3f\x80\0\0", 4), two("\x40\0\0\0", 4);
    write_bytes("big.pfm", "Pf\n1 2\n1.0\n" + one + two);
    const Image big = read_image(path("big.pfm"));
    EXPECT_EQ(big.at(0, 0, 0), 2.0f);  // the last row in the file is the top
    EXPECT_EQ(big.at(0, 1, 0), 1.0f);
    write_bytes("little.pfm", "Pf 1 1\n-0.5\n" + std::string("\0\0\x80\x3f", 4));
    EXPECT_EQ(read_image(path("little.pfm")).at(0, 0, 0), 0.5f);  // times the scale
}

TEST_F(ImageIo, BadPfmSaysWhatIsWrong) {
    const std::vector<std::pair<std::string, std::string>> cases = {
        {"PF\n2 2\n-1.0\nabc", "cut short"},
        {"PF\n0 2\n-1.0\n", "0x2"},
        {"PF\nx 2\n-1.0\n", "width is 'x'"},
        {"PF\n2 2\n0\n", "scale"},
        {"PF\n", "width is ''"},
        {"PF\n2147483647 2147483647\n-1\n", "cut short"},
        {"PF\n99999999999 2\n-1.0\n", "width"},
        {"PF\n2 -2\n-1.0\n", "2x-2"},
    };
    for (const auto& [bytes, expected] : cases) {
        write_bytes("bad.pfm", bytes);
        const std::string message = message_of([&] { read_image(path("bad.pfm")); }, ExitCode::kBadInput);
        EXPECT_NE(message.find(expected), std::string::npos) << message;
        EXPECT_NE(message.find("bad.pfm"), std::string::npos) << message;
    }
}

TEST_F(ImageIo, PngIsReadAsLightOrAsStored) {
    write_png(path("a.png"), 2, 1, {255, 128, 0, 10, 188, 64});
    const Image stored = read_image(path("a.png"), {.linear = false});
    EXPECT_EQ(stored.encoding, Image::Encoding::kSrgb);
    EXPECT_EQ(stored.storage, Image::Storage::kUint8);
    EXPECT_FLOAT_EQ(stored.at(0, 0, 1), 128.0f / 255.0f);
    const Image light = read_image(path("a.png"));
    EXPECT_EQ(light.encoding, Image::Encoding::kLinear);
    // IEC 61966-2-1: ((128/255 + 0.055) / 1.055)^2.4 and (10/255) / 12.92
    EXPECT_NEAR(light.at(0, 0, 1), 0.215861f, 1e-6f);
    EXPECT_NEAR(light.at(1, 0, 0), 0.00303527f, 1e-8f);
    EXPECT_EQ(light.at(0, 0, 0), 1.0f);
}

TEST_F(ImageIo, UnreadableFilesAreNamedWithTheReason) {
    EXPECT_NE(message_of([&] { read_image(path("none.exr")); }, ExitCode::kBadInput).find("No such file"),
              std::string::npos);
    EXPECT_NE(message_of([&] { read_image(folder_.string()); }, ExitCode::kBadInput).find("folder"), std::string::npos);
    write_bytes("empty.png", "");
    EXPECT_NE(message_of([&] { read_image(path("empty.png")); }, ExitCode::kBadInput).find("empty"), std::string::npos);
    write_bytes("noise.exr", "this is no picture at all, whatever its name says");
    EXPECT_NE(message_of([&] { read_image(path("noise.exr")); }, ExitCode::kBadInput).find("noise.exr"),
              std::string::npos);
    // A whole file that was cut in the middle.
    write_image(path("whole.exr"), sample_image(200, 200, {"R", "G", "B"}));
    fs::resize_file(path("whole.exr"), fs::file_size(path("whole.exr")) / 2);
    EXPECT_NE(message_of([&] { read_image(path("whole.exr")); }, ExitCode::kBadInput).find("whole.exr"),
              std::string::npos);
}

TEST_F(ImageIo, UnknownExtensionListsTheKnownOnes) {
    const std::string message = message_of(
        [&] {
            write_image(path("a.gif"), sample_image(4, 4, {"R", "G", "B"}));
        },
        ExitCode::kBadInput);
    EXPECT_NE(message.find(".exr, .pfm, .png"), std::string::npos) << message;
    EXPECT_THROW(check_image_output(path("missing-folder/a.exr")), InputError);
    EXPECT_NO_THROW(check_image_output(path("a.EXR")));
    EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(ImageIo, AFullDiskIsToldAndTheImageSaved) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "this machine has no /dev/full";
    fs::create_symlink("/dev/full", path("full.exr"));
    const Image image = sample_image(8, 8, {"R", "G", "B"});
    const std::string message = message_of([&] { write_image(path("full.exr"), image); }, ExitCode::kMachineCannot);
    EXPECT_NE(message.find("No space left on device"), std::string::npos) << message;
    const size_t begin = message.find("saved as '");
    ASSERT_NE(begin, std::string::npos) << message;
    const std::string saved = message.substr(begin + 10, message.size() - begin - 11);
    expect_same_bits(image, read_image(saved));
    fs::remove(saved);
}

TEST_F(ImageIo, AFailedWriteLeavesTheOldFileAlone) {
    const std::string target = path("kept.txt");
    write_file_atomically(target, "first");
    // A limit on file sizes makes write() fail half-way, in a process of its own.
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        ::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{1000, 1000};
        ::setrlimit(RLIMIT_FSIZE, &limit);
        int result = 1;
        try {
            write_file_atomically(target, std::string(100000, 'x'));
        } catch (const MachineError& error) {
            result = std::string(error.what()).find("File too large") != std::string::npos ? 42 : 2;
        }
        ::_exit(result);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(WEXITSTATUS(status), 42);
    std::ifstream file(target);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "first");
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()),
              1);  // no temporary file is left
}

TEST_F(ImageIo, AFolderWithoutPermissionIsTold) {
    fs::create_directory(path("closed"));
    fs::permissions(path("closed"),
                    fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
    fs::permissions(folder_.path(), fs::perms::all);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        if (::geteuid() == 0 && ::seteuid(65534) != 0) ::_exit(3);  // root may write anywhere
        int result = 1;
        try {
            check_image_output(path("closed/a.exr"));
        } catch (const MachineError& error) {
            result = std::string(error.what()).find("Permission denied") != std::string::npos ? 42 : 2;
        } catch (const std::exception&) {
            result = 4;
        }
        ::_exit(result);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(WEXITSTATUS(status), 42);
}

}  // namespace
}  // namespace lampyris
