// Images to and from files.
//
// Reading: every format that OpenImageIO knows, and PFM. Writing: OpenEXR, PFM and PNG.
#pragma once

#include "core/image/color.h"
#include "core/image/image.h"

#include <cstddef>
#include <string>
#include <vector>

namespace lampyris {

struct ReadOptions {
    // Converts sRGB-encoded colour (integer formats, unless the file says otherwise) to light. Textures pass false: they have
    // an encoding parameter of their own, and Image::encoding has the file's.
    bool linear = true;
    // Only R, G, B (Image::rgb): grey expands, alpha and other channels are dropped.
    bool rgb = false;
    // MachineError if the pixels alone would make the process larger; 0: no limit but the machine's.
    uint64_t max_memory = 0;
};

// Throws an InputError that names the file and says why it cannot be read. Integers are scaled to [0, 1], except unsigned
// 32-bit channels of an EXR: these are counts, and keep their values. Colour is not multiplied by alpha unless the file already
// did that.
Image read_image(const std::string& path, const ReadOptions& options = {});

struct WriteOptions {
    // EXR: 16-bit floats for colour, albedo and normal; every other channel (depth, variance, counts) stays 32-bit.
    bool half = false;
    std::string compression = "zip";  // EXR: none, rle, zip, zips, piz
    int tile_size = 64;               // EXR, in pixels; 0 writes scanlines
    // PNG: how light is shown (color.h). EXR and PFM hold light and ignore these.
    std::string view = kDefaultView;
    float exposure = 0.0f;  // stops
};

struct WriteResult {
    // Number of finite values beyond what a half float can hold (65504), which were clamped to it; EXR with `half` only.
    size_t clamped = 0;
};

// The extensions that write_image knows: ".exr", ".pfm", ".png".
const std::vector<std::string>& writable_extensions();
// Throws InputError for an unknown extension, a folder that does not exist, or an unknown view; MachineError if permission is
// missing. To be called before the work is done.
void check_image_output(const std::string& path, const WriteOptions& options = {});

// Writes in the format of the extension. EXR: every channel, metadata as string attributes, tiled. PFM: R, G, B (or the only
// channel). PNG: R, G, B as the view shows them, 8 bits. The file appears complete or not at all. If it cannot be written (disk
// full, no permission), MachineError says why. The image is then saved elsewhere, if possible, and the message says where
// (core/base/rescue.h).
WriteResult write_image(const std::string& path, const Image& image, const WriteOptions& options = {});

// An 8-bit picture as it is, without a view: [height][width][3], sRGB. For error maps and plots.
void write_png(const std::string& path, int width, int height, const std::vector<uint8_t>& rgb,
               const std::map<std::string, std::string>& metadata = {});

}  // namespace lampyris
