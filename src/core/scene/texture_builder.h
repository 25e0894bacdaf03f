// The scene's textures as postfix programs (core/kernel/layout.h: TextureOp) and its image files as texels.
// Both are made when something first asks for them: a texture that nothing uses costs nothing.
#pragma once

#include "core/error.h"
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
    // Uses the context only when it is asked for something: the context may hold a reference to this builder.
    explicit TextureBuilder(BuildContext& context) : context_(context) {}

    // Reads every Texture directive, so that errors in unused ones are told, too. The functions below call it.
    void define_all();

    // The program (index of its first TextureOp) of a texture by its name. Where there is none, or it is wrong: an error
    // at `where`, or at the texture, and kNone.
    uint32_t float_program(const std::string& name, Location where);
    uint32_t color_program(const std::string& name, Location where);
    // A program that shows an image file over (u, v) in [0, 1]^2 (clamped, v up), times `scale`: textured area lights.
    uint32_t image_program(const std::string& filename, glm::vec3 scale, Location where);

    // An image record (index into Scene::images) of a file. kNone, and an error at `where`, where it cannot be read.
    // Normal maps are linear; environments are octahedral squares; these and projections are looked up texel by texel.
    enum class Content { kColor, kNormalMap, kEnvironment, kProjection };
    uint32_t image(const std::string& filename, Content content, Location where);
    // The decoded texels of an image record: linear Rec.709, as kernels see them, row by row from the top (3 floats each).
    std::vector<glm::vec3> pixels(uint32_t image) const { return images_->pixels(image); }
    // The average colour of an image, for the power of lights.
    glm::vec3 average(uint32_t image) const { return images_->average(image); }

    // ---- For texture plugins (texture_plugin.h) ----

    // The program of an operand. Its image operations hold an index of request_image until they are emitted.
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
    // `where` and `what` ask for its effects.
    uint32_t emit(const TextureProgram& program, Location where, const std::string& what);
    uint32_t named_program(const std::string& name, bool is_spectrum, Location where);
    uint32_t load(const ImageRequest& request);
    ImageStore& images();

    BuildContext& context_;
    std::unique_ptr<ImageStore> images_;
    std::vector<ImageRequest> requests_;
    std::unordered_set<std::string> failed_;  // images that were reported
    Textures textures_[2];                    // float, spectrum: names of one kind do not hide the other's
    std::map<std::string, uint32_t> image_programs_;
    bool defined_ = false;
};

}  // namespace lampyris
