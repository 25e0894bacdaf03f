// OpenEXR files, by the format's own library.
#pragma once

#include "core/image/image_io.h"

#include <string>
#include <vector>

namespace lampyris {

bool is_exr(const std::string& path);
// The first part of a file. Channels of a layer in the order R, G, B, A or X, Y, Z, as OpenImageIO has them; string attributes
// are metadata. Throws InputError without the file's name, and MachineError beyond `max_memory` (ReadOptions).
Image read_exr(const std::string& path, uint64_t max_memory);
// Counts in `result` what half floats had to clamp. Throws MachineError if OpenEXR refuses.
std::vector<unsigned char> encode_exr(const Image& image, const WriteOptions& options, WriteResult& result);

// How many threads pack and unpack; they start with the first call. Internal to the two files.
int exr_threads();

}  // namespace lampyris
