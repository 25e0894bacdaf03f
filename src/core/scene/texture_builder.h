// The scene's textures as postfix programs (core/kernel/layout.h: TextureOp) and its image files as texels.
// Both are built on first use: a texture that nothing uses costs nothing.
#pragma once

#include "core/base/error.h"
#include "core/scene/image_store.h"
#include "core/scene/texture_plugin.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <unordered_set>
#include <vector>

namespace lampyris {

struct BuildContext;
struct TextureDescription;

class TextureBuilder {
 public:
    // Only later calls use the context: it may hold a reference to this builder, and so be incomplete now.
    explicit TextureBuilder(BuildContext& context) : context_(context) {}

    // Reads every Texture directive, so that errors in unused ones are reported, too. The functions below call it.
    void define_all();

    // The program (index of its first TextureOp) of a texture, by the texture's name. kNone if there is none or it is wrong,
    // with an error reported at `where` or at the texture.
    uint32_t float_program(const std::string& name, Location where);
    uint32_t color_program(const std::string& name, Location where);
    // A program that maps an image file to (u, v) in [0, 1]^2 (clamped, v up), times `scale`; for textured area lights.
    uint32_t image_program(const std::string& filename, glm::vec3 scale, Location where);

    // An image record (index into Scene::images) for a file. kNone, with an error reported at `where`, if it cannot be read.
    // Normal maps are linear; environments are octahedral squares; these and projections are looked up without interpolation.
    enum class Content { kColor, kNormalMap, kEnvironment, kProjection };
    uint32_t image(const std::string& filename, Content content, Location where);
    // The decoded texels of an image record: linear Rec.709, as kernels see them, row by row from the top (3 floats each).
    std::vector<glm::vec3> pixels(uint32_t image) const { return images_->pixels(image); }
    // The average colour of an image, for the power of lights.
    glm::vec3 average(uint32_t image) const { return images_->average(image); }

    // ---- For texture plugins (texture_plugin.h) ----

    // The program of an operand. Until it is emitted, its image operations hold indices returned by request_image.
    TextureProgram operand(ParameterReader& reader, std::string_view name, float absent, bool is_spectrum);
    uint32_t request_image(ImageRequest request);
    BuildContext& context() { return context_; }

 private:
    struct Texture {
        Location location;
        TextureProgram program;
        uint32_t emitted = kNone;
    };
    using Textures = std::map<std::string, Texture, std::less<>>;

    void define(TextureDescription& description);
    Texture* find(const std::string& name, bool is_spectrum, Location where);
    // `where` and `what` are named as the reason for its effects.
    uint32_t emit(const TextureProgram& program, Location where, const std::string& what);
    uint32_t named_program(const std::string& name, bool is_spectrum, Location where);
    uint32_t load(const ImageRequest& request);
    ImageStore& images();

    BuildContext& context_;
    std::unique_ptr<ImageStore> images_;
    std::vector<ImageRequest> requests_;
    std::unordered_set<std::string> failed_;  // paths of images whose errors were reported
    Textures textures_[2];                    // float and spectrum: a name of one kind does not hide one of the other
    std::map<std::string, uint32_t> image_programs_;
    bool defined_ = false;
};

}  // namespace lampyris
