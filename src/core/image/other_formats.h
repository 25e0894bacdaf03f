// The formats other than OpenEXR and PFM.
#pragma once

#include "core/image/image.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace lampyris {

// OpenImageIO brings 250 libraries along, and loading these takes ten times as long as the start of the program without them. So
// what calls it (src/formats) is a library of its own, which is loaded when such a file is first read or written.
struct OtherFormats {
    // Every format that OpenImageIO knows. Throws InputError without the file's name, and MachineError beyond `max_memory`
    // (ReadOptions).
    Image (*read)(const std::string& path, uint64_t max_memory);
    // rgb: [height][width][3], sRGB.
    std::vector<unsigned char> (*encode_png)(int width, int height, const std::vector<uint8_t>& rgb,
                                             const std::map<std::string, std::string>& metadata);
};

// Throws MachineError if the library cannot be loaded.
const OtherFormats& other_formats();

}  // namespace lampyris

// What that library exports. A program may also be linked to src/formats directly.
extern "C" const lampyris::OtherFormats* lampyris_other_formats();
