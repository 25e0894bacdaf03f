// PFM, the portable float map (netpbm's format "PF" for RGB and "Pf" for grey): text header, then floats from the
// bottom row up. OpenImageIO 2.4 cannot write it.
#pragma once

#include "core/image/image.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace lampyris {

// `image` must have one or three channels; their names are not stored. Little-endian, scale 1. Every float survives, bit by
// bit.
std::vector<unsigned char> encode_pfm(const Image& image);
// Reads either byte order. The values are multiplied by the header's scale, as in pbrt. Throws an InputError that says what is
// wrong with the file, without the file's name.
Image decode_pfm(std::span<const std::byte> bytes);

}  // namespace lampyris
