#include "core/image/pfm.h"

#include "core/base/error.h"

#include <fmt/format.h>

#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>

namespace lampyris {

static_assert(std::endian::native == std::endian::little, "the writer copies floats as they lie in memory");

std::vector<unsigned char> encode_pfm(const Image& image) {
    if (image.channels != 1 && image.channels != 3)
        throw InputError(fmt::format("PFM holds one or three channels, not {}", image.channels));
    // A negative scale means little-endian.
    const std::string header =
        fmt::format("{}\n{} {}\n-1.0\n", image.channels == 3 ? "PF" : "Pf", image.width, image.height);
    const size_t row_bytes = size_t(image.width) * size_t(image.channels) * sizeof(float);
    std::vector<unsigned char> bytes(header.size() + row_bytes * size_t(image.height));
    std::memcpy(bytes.data(), header.data(), header.size());
    for (int y = 0; y < image.height; ++y)
        std::memcpy(bytes.data() + header.size() + row_bytes * size_t(image.height - 1 - y),
                    &image.pixels[image.index(0, y, 0)], row_bytes);
    return bytes;
}

Image decode_pfm(std::span<const std::byte> bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    size_t position = 0;
    // Words are separated by white space; exactly one white-space byte ends the header.
    const auto next_word = [&] {
        while (position < text.size() && std::isspace(static_cast<unsigned char>(text[position]))) ++position;
        const size_t begin = position;
        while (position < text.size() && !std::isspace(static_cast<unsigned char>(text[position]))) ++position;
        return text.substr(begin, position - begin);
    };
    const auto number = [&](auto& value, const char* what) {
        const std::string_view word = next_word();
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size())
            throw InputError(fmt::format("the PFM header's {} is '{}', not a number", what, word.substr(0, 40)));
    };
    const std::string_view magic = next_word();
    if (magic != "PF" && magic != "Pf") throw InputError("a PFM file begins with PF or Pf");
    const int channels = magic == "PF" ? 3 : 1;
    int width = 0, height = 0;
    float scale = 0.0f;
    number(width, "width");
    number(height, "height");
    number(scale, "scale");
    if (width <= 0 || height <= 0) throw InputError(fmt::format("the PFM header says {}x{} pixels", width, height));
    if (!std::isfinite(scale) || scale == 0.0f)
        throw InputError("the PFM header's scale is neither positive (big-endian) nor negative (little-endian)");
    ++position;
    const size_t row_values = size_t(width) * size_t(channels);
    const size_t available = position < text.size() ? (text.size() - position) / sizeof(float) : 0;
    if (available / row_values < size_t(height))
        throw InputError(fmt::format(
            "the PFM file is cut short: {}x{} pixels of {} channels need {} bytes, and {} follow the header", width,
            height, channels, row_values * size_t(height) * sizeof(float),
            position < text.size() ? text.size() - position : 0));
    Image image(width, height, channels == 3 ? std::vector<std::string>{"R", "G", "B"} : std::vector<std::string>{"Y"});
    const bool swap = scale > 0.0f;
    const float factor = std::fabs(scale);
    for (int y = 0; y < height; ++y) {
        float* row = &image.pixels[image.index(0, y, 0)];
        std::memcpy(row, bytes.data() + position + size_t(height - 1 - y) * row_values * sizeof(float),
                    row_values * sizeof(float));
        for (size_t i = 0; i < row_values; ++i) {
            if (swap) row[i] = std::bit_cast<float>(__builtin_bswap32(std::bit_cast<uint32_t>(row[i])));
            if (factor != 1.0f) row[i] *= factor;
        }
    }
    return image;
}

}  // namespace lampyris
