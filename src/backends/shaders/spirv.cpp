#include "backends/shaders/spirv.h"

#include <glslang/SPIRV/spirv.hpp>

#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <tuple>

namespace lampyris::shaders {
namespace {

// Arithmetic to which NoContraction may apply according to the SPIR-V specification; all have their result id in word 2.
bool is_float_arithmetic(spv::Op op) {
    switch (op) {
        case spv::OpFNegate:
        case spv::OpFAdd:
        case spv::OpFSub:
        case spv::OpFMul:
        case spv::OpFDiv:
        case spv::OpFRem:
        case spv::OpFMod:
        case spv::OpVectorTimesScalar:
        case spv::OpMatrixTimesScalar:
        case spv::OpVectorTimesMatrix:
        case spv::OpMatrixTimesVector:
        case spv::OpMatrixTimesMatrix:
        case spv::OpOuterProduct:
        case spv::OpDot: return true;
        default: return false;
    }
}

}  // namespace

bool is_annotation(spv::Op op) {
    return op == spv::OpDecorate || op == spv::OpMemberDecorate || op == spv::OpDecorationGroup ||
           op == spv::OpGroupDecorate || op == spv::OpGroupMemberDecorate || op == spv::OpDecorateId ||
           op == spv::OpDecorateString || op == spv::OpMemberDecorateString;
}

bool precedes_annotations(spv::Op op) {
    switch (op) {
        case spv::OpCapability:
        case spv::OpExtension:
        case spv::OpExtInstImport:
        case spv::OpMemoryModel:
        case spv::OpEntryPoint:
        case spv::OpExecutionMode:
        case spv::OpExecutionModeId:
        case spv::OpString:
        case spv::OpSourceExtension:
        case spv::OpSource:
        case spv::OpSourceContinued:
        case spv::OpName:
        case spv::OpMemberName:
        case spv::OpModuleProcessed: return true;
        default: return false;
    }
}

Spirv forbid_contraction(const Spirv& spirv) {
    std::set<uint32_t> decorated;
    std::vector<uint32_t> results;
    for_each_instruction(spirv, [&](spv::Op op, const uint32_t* words, uint32_t count) {
        if (op == spv::OpDecorate && count == 3 && words[2] == spv::DecorationNoContraction) decorated.insert(words[1]);
        if (is_float_arithmetic(op) && count >= 3) results.push_back(words[2]);
    });
    Spirv out(spirv.begin(), spirv.begin() + std::min(kHeaderWords, spirv.size()));
    out.reserve(spirv.size() + 3 * results.size());
    bool inserted = false;
    for_each_instruction(spirv, [&](spv::Op op, const uint32_t* words, uint32_t count) {
        if (!inserted && !precedes_annotations(op) && !is_annotation(op)) {
            for (const uint32_t id : results) {
                if (decorated.count(id)) continue;
                out.insert(out.end(), {uint32_t(3) << 16 | spv::OpDecorate, id, spv::DecorationNoContraction});
            }
            inserted = true;
        }
        out.insert(out.end(), words, words + count);
    });
    return out;
}

std::vector<ShaderBinding> used_bindings(const Spirv& spirv) {
    std::map<uint32_t, uint32_t> sets, bindings;  // by variable
    std::map<uint32_t, uint32_t> pointees;        // pointer type -> type
    std::set<uint32_t> structures, used;          // acceleration structure types; ids that functions mention
    std::map<uint32_t, uint32_t> variables;       // variable -> pointer type
    std::map<uint32_t, std::string> names;
    bool in_function = false;
    for_each_instruction(spirv, [&](spv::Op op, const uint32_t* words, uint32_t count) {
        if (op == spv::OpName && count >= 3) {
            const auto* name = reinterpret_cast<const char*>(words + 2);
            names[words[1]] = std::string(name, strnlen(name, (count - 2) * sizeof(uint32_t)));
        }
        if (op == spv::OpDecorate && count == 4 && words[2] == spv::DecorationDescriptorSet) sets[words[1]] = words[3];
        if (op == spv::OpDecorate && count == 4 && words[2] == spv::DecorationBinding) bindings[words[1]] = words[3];
        if (op == spv::OpTypePointer && count >= 4) pointees[words[1]] = words[3];
        if (op == spv::OpTypeAccelerationStructureKHR && count >= 2) structures.insert(words[1]);
        if (op == spv::OpFunction) in_function = true;
        if (op == spv::OpVariable && count >= 3 && !in_function) variables[words[2]] = words[1];
        // A literal that happens to equal an id only makes an unused buffer count as used, which is harmless.
        if (in_function) used.insert(words + 1, words + count);
    });
    std::vector<ShaderBinding> result;
    for (const auto& [variable, type] : variables) {
        if (!bindings.count(variable) || !used.count(variable)) continue;
        // A buffer's block is called NAMEBlock (prelude.h); the variable itself has no name.
        const bool structure = structures.count(pointees[type]) != 0;
        std::string name = structure ? names[variable] : names[pointees[type]];
        constexpr std::string_view kBlock = "Block";
        if (name.ends_with(kBlock)) name.resize(name.size() - kBlock.size());
        result.push_back({sets[variable], bindings[variable], structure, std::move(name)});
    }
    std::sort(result.begin(), result.end(), [](const ShaderBinding& a, const ShaderBinding& b) {
        return std::tie(a.set, a.binding) < std::tie(b.set, b.binding);
    });
    return result;
}

}  // namespace lampyris::shaders
