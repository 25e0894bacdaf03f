// The scene's textures as postfix programs (core/kernel/layout.h: TextureOp) and its image files as texels.
// Both are made when something first asks for them: a texture that nothing uses costs nothing.
#pragma once

#include "core/error.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace lampyris {

struct BuildContext;
struct Image;

class TextureBuilder {
 public:
    explicit TextureBuilder(BuildContext& context) : context_(context) {}

    // The program (index of its first TextureOp) of a texture by its name. Where there is none, or it is wrong: an error
    // at `where`, or at the texture, and kNone.
    uint32_t float_program(const std::string& name, Location where);
    uint32_t color_program(const std::string& name, Location where);
    // A program that shows an image file over (u, v) in [0, 1]^2 (clamped, v up), times `scale`: textured area lights.
    uint32_t image_program(const std::string& filename, glm::vec3 scale, Location where);

    // An image record (index into Scene::images) of a file. kNone, and an error at `where`, where it cannot be read.
    enum class Content { kColor, kNormalMap, kEnvironment };  // encoding by the file's type; linear; octahedral, linear
    uint32_t image(const std::string& filename, Content content, Location where);
    // The decoded texels of an image record: linear Rec.709, as kernels see them, row by row from the top (3 floats each).
    std::vector<glm::vec3> pixels(uint32_t image) const;
    // The average colour of an image, for the power of lights.
    glm::vec3 average(uint32_t image) const;

 private:
    BuildContext& context_;
    std::map<std::string, uint32_t> float_programs_, color_programs_, images_;
};

}  // namespace lampyris
