// An image in memory: floats, row by row from the top, channels interleaved and known by name.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace lampyris {

// A rectangle of pixels, half-open: x0 <= x < x1, y0 <= y < y1.
struct PixelBounds {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
};

struct Image {
    // The meaning of the numbers in `pixels`: light, or light encoded for a display with sRGB's curve (IEC 61966-2-1).
    enum class Encoding { kLinear, kSrgb };
    // The number format in the file that the image was read from.
    enum class Storage { kUint8, kUint16, kUint32, kHalf, kFloat };

    int width = 0;
    int height = 0;
    int channels = 0;
    std::vector<std::string> channel_names;  // as in an EXR: "R", "G", "B", "A", "Y", "albedo.R", "depth.Z"
    std::vector<float> pixels;  // [height][width][channels]; scene-linear Rec.709 unless `encoding` says otherwise
    std::map<std::string, std::string> metadata;  // attributes of the file
    Encoding encoding = Encoding::kLinear;
    Storage storage = Storage::kFloat;
    // The position of the pixels in the full picture, if they are a part of it (EXR: data and display window). A full size of 0
    // means that these pixels are the full picture.
    int x = 0, y = 0, full_width = 0, full_height = 0;

    Image() = default;
    // Black. Throws InputError unless 0 < width, height and there is at least one name.
    Image(int width, int height, std::vector<std::string> names);

    size_t pixel_count() const { return size_t(width) * size_t(height); }
    size_t index(int px, int py, int channel) const {
        return (size_t(py) * size_t(width) + size_t(px)) * size_t(channels) + size_t(channel);
    }
    float& at(int px, int py, int channel) { return pixels[index(px, py, channel)]; }
    float at(int px, int py, int channel) const { return pixels[index(px, py, channel)]; }

    int find_channel(std::string_view name) const;  // -1 where there is none
    // The named channels, in that order. If one is missing, throws an InputError that names it and lists those that exist.
    Image select(const std::vector<std::string>& names) const;
    // R, G, B (by name, whatever their order); one grey channel ("Y", or a single one) becomes three equal ones.
    // Throws InputError where the image has neither.
    Image rgb() const;
    // The pixels inside `bounds`, in this image's pixel coordinates. Throws InputError unless 0 <= x0 < x1 <= width,
    // ...
    Image crop(const PixelBounds& bounds) const;
    // If `window` is a part of a picture of this image's size, keeps only the pixels that it has; otherwise does nothing.
    void cut_to_window_of(const Image& window);
    // Appends channels to every pixel; `values` is [height][width][names.size()].
    void add_channels(const std::vector<std::string>& names, const std::vector<float>& values);
    std::string size_text() const;  // "640x480"
};

// sRGB's transfer function (IEC 61966-2-1) and its inverse, extended to negative numbers by symmetry.
float srgb_from_linear(float linear);
float linear_from_srgb(float encoded);
// Converts sRGB-encoded colour to light, except alpha ("A"). Does nothing to an image that is linear already.
void make_linear(Image& image);

}  // namespace lampyris
