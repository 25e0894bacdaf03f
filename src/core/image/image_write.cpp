// Writes images. Each is encoded in memory first, so that our own function writes the bytes, and can say why the disk refused
// them.
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/rescue.h"
#include "core/image/exr.h"
#include "core/image/image_io.h"
#include "core/image/other_formats.h"
#include "core/image/pfm.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <span>

namespace lampyris {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<unsigned char>;

std::string extension_of(const std::string& path) {
    std::string extension = fs::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    const std::vector<std::string>& known = writable_extensions();
    if (std::find(known.begin(), known.end(), extension) == known.end())
        throw InputError(fmt::format("cannot write '{}': its extension is none of the formats that can be written: {}",
                                     path, list_of(known)));
    return extension;
}

void write(const std::string& path, const Bytes& bytes) {
    write_file_or_rescue(path, std::as_bytes(std::span(bytes)), "image");
}

}  // namespace

const std::vector<std::string>& writable_extensions() {
    static const std::vector<std::string> list{".exr", ".pfm", ".png"};
    return list;
}

void check_image_output(const std::string& path, const WriteOptions& options) {
    if (extension_of(path) == ".png") other_formats();  // a library that is missing is told before the work is done
    check_view(options.view);
    check_writable(path);
}

WriteResult write_image(const std::string& path, const Image& image, const WriteOptions& options) {
    const std::string extension = extension_of(path);
    WriteResult result;
    Bytes bytes;
    if (extension == ".exr") {
        bytes = encode_exr(image, options, result);
    } else if (extension == ".pfm") {
        bytes = encode_pfm(image.channels == 1 ? image : image.rgb());
    } else {
        bytes = other_formats().encode_png(image.width, image.height,
                                           display_bytes(image.rgb(), options.view, options.exposure), image.metadata);
    }
    write(path, bytes);
    return result;
}

void write_png(const std::string& path, int width, int height, const std::vector<uint8_t>& rgb,
               const std::map<std::string, std::string>& metadata) {
    if (extension_of(path) != ".png")
        throw InputError(fmt::format("cannot write '{}': this picture is written as .png only", path));
    write(path, other_formats().encode_png(width, height, rgb, metadata));
}

}  // namespace lampyris
