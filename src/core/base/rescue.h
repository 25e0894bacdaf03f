// What took hours to make is not lost because a disk is full, or a folder has been removed meanwhile.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace lampyris {

// write_file_atomically; if that fails, the bytes are saved in one of the folders for temporary files, or in the user's or the working
// one, under a name that nobody can foretell. The MachineError that is thrown says where, as "the WHAT was saved as ...".
void write_file_or_rescue(const std::string& path, std::span<const std::byte> bytes, const std::string& what);

}  // namespace lampyris
