#include "core/base/error.h"
#include "core/image/exr.h"
#include "core/image/exr_header.h"
#include "core/image/plausible.h"
#include "core/image/primaries.h"

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string_view>
#include <tuple>

namespace lampyris {
namespace {

// Layers stay together, in the order of their names; in a layer, R, G, B, A (or X, Y, Z, as the alphabet has them) come first.
auto channel_order(const std::string& name) {
    const size_t dot = name.rfind('.');
    const std::string layer = dot == std::string::npos ? std::string() : name.substr(0, dot);
    const std::string part = dot == std::string::npos ? name : name.substr(dot + 1);
    constexpr std::string_view kColour = "RGBA";
    const size_t place = part.size() == 1 ? kColour.find(part[0]) : std::string_view::npos;
    return std::tuple(layer, std::min(place, kColour.size()), part);
}

// Colour with primaries other than Rec.709's (the attribute "chromaticities") is converted to Rec.709.
void make_rec709(Image& image, const Imf::Header& header) {
    if (!Imf::hasChromaticities(header)) return;
    const Imf::Chromaticities& c = Imf::chromaticities(header);
    const Primaries primaries{{c.red.x, c.red.y}, {c.green.x, c.green.y}, {c.blue.x, c.blue.y}, {c.white.x, c.white.y}};
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

Image::Storage storage_of(const Imf::ChannelList& channels) {
    Image::Storage widest = Image::Storage::kHalf;
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
        if (channel.channel().type == Imf::FLOAT) return Image::Storage::kFloat;
        if (channel.channel().type == Imf::UINT) widest = Image::Storage::kUint32;
    }
    return widest;
}

// OpenEXR makes room for whole tiles.
void check_tiles(const Imf::TileDescription& tiles, int64_t width, int64_t height) {
    constexpr int64_t kFree = 1 << 20;  // pixels
    if (int64_t(tiles.xSize) * int64_t(tiles.ySize) > std::max(width * height, kFree))
        throw InputError(fmt::format("its header is damaged: tiles of {}x{} pixels for a picture of {}x{}", tiles.xSize,
                                     tiles.ySize, width, height));
}

Image read_first_part(Imf::MultiPartInputFile& file, const std::string& path, uint64_t max_memory) {
    const Imf::Header& header = file.header(0);
    if (header.hasType() && Imf::isDeepData(header.type()))
        throw InputError("it is a deep image, which has no single value per pixel");
    const Imf::ChannelList& channels = header.channels();
    if (channels.findChannel("RY") && channels.findChannel("BY"))
        throw InputError("it holds luminance and chroma (Y, RY, BY), which are not converted to R, G, B");
    std::vector<std::string> names;
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
        if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1)
            throw InputError(fmt::format("its channel {} does not have a value for each pixel", channel.name()));
        names.emplace_back(channel.name());
    }
    std::sort(names.begin(), names.end(),
              [](const std::string& a, const std::string& b) { return channel_order(a) < channel_order(b); });
    const Imath::Box2i window = header.dataWindow(), full = header.displayWindow();
    const int64_t width = int64_t(window.max.x) - window.min.x + 1, height = int64_t(window.max.y) - window.min.y + 1;
    if (width <= 0 || height <= 0 || names.empty()) throw InputError("it has no pixels");
    const Image::Storage storage = storage_of(channels);
    check_plausible(path, width, height, int64_t(names.size()), storage == Image::Storage::kHalf ? 2 : 4, max_memory);
    if (header.hasTileDescription()) check_tiles(header.tileDescription(), width, height);

    Image image(int(width), int(height), names);
    image.storage = storage;
    Imf::FrameBuffer buffer;
    const size_t pixel = names.size() * sizeof(float);
    // OpenEXR converts halves, and unsigned integers to their values: they are counts.
    for (size_t c = 0; c < names.size(); ++c)
        buffer.insert(names[c],
                      Imf::Slice::Make(Imf::FLOAT, image.pixels.data() + c, window, pixel, pixel * size_t(width)));
    Imf::InputPart part(file, 0);
    part.setFrameBuffer(buffer);
    part.readPixels(window.min.y, window.max.y);
    make_rec709(image, header);
    if (window != full) {
        image.x = window.min.x - full.min.x;
        image.y = window.min.y - full.min.y;
        image.full_width = full.max.x - full.min.x + 1;
        image.full_height = full.max.y - full.min.y + 1;
    }
    for (auto attribute = header.begin(); attribute != header.end(); ++attribute)
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute());
            text && std::string_view(attribute.name()) != "type")
            image.metadata[attribute.name()] = text->value();
    return image;
}

}  // namespace

bool is_exr(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    char magic[4] = {};
    return file.read(magic, 4) && std::memcmp(magic, "\x76\x2f\x31\x01", 4) == 0;
}

Image read_exr(const std::string& path, uint64_t max_memory) {
    check_exr_header(path);
    try {
        Imf::MultiPartInputFile file(path.c_str(), exr_threads());
        return read_first_part(file, path, max_memory);
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {  // those of OpenEXR name the file
        std::string why = error.what();
        for (const std::string& name : {"image file \"" + path + '"', '"' + path + '"'})
            if (const size_t at = why.find(name); at != std::string::npos) why.replace(at, name.size(), "it");
        throw InputError(why.substr(0, why.find('\n')));
    }
}

}  // namespace lampyris
