#include "core/base/library_beside.h"

#include <dlfcn.h>

#include <filesystem>

namespace lampyris {

void* function_of_library_beside(const char* library, const char* function, std::string& why) {
    Dl_info here{};
    dladdr(reinterpret_cast<const void*>(&function_of_library_beside), &here);
    const std::string path =
        (std::filesystem::path(here.dli_fname ? here.dli_fname : "").parent_path() / library).string();
    void* const loaded = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    void* const found = loaded ? dlsym(loaded, function) : nullptr;
    if (!found) why = dlerror();
    return found;
}

}  // namespace lampyris
