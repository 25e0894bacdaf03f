#include "backends/shaders/spirv.h"

#include <glslang/SPIRV/GLSL.std.450.h>

#include <fmt/format.h>

#include <map>
#include <set>
#include <stdexcept>
#include <string_view>

namespace lampyris::shaders {
namespace {

constexpr std::string_view kPrefix = "exact_", kQuotient = "exact_quotient(", kRoot = "exact_root(";

struct Replacements {
    std::map<uint32_t, uint32_t> quotient, root;  // type -> function
    std::set<uint32_t> functions;                 // of exact.glsl
    uint32_t instructions = 0;                    // the id of GLSL.std.450
    uint32_t main = 0;
};

Replacements find_replacements(const Spirv& spirv) {
    Replacements found;
    std::map<uint32_t, std::string_view> names;
    for_each_instruction(spirv, [&](spv::Op op, const uint32_t* words, uint32_t) {
        if (op == spv::OpExtInstImport && std::string_view(reinterpret_cast<const char*>(words + 2)) == "GLSL.std.450")
            found.instructions = words[1];
        if (op == spv::OpEntryPoint) found.main = words[2];
        if (op == spv::OpName) names[words[1]] = reinterpret_cast<const char*>(words + 2);
        if (op != spv::OpFunction) return;
        const auto name = names.find(words[2]);
        if (name == names.end() || !name->second.starts_with(kPrefix)) return;
        found.functions.insert(words[2]);
        if (name->second.starts_with(kQuotient)) found.quotient[words[1]] = words[2];
        if (name->second.starts_with(kRoot)) found.root[words[1]] = words[2];
    });
    return found;
}

void call(Spirv& out, const std::map<uint32_t, uint32_t>& functions, const uint32_t* words, const uint32_t* arguments,
          uint32_t count) {
    const auto function = functions.find(words[1]);
    if (function == functions.end())
        throw std::logic_error(fmt::format("no function of exact.glsl has the type of %{}", words[2]));
    out.insert(out.end(), {(4 + count) << 16 | uint32_t(spv::OpFunctionCall), words[1], words[2], function->second});
    out.insert(out.end(), arguments, arguments + count);
}

}  // namespace

Spirv exact_arithmetic(const Spirv& spirv, bool flush_denormals) {
    const Replacements found = find_replacements(spirv);
    Spirv out(spirv.begin(), spirv.begin() + kHeaderWords);
    out.reserve(spirv.size() + spirv.size() / 8);
    bool inside = false, capable = false, told = false;
    for_each_instruction(spirv, [&](spv::Op op, const uint32_t* words, uint32_t count) {
        if (flush_denormals && !capable && op != spv::OpCapability) {
            out.insert(out.end(), {2u << 16 | uint32_t(spv::OpCapability), spv::CapabilityDenormFlushToZero});
            capable = true;
        }
        if (op == spv::OpFunction) inside = found.functions.count(words[2]) != 0;
        if (!inside && op == spv::OpFDiv) return call(out, found.quotient, words, words + 3, 2);
        if (!inside && op == spv::OpExtInst && words[3] == found.instructions && words[4] == GLSLstd450Sqrt)
            return call(out, found.root, words, words + 5, 1);
        out.insert(out.end(), words, words + count);
        if (flush_denormals && !told && op == spv::OpExecutionMode) {
            out.insert(out.end(), {4u << 16 | uint32_t(spv::OpExecutionMode), found.main,
                                   spv::ExecutionModeDenormFlushToZero, 32});
            told = true;
        }
    });
    return out;
}

}  // namespace lampyris::shaders
