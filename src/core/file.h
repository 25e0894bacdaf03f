// Whole files, written so that a reader never meets half of one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lampyris {

// Writes a file as a whole: into a temporary file beside it, which is flushed to the disk and then renamed, so that the
// target is either what it was or complete. A link is followed; what is no regular file (a device, a pipe) is written
// directly. Throws MachineError that names the file and the system's reason (disk full, no permission, ...).
void write_file_atomically(const std::string& path, std::span<const std::byte> bytes);
void write_file_atomically(const std::string& path, std::string_view text);

// Throws what write_file_atomically would throw for a reason that can be known beforehand (no such folder: InputError;
// no permission: MachineError), so that an hour of rendering does not end with it. Leaves no trace.
void check_writable(const std::string& path);

// The names of what lies in the folder of `path`, sorted: for guessing what was meant where there is no such file.
std::vector<std::string> files_beside(const std::filesystem::path& path);

}  // namespace lampyris
