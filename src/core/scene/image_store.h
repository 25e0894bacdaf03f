// Images as kernels see them: packed texels in Scene::texels, records in Scene::images.
//
// Eight-bit files stay at 8 bits a channel (one table of 256 floats per encoding decodes a byte). 16-bit and half-float colour
// becomes half floats; everything else becomes 32-bit floats. Grey images keep one channel. A file is loaded once per encoding,
// whatever its wrap mode and filter.
#pragma once

#include "core/base/error.h"
#include "core/image/image.h"
#include "core/scene/scene.h"

#include <glm/vec3.hpp>

#include <array>
#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lampyris {

// How numbers of integer formats encode light; floating-point formats are linear.
struct TexelEncoding {
    enum class Kind { kOfFile, kLinear, kSrgb, kGamma } kind = Kind::kOfFile;
    float gamma = 1.0f;  // light = number^gamma, for kGamma
    bool emits = false;  // an image of emitted light: negative numbers are set to 0
    auto operator<=>(const TexelEncoding&) const = default;
};

struct ImageLookup {
    uint32_t wrap = kernel::WRAP_REPEAT;
    uint32_t filtering = kernel::FILTER_BILINEAR;
};

class ImageStore {
 public:
    ImageStore(Scene& scene, Diagnostics& diagnostics) : scene_(scene), diagnostics_(diagnostics) {}

    // The index in Scene::images of a file. Throws an InputError that says why it cannot be read. Numbers that are not finite
    // are replaced, and so are negative ones in images of emitted light, with a warning at `where`.
    uint32_t load(const std::string& path, TexelEncoding encoding, ImageLookup lookup, Location where);
    // The same for an image in memory; `encoding` applies to its storage as it does to a file's, `name` is for messages.
    uint32_t add(const Image& image, TexelEncoding encoding, ImageLookup lookup, const std::string& name,
                 Location where);

    // The offset in Scene::texels of the noise textures' permutation of 0..255.
    uint32_t noise_permutation();

    // The texels as kernels decode them, row by row from the top, and their average.
    std::vector<glm::vec3> pixels(uint32_t image) const;
    glm::vec3 average(uint32_t image) const;

 private:
    struct Texels {
        uint32_t first = 0, width = 0, height = 0, format = 0, decode = 0;
    };
    Texels pack(const Image& image, TexelEncoding encoding, const std::string& name, Location where);
    uint32_t decode_table(TexelEncoding encoding);
    uint32_t reserve(size_t words, const std::string& name);
    uint32_t record(const Texels& texels, ImageLookup lookup);

    Scene& scene_;
    Diagnostics& diagnostics_;
    std::map<std::pair<std::string, TexelEncoding>, Texels> loaded_;  // by canonical path
    std::map<std::array<uint32_t, 6>, uint32_t> records_;             // by the record's words
    std::map<TexelEncoding, uint32_t> tables_;
    std::optional<uint32_t> noise_permutation_;
};

}  // namespace lampyris
