// Images by OpenImageIO (core/image/other_formats.h).
#include "core/image/other_formats.h"

#include "core/base/error.h"
#include "core/image/plausible.h"

#include <fmt/format.h>
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cctype>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string_view>

namespace lampyris {
namespace {

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

// OpenImageIO's name for the format of a file's first bytes; empty if it is none of those that are read. OpenImageIO knows more:
// they are not tried, since nobody has looked at what damaged files make of them. A TGA has no signature (Truevision's specification,
// 2.0: the kinds of colour map and picture, and the bits of a pixel).
std::string format_of(std::string_view head) {
    const auto begins = [head](std::string_view with) { return head.starts_with(with); };
    if (begins("\x89PNG\r\n\x1a\n")) return "png";
    if (begins("\xff\xd8\xff")) return "jpeg";
    for (const std::string_view tiff : {std::string_view("II*\0", 4), std::string_view("MM\0*", 4),
                                        std::string_view("II+\0", 4), std::string_view("MM\0+", 4)})
        if (begins(tiff)) return "tiff";
    if (begins("BM")) return "bmp";
    if (begins("#?")) return "hdr";
    if (head.size() > 2 && head[0] == 'P' && head[1] >= '1' && head[1] <= '6' &&
        std::isspace(static_cast<unsigned char>(head[2])))
        return "pnm";
    constexpr std::string_view kPictures("\1\2\3\x9\xa\xb"), kBits("\x8\xf\x10\x18\x20");
    if (head.size() >= 18 && static_cast<unsigned char>(head[1]) <= 1 &&
        kPictures.find(head[2]) != std::string_view::npos && kBits.find(head[16]) != std::string_view::npos)
        return "targa";
    return {};
}

// OpenImageIO crashes on compressed pixels of other sizes than its decoder has.
void check_bmp(std::string_view head) {
    const auto number = [head](size_t at) {
        uint32_t value = 0;
        std::memcpy(&value, head.data() + at, sizeof value);
        return value;
    };
    constexpr uint32_t kOldHeader = 12;  // of OS/2: it has no compression
    if (head.size() < 18 || (number(14) != kOldHeader && head.size() < 34)) throw InputError("its header is damaged");
    if (number(14) != kOldHeader && number(30) != 0) throw InputError("it is a compressed BMP, which is not read");
}

// libpng makes room for as many bytes of a chunk as a damaged file claims (PNG's specification, 5.3: a length of four
// bytes, most significant first, a type of four, the data, and a check of four).
void check_png_chunks(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    file.seekg(8);
    const auto size = int64_t(std::filesystem::file_size(path));
    unsigned char head[8];
    while (file.read(reinterpret_cast<char*>(head), 8)) {
        const int64_t bytes = int64_t(head[0]) << 24 | head[1] << 16 | head[2] << 8 | head[3];
        const int64_t left = size - int64_t(file.tellg());
        if (bytes > left)
            throw InputError(fmt::format("one of its chunks is said to have {} bytes, and {} follow", bytes, left));
        file.seekg(bytes + 4, std::ios::cur);
    }
}

Image read(const std::string& path, uint64_t max_memory) {
    char bytes[64];
    std::ifstream file(path, std::ios::binary);
    file.read(bytes, sizeof bytes);
    const std::string_view head(bytes, size_t(file.gcount()));
    const std::string format = format_of(head);
    if (format.empty())
        throw InputError("its format is not known: EXR, PFM, PNG, JPEG, TIFF, TGA, BMP, HDR and PNM are");
    if (format == "bmp") check_bmp(head);
    if (format == "png") check_png_chunks(path);
    OIIO::ImageSpec hints, spec;
    hints["oiio:UnassociatedAlpha"] = 1;  // do not multiply colour by alpha
    const auto input = OIIO::ImageInput::create(format);
    if (!input) throw InputError(reason(OIIO::geterror(), path));
    if (!input->open(path, spec, hints)) throw InputError(reason(input->geterror(), path));
    if (spec.deep) throw InputError("it is a deep image, which has no single value per pixel");
    if (spec.depth > 1) throw InputError("it is a volume, not an image");
    if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0) throw InputError("it has no pixels");
    check_plausible(path, spec.width, spec.height, spec.nchannels, int64_t(spec.format.basesize()), max_memory);

    Image image(spec.width, spec.height, {spec.channelnames.begin(), spec.channelnames.end()});
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.pixels.data()))
        throw InputError(reason(input->geterror(), path));
    image.storage = storage_of(spec.format);
    if (!spec.format.is_floating_point()) {
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
        if (attribute.type() == OIIO::TypeDesc::STRING && name != "compression" && !name.starts_with("oiio:"))
            image.metadata[name] = attribute.get_string();
    }
    return image;
}

std::vector<unsigned char> encode_png(int width, int height, const std::vector<uint8_t>& rgb,
                                      const std::map<std::string, std::string>& metadata) {
    OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    for (const auto& [name, value] : metadata)
        if (name != "compression" && !name.starts_with("oiio:")) spec.attribute(name, value);
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const auto output = OIIO::ImageOutput::create("memory.png");
    if (!output) throw MachineError(fmt::format("OpenImageIO cannot write PNG: {}", OIIO::geterror()));
    if (!output->set_ioproxy(&memory) || !output->open("memory.png", spec) ||
        !output->write_image(OIIO::TypeDesc::UINT8, rgb.data()) || !output->close())
        throw MachineError(fmt::format("OpenImageIO cannot write PNG: {}", output->geterror()));
    return bytes;
}

}  // namespace
}  // namespace lampyris

extern "C" const lampyris::OtherFormats* lampyris_other_formats() {
    static const lampyris::OtherFormats formats{lampyris::read, lampyris::encode_png};
    return &formats;
}
