// For tests of images in files: a folder of their own, and pictures that show any mistake.
#pragma once

#include "core/base/error.h"
#include "core/image/image_io.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <bit>
#include <fstream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace lampyris::test {

class ImageFiles : public testing::Test {
 protected:
    std::string path(const std::string& name) const { return folder_ / name; }
    void write_bytes(const std::string& name, const std::string& bytes) const {
        std::ofstream(path(name), std::ios::binary) << bytes;
    }
    const TemporaryFolder folder_;
};

// No two pixels or channels alike, and negative, tiny, huge and non-finite numbers among them.
inline Image sample_image(int width, int height, std::vector<std::string> names) {
    Image image(width, height, std::move(names));
    for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = float(i) * 0.37f - 3.0f;
    image.pixels[0] = std::numeric_limits<float>::infinity();
    image.pixels[1] = 1e-42f;
    image.pixels[2] = 3e38f;
    image.pixels[4] = std::numeric_limits<float>::quiet_NaN();
    return image;
}

inline void expect_same_bits(const Image& a, const Image& b) {
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

}  // namespace lampyris::test
