#include "core/image/other_formats.h"

#include "core/base/error.h"
#include "core/base/library_beside.h"

#include <fmt/format.h>

#include <string>

extern "C" __attribute__((weak)) const lampyris::OtherFormats* lampyris_other_formats();

namespace lampyris {
namespace {

constexpr const char* kLibrary = "liblampyris_formats.so";

const OtherFormats* load() {
    std::string why;
    void* function = function_of_library_beside(kLibrary, "lampyris_other_formats", why);
    if (!function)
        throw MachineError(fmt::format(
            "error: images other than OpenEXR and PFM need the library {}, which cannot be loaded: {}", kLibrary, why));
    return reinterpret_cast<const OtherFormats* (*)()>(function)();
}

}  // namespace

const OtherFormats& other_formats() {
    static const OtherFormats* const formats = lampyris_other_formats ? lampyris_other_formats() : load();
    return *formats;
}

}  // namespace lampyris
