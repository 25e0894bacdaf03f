#include "core/image/other_formats.h"

#include "core/base/error.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <filesystem>

extern "C" __attribute__((weak)) const lampyris::OtherFormats* lampyris_other_formats();

namespace lampyris {
namespace {

constexpr const char* kLibrary = "liblampyris_formats.so";

// The library lies beside this one.
const OtherFormats* load() {
    Dl_info here{};
    dladdr(reinterpret_cast<const void*>(&other_formats), &here);
    const std::string path =
        (std::filesystem::path(here.dli_fname ? here.dli_fname : "").parent_path() / kLibrary).string();
    void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    void* function = library ? dlsym(library, "lampyris_other_formats") : nullptr;
    if (!function)
        throw MachineError(
            fmt::format("error: images other than OpenEXR and PFM need the library {}, which cannot be loaded: {}",
                        kLibrary, dlerror()));
    return reinterpret_cast<const OtherFormats* (*)()>(function)();
}

}  // namespace

const OtherFormats& other_formats() {
    static const OtherFormats* const formats = lampyris_other_formats ? lampyris_other_formats() : load();
    return *formats;
}

}  // namespace lampyris
