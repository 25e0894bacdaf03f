// Which of a backend's devices `--device` means.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace lampyris {

// A number is an index; anything else is a part of a name, in upper or lower case. Empty: the first device. Throws a
// MachineError that lists the devices.
size_t choose_device(std::span<const std::string> names, const std::string& wish, const std::string& backend);

}  // namespace lampyris
