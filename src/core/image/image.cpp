#include "core/image/image.h"

#include "core/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lampyris {

Image::Image(int w, int h, std::vector<std::string> names)
    : width(w), height(h), channels(int(names.size())), channel_names(std::move(names)) {
    if (width <= 0 || height <= 0 || channels == 0)
        throw InputError(fmt::format("an image of {}x{} pixels and {} channels holds nothing", w, h, channels));
    pixels.resize(pixel_count() * size_t(channels));
}

int Image::find_channel(std::string_view name) const {
    for (int i = 0; i < channels; ++i)
        if (channel_names[size_t(i)] == name) return i;
    return -1;
}

std::string Image::size_text() const { return fmt::format("{}x{}", width, height); }

static Image like(const Image& image, std::vector<std::string> names) {
    Image result(image.width, image.height, std::move(names));
    result.metadata = image.metadata;
    result.encoding = image.encoding;
    result.storage = image.storage;
    result.x = image.x;
    result.y = image.y;
    result.full_width = image.full_width;
    result.full_height = image.full_height;
    return result;
}

static Image gather(const Image& image, std::vector<std::string> names, const std::vector<int>& from) {
    Image result = like(image, std::move(names));
    const size_t count = image.pixel_count();
    for (size_t i = 0; i < count; ++i)
        for (size_t c = 0; c < from.size(); ++c)
            result.pixels[i * from.size() + c] = image.pixels[i * size_t(image.channels) + size_t(from[c])];
    return result;
}

Image Image::select(const std::vector<std::string>& names) const {
    std::vector<int> from;
    for (const std::string& name : names) {
        from.push_back(find_channel(name));
        if (from.back() < 0)
            throw InputError(
                fmt::format("there is no channel '{}'; the channels are {}", name, list_of(channel_names)));
    }
    return gather(*this, names, from);
}

Image Image::rgb() const {
    const int r = find_channel("R"), g = find_channel("G"), b = find_channel("B"), y = find_channel("Y");
    if (r >= 0 && g >= 0 && b >= 0) return gather(*this, {"R", "G", "B"}, {r, g, b});
    if (y >= 0) return gather(*this, {"R", "G", "B"}, {y, y, y});
    // A single colour channel of any name, with or without alpha, is grey.
    int only = -1, colours = 0;
    for (int i = 0; i < channels; ++i)
        if (channel_names[size_t(i)] != "A") only = i, ++colours;
    if (colours == 1) return gather(*this, {"R", "G", "B"}, {only, only, only});
    throw InputError(
        fmt::format("there are no channels R, G, B and no grey one; the channels are {}", list_of(channel_names)));
}

Image Image::crop(const PixelBounds& bounds) const {
    if (bounds.x0 < 0 || bounds.y0 < 0 || bounds.x1 > width || bounds.y1 > height || bounds.x0 >= bounds.x1 ||
        bounds.y0 >= bounds.y1)
        throw InputError(
            fmt::format("the crop {},{},{},{} (x0,y0,x1,y1 in pixels, x1 and y1 excluded) is empty or not inside the "
                        "image, which has {} pixels",
                        bounds.x0, bounds.y0, bounds.x1, bounds.y1, size_text()));
    Image result = *this;
    result.width = bounds.width();
    result.height = bounds.height();
    result.x = x + bounds.x0;
    result.y = y + bounds.y0;
    if (full_width == 0) {
        result.full_width = width;
        result.full_height = height;
    }
    result.pixels.clear();
    for (int row = bounds.y0; row < bounds.y1; ++row)
        result.pixels.insert(
            result.pixels.end(), pixels.begin() + std::ptrdiff_t(index(bounds.x0, row, 0)),
            pixels.begin() + std::ptrdiff_t(index(bounds.x0, row, 0)) + std::ptrdiff_t(bounds.width()) * channels);
    return result;
}

void Image::cut_to_window_of(const Image& window) {
    const bool is_cut_out = window.full_width > window.width || window.full_height > window.height;
    if (!is_cut_out || full_width != 0 || width != window.full_width || height != window.full_height) return;
    // A data window may extend beyond the picture (overscan); pixels there are not part of the full image.
    if (window.x < 0 || window.y < 0 || window.x + window.width > width || window.y + window.height > height) return;
    *this = crop({window.x, window.y, window.x + window.width, window.y + window.height});
}

void Image::add_channels(const std::vector<std::string>& names, const std::vector<float>& values) {
    const size_t added = names.size(), before = size_t(channels), count = pixel_count();
    if (values.size() != count * added)
        throw InputError(
            fmt::format("{} values do not make {} channels of {} pixels", values.size(), added, size_text()));
    std::vector<float> merged(count * (before + added));
    for (size_t i = 0; i < count; ++i) {
        float* to = merged.data() + i * (before + added);
        std::copy_n(pixels.data() + i * before, before, to);
        std::copy_n(values.data() + i * added, added, to + before);
    }
    pixels = std::move(merged);
    channel_names.insert(channel_names.end(), names.begin(), names.end());
    channels = int(channel_names.size());
}

float srgb_from_linear(float linear) {
    const float v = std::fabs(linear);
    const float encoded = v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
    return std::copysign(encoded, linear);
}

float linear_from_srgb(float encoded) {
    const float v = std::fabs(encoded);
    const float linear = v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
    return std::copysign(linear, encoded);
}

void make_linear(Image& image) {
    if (image.encoding == Image::Encoding::kLinear) return;
    const int alpha = image.find_channel("A");
    for (size_t i = 0; i < image.pixels.size(); ++i)
        if (int(i % size_t(image.channels)) != alpha) image.pixels[i] = linear_from_srgb(image.pixels[i]);
    image.encoding = Image::Encoding::kLinear;
}

}  // namespace lampyris
