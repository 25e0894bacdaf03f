// Images to files and back: the data that must survive do, and errors of reading or writing give a reason.
#include "core/image/image_io.h"

#include "core/base/file.h"
#include "core/image/pfm.h"
#include "support/image_files.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>

namespace lampyris::test {
namespace {

namespace fs = std::filesystem;

using ImageIo = ImageFiles;

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

// By what they hold: the names say nothing.
TEST_F(ImageIo, FormatsAreKnownByTheirBytes) {
    const std::string corpus = LAMPYRIS_SOURCE_DIR "/tests/fuzz/corpus/image/";
    for (const char* name :
         {"tiny.jpg", "tiny.tif", "tiny.png", "tiny.bmp", "tiny.tga", "tiny.hdr", "tiny.pfm", "picture.ppm"}) {
        fs::copy_file(corpus + name, path("picture.exr"), fs::copy_options::overwrite_existing);
        const Image image = read_image(path("picture.exr"));
        EXPECT_GT(image.width * image.height, 0) << name;
    }
    const Image tiff = read_image(corpus + "tiny.tif", {.linear = false});
    ASSERT_EQ(tiff.width, 4);
    EXPECT_FLOAT_EQ(tiff.at(3, 2, 0), 180.0f / 255.0f);
    EXPECT_FLOAT_EQ(tiff.at(3, 2, 1), 160.0f / 255.0f);
    // Others that OpenImageIO would try, and what it would crash on.
    for (const auto& [bytes, said] :
         std::vector<std::pair<std::string, std::string>>{{"GIF89a" + std::string(64, '\1'), "its format is not known"},
                                                          {"8BPS" + std::string(64, '\1'), "its format is not known"},
                                                          {"DDS " + std::string(200, '\1'), "its format is not known"},
                                                          {"BM", "its header is damaged"}}) {
        write_bytes("other.png", bytes);
        EXPECT_NE(message_of([&] { read_image(path("other.png")); }, ExitCode::kBadInput).find(said),
                  std::string::npos);
    }
    EXPECT_NE(message_of([&] { read_image(corpus + "packed.bmp"); }, ExitCode::kBadInput).find("compressed BMP"),
              std::string::npos);
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
}  // namespace lampyris::test
