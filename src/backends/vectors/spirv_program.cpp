#define SPV_ENABLE_UTILITY_CODE  // HasResultAndType
#include "backends/vectors/spirv_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>

namespace lampyris::vectors {
namespace {

bool has_result_and_type(spv::Op op) {
    bool result = false, type = false;
    spv::HasResultAndType(op, &result, &type);
    return result && type;
}

}  // namespace

bool is_ray_query(spv::Op op) {
    return (op >= spv::OpRayQueryInitializeKHR && op <= spv::OpRayQueryGetIntersectionTypeKHR) ||
           (op >= spv::OpRayQueryGetRayTMinKHR && op <= spv::OpRayQueryGetIntersectionWorldToObjectKHR);
}

bool Program::is_value(uint32_t id) const {
    const auto found = type_of.find(id);
    if (found == type_of.end()) return false;
    const spv::Op op = type(found->second).op;
    return op != spv::OpTypePointer && op != spv::OpTypeAccelerationStructureKHR;
}

uint32_t Program::member_type(uint32_t type_id, uint32_t member) const {
    const Type& t = type(type_id);
    return t.op == spv::OpTypeStruct ? t.members.at(member) : t.element;
}

uint32_t Program::scalars(uint32_t type_id) const {
    const Type& t = type(type_id);
    switch (t.op) {
        case spv::OpTypeBool:
        case spv::OpTypeInt:
        case spv::OpTypeFloat: return 1;
        case spv::OpTypeVector:
        case spv::OpTypeMatrix:
        case spv::OpTypeArray: return t.count * scalars(t.element);
        case spv::OpTypeStruct: {
            uint32_t sum = 0;
            for (const uint32_t member : t.members) sum += scalars(member);
            return sum;
        }
        default: throw NotTranslated(fmt::format("a value of type {}", int(t.op)));
    }
}

uint32_t Program::member_start(uint32_t type_id, uint32_t member) const {
    const Type& t = type(type_id);
    if (t.op != spv::OpTypeStruct) return member * scalars(t.element);
    uint32_t sum = 0;
    for (uint32_t m = 0; m < member; ++m) sum += scalars(t.members[m]);
    return sum;
}

uint32_t Program::scalar_type(uint32_t type_id, uint32_t index) const {
    const Type& t = type(type_id);
    if (t.op == spv::OpTypeStruct) {
        for (const uint32_t member : t.members) {
            const uint32_t count = scalars(member);
            if (index < count) return scalar_type(member, index);
            index -= count;
        }
        throw NotTranslated("a member that is not there");
    }
    if (t.op == spv::OpTypeVector || t.op == spv::OpTypeMatrix || t.op == spv::OpTypeArray)
        return scalar_type(t.element, index % scalars(t.element));
    return type_id;
}

uint32_t Program::scalar_offset(uint32_t type_id, uint32_t index) const {
    const Type& t = type(type_id);
    if (t.op == spv::OpTypeStruct) {
        for (size_t m = 0; m < t.members.size(); ++m) {
            const uint32_t count = scalars(t.members[m]);
            if (index < count) return t.offsets.at(m) + scalar_offset(t.members[m], index);
            index -= count;
        }
        throw NotTranslated("a member that is not there");
    }
    if (t.op == spv::OpTypeVector) return index * (type(t.element).width / 8);
    if (t.op == spv::OpTypeArray) {
        const uint32_t count = scalars(t.element);
        return index / count * t.stride + scalar_offset(t.element, index % count);
    }
    if (t.op == spv::OpTypeMatrix) throw NotTranslated("a matrix in a buffer");
    return 0;
}

uint32_t Program::constant_u32(uint32_t id) const {
    const auto found = constants.find(id);
    if (found == constants.end() || found->second.op != spv::OpConstant)
        throw NotTranslated("an index that is no constant");
    return found->second.operands.at(0);
}

std::vector<uint32_t> values_of(const Instruction& one) {
    const std::vector<uint32_t>& o = one.operands;
    const auto range = [&](size_t from, size_t to) {
        return std::vector<uint32_t>(o.begin() + from, o.begin() + std::min(to, o.size()));
    };
    switch (one.op) {
        case spv::OpLoad:
        case spv::OpCompositeExtract:
        case spv::OpSwitch:
        case spv::OpBranchConditional: return range(0, 1);
        case spv::OpStore:
        case spv::OpCompositeInsert:
        case spv::OpVectorShuffle: return range(0, 2);
        case spv::OpExtInst: return range(2, o.size());
        case spv::OpRayQueryInitializeKHR: return range(2, o.size());
        case spv::OpRayQueryGenerateIntersectionKHR: return range(1, o.size());
        case spv::OpBranch: return {};
        case spv::OpPhi: {
            std::vector<uint32_t> values;
            for (size_t i = 0; i < o.size(); i += 2) values.push_back(o[i]);
            return values;
        }
        default: return is_ray_query(one.op) ? std::vector<uint32_t>() : o;
    }
}

Program take_apart(const shaders::Spirv& spirv) {
    Program program;
    std::unordered_map<uint32_t, std::map<uint32_t, uint32_t>> decorations;
    std::unordered_map<uint32_t, std::map<uint32_t, uint32_t>> offsets;
    uint32_t main = 0, function = 0;
    Block* block = nullptr;
    shaders::for_each_instruction(spirv, [&](spv::Op op, const uint32_t* words, uint32_t count) {
        const auto rest = [&](uint32_t from) { return std::vector<uint32_t>(words + from, words + count); };
        switch (op) {
            case spv::OpEntryPoint: main = words[2]; return;
            case spv::OpExtInstImport:
                if (std::string_view(reinterpret_cast<const char*>(words + 2)) != "GLSL.std.450")
                    throw NotTranslated("instructions that are not those of GLSL.std.450");
                return;
            case spv::OpDecorate: decorations[words[1]][words[2]] = count > 3 ? words[3] : 1; return;
            case spv::OpMemberDecorate:
                if (words[3] == spv::DecorationOffset) offsets[words[1]][words[2]] = words[4];
                return;
            case spv::OpTypeVoid:
            case spv::OpTypeAccelerationStructureKHR:
            case spv::OpTypeRayQueryKHR:
            case spv::OpTypeBool: program.types[words[1]].op = op; return;
            case spv::OpTypeInt:
            case spv::OpTypeFloat:
                program.types[words[1]].op = op;
                program.types[words[1]].width = words[2];
                return;
            case spv::OpTypeVector:
            case spv::OpTypeMatrix:
            case spv::OpTypeArray:
            case spv::OpTypeRuntimeArray: {
                Type& type = program.types[words[1]];
                type.op = op;
                type.element = words[2];
                if (op == spv::OpTypeArray) type.count = program.constant_u32(words[3]);
                if (op == spv::OpTypeVector || op == spv::OpTypeMatrix) type.count = words[3];
                const auto& known = decorations[words[1]];
                if (known.contains(spv::DecorationArrayStride)) type.stride = known.at(spv::DecorationArrayStride);
                return;
            }
            case spv::OpTypeStruct: {
                Type& type = program.types[words[1]];
                type.op = op;
                type.members = rest(2);
                for (const auto& [member, offset] : offsets[words[1]]) {
                    if (type.offsets.size() <= member) type.offsets.resize(member + 1);
                    type.offsets[member] = offset;
                }
                return;
            }
            case spv::OpTypePointer: {
                Type& type = program.types[words[1]];
                type.op = op;
                type.storage = words[2];
                type.element = words[3];
                return;
            }
            case spv::OpTypeFunction: program.types[words[1]].op = op; return;
            case spv::OpConstant:
            case spv::OpConstantTrue:
            case spv::OpConstantFalse:
            case spv::OpConstantNull:
            case spv::OpConstantComposite:
            case spv::OpUndef:
                program.constants[words[2]] = {op, words[1], words[2], rest(3)};
                program.type_of[words[2]] = words[1];
                return;
            case spv::OpVariable: {
                Variable variable;
                variable.type = words[1];
                variable.storage = words[3];
                const auto& known = decorations[words[2]];
                const auto value = [&](uint32_t kind) { return known.contains(kind) ? known.at(kind) : 0; };
                variable.set = value(spv::DecorationDescriptorSet);
                variable.binding = value(spv::DecorationBinding);
                if (known.contains(spv::DecorationBuiltIn)) variable.built_in = value(spv::DecorationBuiltIn);
                if (count > 4) throw NotTranslated("a variable with an initial value");
                program.variables[words[2]] = variable;
                program.type_of[words[2]] = words[1];
                return;
            }
            case spv::OpFunction:
                function = words[2];
                if (function != main) throw NotTranslated("a function that is not inlined");
                return;
            case spv::OpFunctionEnd: function = 0; return;
            default: break;
        }
        if (function == 0 || function != main) return;
        if (op == spv::OpLabel) {
            block = &program.blocks.emplace_back();
            block->label = words[1];
            return;
        }
        if (op == spv::OpNop || op == spv::OpLine || op == spv::OpNoLine) return;
        if (op == spv::OpSelectionMerge || op == spv::OpLoopMerge) {
            block->merge = words[1];
            if (op == spv::OpLoopMerge) block->next_turn = words[2];
            return;
        }
        Instruction instruction;
        instruction.op = op;
        if (has_result_and_type(op)) {
            instruction.type = words[1], instruction.result = words[2], instruction.operands = rest(3);
            program.type_of[words[2]] = words[1];
        } else {
            instruction.operands = rest(1);
        }
        switch (op) {
            case spv::OpPhi: block->phis.push_back(std::move(instruction)); return;
            case spv::OpBranch:
            case spv::OpBranchConditional:
            case spv::OpSwitch:
            case spv::OpReturn:
            case spv::OpUnreachable: block->end = std::move(instruction); return;
            default: block->body.push_back(std::move(instruction));
        }
    });
    return program;
}

}  // namespace lampyris::vectors
