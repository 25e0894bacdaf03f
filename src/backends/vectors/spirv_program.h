// A kernel's SPIR-V, taken apart: types with their layout, constants, variables, and the blocks of its main function.
#pragma once

#include "backends/cpu/vectors.h"
#include "backends/shaders/spirv.h"

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace lampyris::vectors {

struct Type {
    spv::Op op = spv::OpTypeVoid;
    uint32_t width = 0;    // bits of an int or a float
    uint32_t element = 0;  // of vectors, matrices, arrays; what a pointer points to
    uint32_t count = 0;    // elements of vectors, matrices and arrays
    uint32_t stride = 0;   // bytes, of arrays in buffers
    std::vector<uint32_t> members;
    std::vector<uint32_t> offsets;  // bytes, of members in buffers
    uint32_t storage = 0;           // of pointers
};

struct Instruction {
    spv::Op op = spv::OpNop;
    uint32_t type = 0, result = 0;
    std::vector<uint32_t> operands;  // without type and result
};

struct Block {
    uint32_t label = 0;
    std::vector<Instruction> phis, body;
    Instruction end;
    uint32_t merge = 0, next_turn = 0;  // OpSelectionMerge, OpLoopMerge
};

struct Variable {
    uint32_t type = 0;  // of the pointer
    uint32_t storage = 0;
    uint32_t set = 0, binding = 0;
    uint32_t built_in = ~0u;
};

struct Program {
    std::unordered_map<uint32_t, Type> types;
    std::unordered_map<uint32_t, Instruction> constants;
    std::unordered_map<uint32_t, Variable> variables;
    std::unordered_map<uint32_t, uint32_t> type_of;  // of results
    std::vector<Block> blocks;                       // of main; the first is its entry

    const Type& type(uint32_t id) const { return types.at(id); }
    // Scalars of a value, and the type of each.
    uint32_t scalars(uint32_t type) const;
    uint32_t scalar_type(uint32_t type, uint32_t index) const;
    uint32_t scalar_offset(uint32_t type, uint32_t index) const;  // bytes, in a buffer
    // The first scalar of a member.
    uint32_t member_start(uint32_t type, uint32_t member) const;
    uint32_t member_type(uint32_t type, uint32_t member) const;
    uint32_t constant_u32(uint32_t id) const;
    bool is_constant(uint32_t id) const { return constants.contains(id); }
    bool is_number(uint32_t id) const { return is_constant(id) && constants.at(id).op == spv::OpConstant; }
    bool is_undefined(uint32_t id) const { return is_constant(id) && constants.at(id).op == spv::OpUndef; }
    bool is_value(uint32_t id) const;  // and no pointer, label or the like
};

inline bool is_atomic(spv::Op op) { return op >= spv::OpAtomicLoad && op <= spv::OpAtomicXor; }
bool is_ray_query(spv::Op op);

// Throws NotTranslated.
Program take_apart(const shaders::Spirv& spirv);

// Those of an instruction's operands that are values, or pointers; the others are literals, labels and the like.
std::vector<uint32_t> values_of(const Instruction& instruction);

}  // namespace lampyris::vectors
