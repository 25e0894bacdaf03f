// Reads images, by what the files hold, whatever their names say.
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/image/exr.h"
#include "core/image/image_io.h"
#include "core/image/other_formats.h"
#include "core/image/pfm.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace lampyris {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, const std::string& why) {
    throw InputError(fmt::format("cannot read the image '{}': {}", path, why));
}

bool is_pfm(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    char magic[3] = {};
    file.read(magic, 3);
    return file && magic[0] == 'P' && (magic[1] == 'F' || magic[1] == 'f') &&
           std::isspace(static_cast<unsigned char>(magic[2]));
}

Image read_pfm(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::vector<std::byte> bytes(size_t(fs::file_size(path)));
    file.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size()));
    if (!file) throw InputError(std::strerror(errno));
    return decode_pfm(bytes);
}

Image read_by_contents(const std::string& path, uint64_t max_memory) {
    try {
        if (is_pfm(path)) return read_pfm(path);
        return is_exr(path) ? read_exr(path, max_memory) : other_formats().read(path, max_memory);
    } catch (const InputError& error) {
        fail(path, error.what());
    }
}

}  // namespace

Image read_image(const std::string& path, const ReadOptions& options) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) fail(path, error ? error.message() : std::strerror(ENOENT));
    if (const std::string why = why_not_readable(path); !why.empty()) fail(path, why);
    if (std::FILE* file = std::fopen(path.c_str(), "rb")) {
        std::fclose(file);
    } else {
        fail(path, std::strerror(errno));
    }
    if (fs::is_regular_file(status) && fs::file_size(path) == 0) fail(path, "it is empty");
    Image image = read_by_contents(path, options.max_memory);
    if (options.linear) make_linear(image);
    if (!options.rgb) return image;
    try {
        return image.rgb();
    } catch (const InputError& missing) {
        fail(path, missing.what());
    }
}

}  // namespace lampyris
