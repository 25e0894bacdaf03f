// What the file of a texture in textures/ needs: the program that it builds, the parameters that it reads, and its
// registration.
#pragma once

#include "core/base/parameters.h"
#include "core/base/registry.h"
#include "core/scene/description.h"
#include "core/scene/image_store.h"
#include "core/scene/scene.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lampyris {

class TextureBuilder;

// A program under construction: operations in postfix order.
struct TextureProgram {
    std::vector<kernel::TextureOp> ops;
    uint32_t depth = 1;  // stack entries that it needs
    bool is_constant() const { return ops.size() == 1 && ops[0].operation == kernel::TEXTURE_CONSTANT; }
    glm::vec3 constant() const { return glm::vec3(ops[0].a); }
};
TextureProgram constant_program(glm::vec3 value);

// An image that a program will need once something uses the program.
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

    // The program of the operand `name`, or the constant `absent`. operand() reads the texture's own type (float or spectrum),
    // float_operand() a float.
    TextureProgram operand(std::string_view name, float absent);
    TextureProgram float_operand(std::string_view name, float absent);
    // Operands, then the operation that combines them. If the result exceeds the kernels' limits, reports an error and returns
    // a constant.
    TextureProgram combine(const std::vector<TextureProgram>& operands, const kernel::TextureOp& op);
    // Reads a two-dimensional mapping, whose parameters with_mapping() declares.
    void read_mapping(kernel::TextureOp& op);
    // Sets the rows of texture-from-world, for three-dimensional textures.
    void read_position_mapping(kernel::TextureOp& op);

 private:
    void read_transform(kernel::TextureOp& op, uint32_t mapping);
};

// `specs`, plus the parameters of the mapping.
ParameterSpecs with_mapping(ParameterSpecs specs);

using TextureFactory = TextureProgram (*)(TextureContext&);
Registry<TextureFactory>& texture_registry();
struct RegisterTexture {
    RegisterTexture(const char* name, const char* summary, ParameterSpecs specs, TextureFactory factory);
};

}  // namespace lampyris
