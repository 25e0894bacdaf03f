#pragma once

namespace lampyris {

// "0.1.0", as CMake's project() has it: the one place where it is written.
const char* version();

}  // namespace lampyris
