// How much memory there is, so that requests that cannot fit are refused before the system kills the process.
#pragma once

#include <cstdint>

namespace lampyris {

// Bytes of the machine, or of the process's container if that has a limit.
uint64_t machine_memory();

}  // namespace lampyris
