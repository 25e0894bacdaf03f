// A look at the header of an OpenEXR file before it is read. Internal to exr_read.cpp.
#pragma once

#include <string>

namespace lampyris {

// Throws an InputError if the header is damaged, or names more tiles than the file can hold. The C++ interface of OpenEXR 3.1
// makes room for whatever a header claims, gigabytes, before it reads it; its core library, which looks here, compares with the file's size.
void check_exr_header(const std::string& path);

}  // namespace lampyris
