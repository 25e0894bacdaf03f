// Libraries that are part of Lampyris, and are loaded when they are needed.
#pragma once

#include <string>

namespace lampyris {

// A function of a library in this one's folder; the library stays loaded. Null, and why, if there is none.
void* function_of_library_beside(const char* library, const char* function, std::string& why);

}  // namespace lampyris
