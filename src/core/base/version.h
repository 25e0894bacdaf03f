#pragma once

namespace lampyris {

// "0.1.0", from CMake's project(), the only place where it is defined.
const char* version();

}  // namespace lampyris
