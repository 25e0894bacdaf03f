#include "core/scene/image_store.h"

#include "core/image/image_io.h"
#include "core/scene/noise_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>

namespace lampyris {

namespace {

constexpr float kLargestHalf = 65504.0f;

// Round to nearest even; |x| must be at most kLargestHalf.
uint32_t half_bits(float x) {
    const uint32_t bits = std::bit_cast<uint32_t>(x);
    const uint32_t sign = (bits >> 16) & 0x8000u;
    const uint32_t magnitude = bits & 0x7fffffffu;
    if (magnitude < 0x38800000u)  // below the smallest normal half: multiples of 2^-24
        return sign | uint32_t(std::nearbyint(std::abs(x) * 16777216.0f));
    const uint32_t even = (magnitude >> 13) & 1u;
    return sign | ((magnitude + 0x0fffu + even - 0x38000000u) >> 13);
}

// As core/kernel/texture.h decodes it.
float from_half_bits(uint32_t h) {
    const uint32_t magnitude = h & 0x7fffu;
    const float value =
        magnitude < 0x0400u ? float(magnitude) * 0x1p-24f : std::bit_cast<float>((magnitude << 13) + 0x38000000u);
    return (h & 0x8000u) ? -value : value;
}

uint32_t format_of(Image::Storage storage, bool grey) {
    if (storage == Image::Storage::kUint8) return grey ? kernel::TEXEL_R8 : kernel::TEXEL_RGBA8;
    if (grey) return kernel::TEXEL_R32F;
    return storage == Image::Storage::kUint16 || storage == Image::Storage::kHalf ? kernel::TEXEL_RGBA16F
                                                                                  : kernel::TEXEL_RGB32F;
}

size_t words_of(uint32_t format, size_t pixels) {
    switch (format) {
        case kernel::TEXEL_R8: return (pixels + 3) / 4;
        case kernel::TEXEL_RGBA16F: return 2 * pixels;
        case kernel::TEXEL_RGB32F: return 3 * pixels;
        default: return pixels;
    }
}

// Linear light for a number in [0, 1] of the file's encoding.
float decode(double number, TexelEncoding encoding) {
    switch (encoding.kind) {
        case TexelEncoding::Kind::kSrgb: return linear_from_srgb(float(number));
        case TexelEncoding::Kind::kGamma: return float(std::pow(number, double(encoding.gamma)));
        default: return float(number);
    }
}

}  // namespace

uint32_t ImageStore::reserve(size_t words, const std::string& name) {
    const size_t first = scene_.texels.size();
    if (first + words > std::numeric_limits<uint32_t>::max())
        throw InputError(
            fmt::format("{}: the scene's images take more than 16 GiB, which is as much as kernels can index", name));
    scene_.texels.resize(first + words);
    return uint32_t(first);
}

uint32_t ImageStore::decode_table(TexelEncoding encoding) {
    const auto [found, is_new] = tables_.try_emplace(encoding, 0);
    if (is_new) {
        found->second = reserve(256, "a decoding table");
        for (uint32_t code = 0; code < 256; ++code)
            scene_.texels[found->second + code] = std::bit_cast<uint32_t>(decode(code / 255.0, encoding));
    }
    return found->second;
}

uint32_t ImageStore::noise_permutation() {
    if (!noise_permutation_) {
        noise_permutation_ = reserve(std::size(kNoisePermutation), "the table of noise");
        std::copy(std::begin(kNoisePermutation), std::end(kNoisePermutation),
                  scene_.texels.begin() + *noise_permutation_);
    }
    return *noise_permutation_;
}

ImageStore::Texels ImageStore::pack(const Image& image, TexelEncoding encoding, const std::string& name,
                                    Location where) {
    const bool grey = image.find_channel("R") < 0;
    Image converted;
    const bool as_is = grey ? image.channels == 1 : image.channel_names == std::vector<std::string>{"R", "G", "B"};
    if (!as_is) converted = image.rgb();
    const Image& source = converted.channels ? converted : image;
    const bool emits = encoding.emits;
    const bool integers = image.storage != Image::Storage::kHalf && image.storage != Image::Storage::kFloat;
    if (!integers)
        encoding = {TexelEncoding::Kind::kLinear, 1.0f};
    else if (encoding.kind == TexelEncoding::Kind::kOfFile)
        encoding = {
            image.encoding == Image::Encoding::kSrgb ? TexelEncoding::Kind::kSrgb : TexelEncoding::Kind::kLinear, 1.0f};

    Texels texels;
    texels.width = uint32_t(source.width);
    texels.height = uint32_t(source.height);
    texels.format = format_of(image.storage, grey);
    const size_t pixels = source.pixel_count();
    const bool bytes = texels.format == kernel::TEXEL_R8 || texels.format == kernel::TEXEL_RGBA8;
    if (bytes) texels.decode = decode_table(encoding);
    texels.first = reserve(words_of(texels.format, pixels), name);
    uint32_t* out = scene_.texels.data() + texels.first;

    // The first three channels, or a grey image's first.
    const size_t stride = size_t(source.channels);
    const auto byte = [&](size_t i) {
        return uint32_t(std::lround(std::clamp(source.pixels[i], 0.0f, 1.0f) * 255.0f));
    };
    const float largest = texels.format == kernel::TEXEL_RGBA16F ? kLargestHalf : std::numeric_limits<float>::max();
    size_t replaced = 0, negative = 0, first_negative = 0;
    const auto light = [&](size_t i) {
        float x = source.pixels[i];
        if (integers) x = decode(x, encoding);
        if (std::isnan(x)) ++replaced, x = 0.0f;
        if (std::abs(x) > largest) ++replaced, x = std::copysign(largest, x);
        if (emits && x < 0.0f) {
            if (negative++ == 0) first_negative = i / stride;
            x = 0.0f;
        }
        return x;
    };
    for (size_t p = 0; p < pixels; ++p) {
        const size_t i = p * stride;
        switch (texels.format) {
            case kernel::TEXEL_R8: out[p / 4] |= byte(i) << (8 * (p % 4)); break;
            case kernel::TEXEL_RGBA8: out[p] = byte(i) | byte(i + 1) << 8 | byte(i + 2) << 16 | 0xff000000u; break;
            case kernel::TEXEL_RGBA16F:
                out[2 * p] = half_bits(light(i)) | half_bits(light(i + 1)) << 16;
                out[2 * p + 1] = half_bits(light(i + 2)) | half_bits(1.0f) << 16;
                break;
            case kernel::TEXEL_RGB32F:
                for (size_t c = 0; c < 3; ++c) out[3 * p + c] = std::bit_cast<uint32_t>(light(i + c));
                break;
            default: out[p] = std::bit_cast<uint32_t>(light(i)); break;
        }
    }
    if (replaced > 0)
        diagnostics_.warning(
            where, fmt::format("{} holds {} numbers that are not finite or too large for its format", name, replaced),
            "NaN is taken for 0, the others for the largest number");
    if (negative > 0)
        diagnostics_.warning(where,
                             fmt::format("{} holds {} negative numbers, the first in texel ({}, {})", name, negative,
                                         first_negative % texels.width, first_negative / texels.width),
                             "light is at least 0: they are taken for 0");
    return texels;
}

uint32_t ImageStore::record(const Texels& t, ImageLookup lookup) {
    const std::array<uint32_t, 6> words{
        t.first, t.width, t.height, t.format | lookup.wrap << 8 | lookup.filtering << 16, t.decode, 0};
    const auto [found, is_new] = records_.try_emplace(words, uint32_t(scene_.images.size()));
    if (is_new) scene_.images.push_back({words[0], words[1], words[2], words[3], words[4], 0, 0, 0});
    return found->second;
}

uint32_t ImageStore::load(const std::string& path, TexelEncoding encoding, ImageLookup lookup, Location where) {
    std::error_code ignored;
    std::string canonical = std::filesystem::weakly_canonical(path, ignored).string();
    if (canonical.empty()) canonical = path;
    const auto key = std::pair(std::move(canonical), encoding);
    auto found = loaded_.find(key);
    if (found == loaded_.end())
        found = loaded_
                    .emplace(
                        key,
                        pack(read_image(path, {.linear = false, .rgb = false, .max_memory = diagnostics_.max_memory()}),
                             encoding, path, where))
                    .first;
    return record(found->second, lookup);
}

uint32_t ImageStore::add(const Image& image, TexelEncoding encoding, ImageLookup lookup, const std::string& name,
                         Location where) {
    return record(pack(image, encoding, name, where), lookup);
}

std::vector<glm::vec3> ImageStore::pixels(uint32_t image) const {
    const kernel::ImageRecord& record = scene_.images.at(image);
    const uint32_t* words = scene_.texels.data() + record.first_texel;
    const uint32_t* table = scene_.texels.data() + record.decoding;
    const auto number = [](uint32_t bits) { return std::bit_cast<float>(bits); };
    std::vector<glm::vec3> pixels(size_t(record.width) * record.height);
    for (size_t p = 0; p < pixels.size(); ++p) {
        switch (record.format & 0xffu) {
            case kernel::TEXEL_R8: pixels[p] = glm::vec3(number(table[words[p / 4] >> (8 * (p % 4)) & 0xffu])); break;
            case kernel::TEXEL_RGBA8:
                for (int c = 0; c < 3; ++c) pixels[p][c] = number(table[words[p] >> (8 * c) & 0xffu]);
                break;
            case kernel::TEXEL_RGBA16F:
                pixels[p] = {from_half_bits(words[2 * p] & 0xffffu), from_half_bits(words[2 * p] >> 16),
                             from_half_bits(words[2 * p + 1] & 0xffffu)};
                break;
            case kernel::TEXEL_RGB32F:
                pixels[p] = {number(words[3 * p]), number(words[3 * p + 1]), number(words[3 * p + 2])};
                break;
            default: pixels[p] = glm::vec3(number(words[p])); break;
        }
    }
    return pixels;
}

glm::vec3 ImageStore::average(uint32_t image) const {
    double sum[3] = {0, 0, 0};
    const std::vector<glm::vec3> values = pixels(image);
    for (const glm::vec3& value : values)
        for (int c = 0; c < 3; ++c) sum[c] += value[c];
    const double scale = 1.0 / double(std::max<size_t>(values.size(), 1));
    return {float(sum[0] * scale), float(sum[1] * scale), float(sum[2] * scale)};
}

}  // namespace lampyris
