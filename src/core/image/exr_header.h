// A look at the header of an OpenEXR file before OpenEXR reads it. Internal to exr_read.cpp.
#pragma once

#include <string>

namespace lampyris {

// Throws an InputError unless each attribute lies in the file: OpenEXR 3.1 makes room for as many bytes as a damaged one
// claims, up to 2 GB, before it reads them.
void check_exr_header(const std::string& path);

}  // namespace lampyris
