// Whether there is room for what an image's header promises.
#pragma once

#include <cstdint>
#include <string>

namespace lampyris {

// Throws an InputError, without the file's name, if a header promises far more pixels than the file or the machine can hold;
// MachineError if they would make the process larger than `max_memory` bytes (0: no limit). `value_bytes`: of a pixel's channel in the file.
void check_plausible(const std::string& path, int64_t width, int64_t height, int64_t channels, int64_t value_bytes,
                     uint64_t max_memory);

}  // namespace lampyris
