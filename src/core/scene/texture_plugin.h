// What a texture's file in textures/ needs: the program that it makes, the parameters that it reads, and its registration.
#pragma once

#include "core/parameters.h"
#include "core/registry.h"
#include "core/scene/image_store.h"
#include "core/scene/scene.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lampyris {

class TextureBuilder;

// A program in the making: operations in postfix order.
struct TextureProgram {
    std::vector<kernel::TextureOp> ops;
    uint32_t depth = 1;  // of the stack that it needs
    bool is_constant() const { return ops.size() == 1 && ops[0].operation == kernel::TEXTURE_CONSTANT; }
    glm::vec3 constant() const { return glm::vec3(ops[0].a); }
};
TextureProgram constant_program(glm::vec3 value);

// An image that a program will need when something uses it.
struct ImageRequest {
    std::string path;  // complete
    TexelEncoding encoding;
    ImageLookup lookup;
    Location location;
};

struct TextureContext {
    TextureBuilder& builder;
    const TextureDescription& texture;
    ParameterReader& reader;

    // The operand `name`, or `absent`: of the texture's own type (float or spectrum), or a float.
    TextureProgram operand(std::string_view name, float absent);
    TextureProgram float_operand(std::string_view name, float absent);
    // Operands, then the operation that combines them. Where the result is larger than kernels evaluate: an error, and a constant.
    TextureProgram combine(const std::vector<TextureProgram>& operands, const kernel::TextureOp& op);
    // Two-dimensional mappings, as with_mapping() declares them.
    void read_mapping(kernel::TextureOp& op);
    // Rows of texture-from-world, for textures in space.
    void read_position_mapping(kernel::TextureOp& op);

 private:
    void read_transform(kernel::TextureOp& op, uint32_t mapping);
};

// `specs`, and those of the mapping.
ParameterSpecs with_mapping(ParameterSpecs specs);

using TextureFactory = TextureProgram (*)(TextureContext&);
Registry<TextureFactory>& texture_registry();
struct RegisterTexture {
    RegisterTexture(const char* name, const char* summary, ParameterSpecs specs, TextureFactory factory);
};

}  // namespace lampyris
