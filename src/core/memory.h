// How much memory there is, so that what cannot fit is refused before the system ends the process.
#pragma once

#include <cstdint>

namespace lampyris {

// Bytes of the machine, or of the container that the process runs in where that has a limit.
uint64_t machine_memory();

}  // namespace lampyris
