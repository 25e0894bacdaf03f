// Writes images. Each is encoded in memory first, so that our own function writes the bytes, and can say why the disk refused
// them.
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/rescue.h"
#include "core/image/image_io.h"
#include "core/image/pfm.h"

#include <fmt/format.h>
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <memory>
#include <span>

namespace lampyris {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<unsigned char>;

constexpr float kLargestHalf = 65504.0f;

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

void add_metadata(OIIO::ImageSpec& spec, const std::map<std::string, std::string>& metadata) {
    for (const auto& [name, value] : metadata)
        if (name != "compression" && name.rfind("oiio:", 0) != 0 && name.rfind("openexr:", 0) != 0)
            spec.attribute(name, value);
}

Bytes encode(const char* format, const OIIO::ImageSpec& spec, const OIIO::TypeDesc& type, const void* pixels) {
    const std::string name = std::string("memory.") + format;
    Bytes buffer;
    OIIO::Filesystem::IOVecOutput memory(buffer);
    const auto output = OIIO::ImageOutput::create(name);
    if (!output) throw MachineError(fmt::format("OpenImageIO cannot write {}: {}", format, OIIO::geterror()));
    if (!output->set_ioproxy(&memory) || !output->open(name, spec) || !output->write_image(type, pixels) ||
        !output->close())
        throw MachineError(fmt::format("OpenImageIO cannot write {}: {}", format, output->geterror()));
    return buffer;
}

// Channels for which half floats (11 bits of precision, a range of 65504) suffice.
bool fits_half(const std::string& channel) {
    const std::string layer = channel.substr(0, channel.find('.'));
    return channel.find('.') == std::string::npos
               ? channel == "R" || channel == "G" || channel == "B" || channel == "A" || channel == "Y"
               : layer == "albedo" || layer == "normal";
}

Bytes encode_exr(const Image& image, const WriteOptions& options, WriteResult& result) {
    OIIO::ImageSpec spec(image.width, image.height, image.channels, OIIO::TypeDesc::FLOAT);
    spec.channelnames.assign(image.channel_names.begin(), image.channel_names.end());
    spec.alpha_channel = image.find_channel("A");
    spec.x = image.x;
    spec.y = image.y;
    spec.full_width = image.full_width > 0 ? image.full_width : image.width;
    spec.full_height = image.full_height > 0 ? image.full_height : image.height;
    if (options.tile_size > 0) {
        spec.tile_width = spec.tile_height = options.tile_size;
        spec.tile_depth = 1;
    }
    add_metadata(spec, image.metadata);
    spec.attribute("compression", options.compression);
    const float rec709[8] = {0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};  // R, G, B, white: x, y
    spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), rec709);
    if (!options.half) return encode("exr", spec, OIIO::TypeDesc::FLOAT, image.pixels.data());

    std::vector<float> pixels = image.pixels;
    for (int c = 0; c < image.channels; ++c) {
        const bool half = fits_half(image.channel_names[size_t(c)]);
        spec.channelformats.push_back(half ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
        if (!half) continue;
        for (size_t i = size_t(c); i < pixels.size(); i += size_t(image.channels)) {
            if (!std::isfinite(pixels[i]) || std::fabs(pixels[i]) <= kLargestHalf) continue;
            pixels[i] = std::copysign(kLargestHalf, pixels[i]);
            ++result.clamped;
        }
    }
    return encode("exr", spec, OIIO::TypeDesc::FLOAT, pixels.data());
}

Bytes encode_png(int width, int height, const std::vector<uint8_t>& rgb,
                 const std::map<std::string, std::string>& metadata) {
    OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    add_metadata(spec, metadata);
    return encode("png", spec, OIIO::TypeDesc::UINT8, rgb.data());
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
    extension_of(path);
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
        bytes = encode_png(image.width, image.height, display_bytes(image.rgb(), options.view, options.exposure),
                           image.metadata);
    }
    write(path, bytes);
    return result;
}

void write_png(const std::string& path, int width, int height, const std::vector<uint8_t>& rgb,
               const std::map<std::string, std::string>& metadata) {
    if (extension_of(path) != ".png")
        throw InputError(fmt::format("cannot write '{}': this picture is written as .png only", path));
    write(path, encode_png(width, height, rgb, metadata));
}

}  // namespace lampyris
