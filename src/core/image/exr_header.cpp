#include "core/image/exr_header.h"

#include "core/base/error.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace lampyris {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie in the file");

constexpr uint32_t kMultiPart = 0x1000;  // of the version field: several headers, the last one empty

// Ended by a zero byte; names have at most 255 bytes (OpenEXR's file layout).
bool read_name(std::ifstream& file, std::string& name) {
    name.clear();
    for (int c = file.get(); c != std::ifstream::traits_type::eof(); c = file.get()) {
        if (c == 0) return true;
        if (name.size() == 255) return false;
        name += char(c);
    }
    return false;
}

}  // namespace

void check_exr_header(const std::string& path) {
    const auto size = int64_t(std::filesystem::file_size(path));
    std::ifstream file(path, std::ios::binary);
    uint32_t magic = 0, version = 0;
    file.read(reinterpret_cast<char*>(&magic), sizeof magic).read(reinterpret_cast<char*>(&version), sizeof version);
    if (!file) throw InputError("it ends within its header");
    for (bool last = false; !last;) {
        int attributes = 0;
        for (std::string name, type;; ++attributes) {
            if (!read_name(file, name)) throw InputError("its header is damaged");
            if (name.empty()) break;
            int32_t bytes = 0;
            if (!read_name(file, type) || !file.read(reinterpret_cast<char*>(&bytes), sizeof bytes))
                throw InputError("its header is damaged");
            const int64_t left = size - int64_t(file.tellg());
            if (bytes < 0 || bytes > left)
                throw InputError(
                    fmt::format("its attribute '{}' is said to have {} bytes, and {} follow", name, bytes, left));
            file.seekg(bytes, std::ios::cur);
        }
        last = (version & kMultiPart) == 0 || attributes == 0;
    }
}

}  // namespace lampyris
