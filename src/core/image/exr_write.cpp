#include "core/base/error.h"
#include "core/image/exr.h"

#include <fmt/format.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <OpenEXR/ImfTiledOutputFile.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <thread>

namespace lampyris {
namespace {

using Bytes = std::vector<unsigned char>;

constexpr float kLargestHalf = 65504.0f;

class MemoryStream final : public Imf::OStream {
 public:
    explicit MemoryStream(Bytes& bytes) : Imf::OStream("memory"), bytes_(bytes) {}
    void write(const char data[], int count) override {
        if (bytes_.size() < at_ + size_t(count)) bytes_.resize(at_ + size_t(count));
        std::memcpy(bytes_.data() + at_, data, size_t(count));
        at_ += size_t(count);
    }
    uint64_t tellp() override { return at_; }
    void seekp(uint64_t position) override { at_ = size_t(position); }

 private:
    Bytes& bytes_;
    size_t at_ = 0;
};

Imf::Compression compression_of(const std::string& name) {
    if (name == "none") return Imf::NO_COMPRESSION;
    if (name == "rle") return Imf::RLE_COMPRESSION;
    if (name == "zip") return Imf::ZIP_COMPRESSION;
    if (name == "zips") return Imf::ZIPS_COMPRESSION;
    if (name == "piz") return Imf::PIZ_COMPRESSION;
    throw InputError(
        fmt::format("no compression of an EXR is called '{}'; there are none, rle, zip, zips and piz", name));
}

// Channels for which half floats (11 bits of precision, a range of 65504) suffice.
bool fits_half(const std::string& channel) {
    const std::string layer = channel.substr(0, channel.find('.'));
    return channel.find('.') == std::string::npos
               ? channel == "R" || channel == "G" || channel == "B" || channel == "A" || channel == "Y"
               : layer == "albedo" || layer == "normal";
}

half to_half(float value, size_t& clamped) {
    if (std::isfinite(value) && std::fabs(value) > kLargestHalf) {
        value = std::copysign(kLargestHalf, value);
        ++clamped;
    }
    return half(value);
}

Imf::Header header_of(const Image& image, const WriteOptions& options) {
    const Imath::V2i begin(image.x, image.y), size(image.width, image.height), one(1);
    const bool part = image.full_width > 0;
    const Imath::V2i full(part ? image.full_width : image.width, part ? image.full_height : image.height);
    Imf::Header header(Imath::Box2i({0, 0}, full - one), Imath::Box2i(begin, begin + size - one));
    header.compression() = compression_of(options.compression);
    if (options.tile_size > 0)
        header.setTileDescription({unsigned(options.tile_size), unsigned(options.tile_size), Imf::ONE_LEVEL});
    Imf::addChromaticities(header, Imf::Chromaticities());  // Rec.709's
    for (const auto& [name, value] : image.metadata)
        if (header.find(name) == header.end()) header.insert(name, Imf::StringAttribute(value));
    return header;
}

// A plane of the image's halves for each channel that becomes half.
std::vector<std::vector<half>> halves_of(const Image& image, size_t& clamped) {
    std::vector<std::vector<half>> planes(image.channel_names.size());
    const size_t step = size_t(image.channels);
    for (size_t c = 0; c < planes.size(); ++c) {
        if (!fits_half(image.channel_names[c])) continue;
        planes[c].reserve(image.pixel_count());
        for (size_t i = c; i < image.pixels.size(); i += step) planes[c].push_back(to_half(image.pixels[i], clamped));
    }
    return planes;
}

}  // namespace

int exr_threads() {
    static const int threads = [] {
        const int cores = int(std::thread::hardware_concurrency());
        Imf::setGlobalThreadCount(cores);
        return cores;
    }();
    return threads;
}

std::vector<unsigned char> encode_exr(const Image& image, const WriteOptions& options, WriteResult& result) {
    Bytes bytes;
    try {
        Imf::Header header = header_of(image, options);
        const std::vector<std::vector<half>> halves =
            options.half ? halves_of(image, result.clamped) : std::vector<std::vector<half>>(size_t(image.channels));
        Imf::FrameBuffer buffer;
        const size_t width = size_t(image.width), pixel = size_t(image.channels) * sizeof(float);
        const Imath::Box2i window = header.dataWindow();
        for (size_t c = 0; c < halves.size(); ++c) {
            const std::string& name = image.channel_names[c];
            const bool is_half = !halves[c].empty();
            header.channels().insert(name, Imf::Channel(is_half ? Imf::HALF : Imf::FLOAT));
            buffer.insert(
                name, is_half
                          ? Imf::Slice::Make(Imf::HALF, halves[c].data(), window, sizeof(half), width * sizeof(half))
                          : Imf::Slice::Make(Imf::FLOAT, image.pixels.data() + c, window, pixel, width * pixel));
        }
        MemoryStream stream(bytes);
        if (options.tile_size > 0) {
            Imf::TiledOutputFile file(stream, header, exr_threads());
            file.setFrameBuffer(buffer);
            file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
        } else {
            Imf::OutputFile file(stream, header, exr_threads());
            file.setFrameBuffer(buffer);
            file.writePixels(image.height);
        }
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        throw MachineError(fmt::format("OpenEXR cannot write the image: {}", error.what()));
    }
    return bytes;
}

}  // namespace lampyris
