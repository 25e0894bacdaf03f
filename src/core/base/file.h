// Reading and writing whole files, so that a reader never sees half of one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lampyris {

// Writes a file as a whole: into a file without a name in the same folder, which is flushed to the disk and then takes the target's
// place, so that the target is either unchanged or complete, and nothing is left behind by a program that is killed. A link is
// followed; anything but a regular file (a device, a pipe) is written directly.
// Throws a MachineError that names the file and the system's reason (disk full, no permission, ...).
void write_file_atomically(const std::string& path, std::span<const std::byte> bytes);
void write_file_atomically(const std::string& path, std::string_view text);

// Throws what write_file_atomically would throw for reasons that can be known beforehand (no such folder: InputError; no
// permission: MachineError), so that they do not surface after an hour of rendering. Leaves no trace.
void check_writable(const std::string& path);

// Nothing if the path leads to a regular file, or to nothing: opening it tells why. Else what is there: reading a pipe or a device may
// never end.
std::string why_not_readable(const std::string& path);

// The absolute path without links, also of what does not exist yet, and beyond links that lead to nothing; empty if that cannot
// be told.
std::string real_path(const std::filesystem::path& path);

// The names of the files in the folder of `path`, sorted: for suggestions if there is no such file.
std::vector<std::string> files_beside(const std::filesystem::path& path);

}  // namespace lampyris
