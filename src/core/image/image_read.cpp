// Reads images: OpenImageIO for everything but PFM.
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/image/image_io.h"
#include "core/image/pfm.h"
#include "core/image/primaries.h"

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>

namespace lampyris {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, const std::string& why) {
    throw InputError(fmt::format("cannot read the image '{}': {}", path, why));
}

std::string trimmed(std::string text) {
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
    return text;
}

// OpenImageIO's message, cut to its first line, without the file's name, which our message already has.
std::string reason(const std::string& message, const std::string& path) {
    std::string text = trimmed(message.substr(0, message.find('\n')));
    if (const size_t at = text.find('"' + path + '"'); at != std::string::npos) text.replace(at, path.size() + 2, "it");
    return text.empty() ? "its format is not known, or it is damaged" : text;
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
    if (!file) fail(path, std::strerror(errno));
    try {
        return decode_pfm(bytes);
    } catch (const InputError& error) {
        fail(path, error.what());
    }
}

Image::Storage storage_of(const OIIO::TypeDesc& type) {
    switch (type.basetype) {
        case OIIO::TypeDesc::UINT8:
        case OIIO::TypeDesc::INT8: return Image::Storage::kUint8;
        case OIIO::TypeDesc::UINT16:
        case OIIO::TypeDesc::INT16: return Image::Storage::kUint16;
        case OIIO::TypeDesc::UINT32:
        case OIIO::TypeDesc::INT32: return Image::Storage::kUint32;
        case OIIO::TypeDesc::HALF: return Image::Storage::kHalf;
        default: return Image::Storage::kFloat;
    }
}

// A header that promises far more than the file can hold is damaged or hostile; trusting it would exhaust memory. No format
// here packs more than about 8000 to 1 (deflate's 1032, times eight for one-bit pixels).
void check_plausible(const std::string& path, const OIIO::ImageSpec& spec, uint64_t max_memory) {
    constexpr uint64_t kFree = uint64_t(64) << 20, kMostPacked = 20000;
    const uint64_t promised = uint64_t(spec.image_bytes(true)), held = uint64_t(fs::file_size(path));
    if (promised > kFree && promised / kMostPacked > held)
        fail(path, fmt::format("its header says {}x{} pixels of {} channels, but the file has only {} bytes",
                               spec.width, spec.height, spec.nchannels, held));
    // The pixels as floats, plus their packed form.
    const double needed = 2.0 * sizeof(float) * double(spec.width) * double(spec.height) * double(spec.nchannels);
    if (needed > double(machine_memory()))
        fail(path,
             fmt::format("{}x{} pixels of {} channels need {:.1f} GB, and this machine has {:.1f} GB of memory",
                         spec.width, spec.height, spec.nchannels, needed * 1e-9, double(machine_memory()) * 1e-9));
    if (max_memory > 0 && needed + double(process_memory()) > double(max_memory))
        throw MachineError(
            fmt::format("error: the image '{}' has {}x{} pixels of {} channels, which need {} MiB, and --max-memory "
                        "allows {} MiB for the whole program",
                        path, spec.width, spec.height, spec.nchannels, uint64_t(needed) >> 20, max_memory >> 20));
}

// Colour of an EXR with primaries other than Rec.709's (its attribute "chromaticities") is converted to Rec.709.
void make_rec709(Image& image, const OIIO::ImageSpec& spec) {
    float c[8];
    if (!spec.getattribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), c)) return;
    const Primaries primaries{{c[0], c[1]}, {c[2], c[3]}, {c[4], c[5]}, {c[6], c[7]}};
    const glm::dmat3 matrix = rec709_from_rgb(primaries);
    const int r = image.find_channel("R"), g = image.find_channel("G"), b = image.find_channel("B");
    double off = 0.0;
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) off = std::max(off, std::abs(matrix[i][k] - (i == k ? 1.0 : 0.0)));
    if (r < 0 || g < 0 || b < 0 || !std::isfinite(off) || off < 1e-3) return;
    for (size_t i = 0; i < image.pixel_count(); ++i) {
        float* p = &image.pixels[i * size_t(image.channels)];
        const glm::dvec3 rgb = matrix * glm::dvec3(p[r], p[g], p[b]);
        p[r] = float(rgb.x), p[g] = float(rgb.y), p[b] = float(rgb.z);
    }
}

Image read_with_openimageio(const std::string& path, uint64_t max_memory) {
    OIIO::ImageSpec hints;
    hints["oiio:UnassociatedAlpha"] = 1;  // do not multiply colour by alpha
    const auto input = OIIO::ImageInput::open(path, &hints);
    if (!input) fail(path, reason(OIIO::geterror(), path));
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.deep) fail(path, "it is a deep image, which has no single value per pixel");
    if (spec.depth > 1) fail(path, "it is a volume, not an image");
    if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0) fail(path, "it has no pixels");
    check_plausible(path, spec, max_memory);

    Image image(spec.width, spec.height, {spec.channelnames.begin(), spec.channelnames.end()});
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.pixels.data()))
        fail(path, reason(input->geterror(), path));
    image.storage = storage_of(spec.format);
    const bool is_integer = !spec.format.is_floating_point();
    if (!is_integer) make_rec709(image, spec);
    if (std::string_view(input->format_name()) == "openexr") {
        // OpenImageIO scales unsigned integers to [0, 1]; in an EXR they are counts.
        for (int c = 0; c < spec.nchannels; ++c)
            if (spec.channelformat(c).basetype == OIIO::TypeDesc::UINT32)
                for (size_t i = size_t(c); i < image.pixels.size(); i += size_t(spec.nchannels))
                    image.pixels[i] *= 4294967295.0f;
    } else if (is_integer) {
        const std::string space = spec.get_string_attribute("oiio:ColorSpace");
        image.encoding = space == "Linear" || space == "linear" ? Image::Encoding::kLinear : Image::Encoding::kSrgb;
    }
    if (spec.full_width != spec.width || spec.full_height != spec.height || spec.x != spec.full_x ||
        spec.y != spec.full_y) {
        image.x = spec.x - spec.full_x;
        image.y = spec.y - spec.full_y;
        image.full_width = spec.full_width;
        image.full_height = spec.full_height;
    }
    for (const auto& attribute : spec.extra_attribs) {
        const std::string name = attribute.name().string();
        if (attribute.type() == OIIO::TypeDesc::STRING && name != "compression" && name.rfind("oiio:", 0) != 0 &&
            name.rfind("openexr:", 0) != 0)
            image.metadata[name] = attribute.get_string();
    }
    return image;
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
    Image image = is_pfm(path) ? read_pfm(path) : read_with_openimageio(path, options.max_memory);
    if (options.linear) make_linear(image);
    if (!options.rgb) return image;
    try {
        return image.rgb();
    } catch (const InputError& missing) {
        fail(path, missing.what());
    }
}

}  // namespace lampyris
