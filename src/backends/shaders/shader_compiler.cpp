#include "backends/shaders/shader_compiler.h"

#include "core/base/error.h"
#include "core/device/kernel_registry.h"

#include <fmt/format.h>
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>
#include <glslang/build_info.h>
#include <spirv-tools/libspirv.h>
#include <spirv-tools/optimizer.hpp>

#include <cstdlib>
#include <deque>
#include <mutex>
#include <set>

namespace lampyris::shaders {
namespace {

// To be raised when the steps from text to SPIR-V change. (The libraries' versions are a separate part of the key.)
constexpr uint64_t kPipelineVersion = 3;

// glslang folds constants in double precision, and so computes PI * PI from literals that are not floats; C++ rounds each
// literal first. Each literal is replaced by the exact decimal value of its float: products, quotients and sums of such values
// round to the same float either way.
std::string with_exact_literals(std::string_view text) {
    std::string out;
    out.reserve(text.size() + text.size() / 8);
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    const auto is_word = [&](char c) {
        return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    };
    for (size_t at = 0; at < text.size();) {
        const bool starts = is_digit(text[at]) && (at == 0 || (!is_word(text[at - 1]) && text[at - 1] != '.'));
        if (!starts) {
            out += text[at++];
            continue;
        }
        size_t end = at;
        while (end < text.size() &&
               (is_word(text[end]) || text[end] == '.' ||
                ((text[end] == '+' || text[end] == '-') && (text[end - 1] == 'e' || text[end - 1] == 'E'))))
            ++end;
        const std::string token(text.substr(at, end - at));
        const bool is_float = token.back() == 'f' && token.find('.') != std::string::npos &&
                              token.find_first_of("xX") == std::string::npos;
        if (is_float) {
            const std::string digits = fmt::format("{:.17g}", double(std::strtof(token.c_str(), nullptr)));
            out += digits + (digits.find_first_of(".e") == std::string::npos ? ".0f" : "f");
        } else {
            out += token;
        }
        at = end;
    }
    return out;
}

// Resolves #include "core/kernel/x.h" in the embedded texts.
class EmbeddedIncluder final : public glslang::TShader::Includer {
 public:
    IncludeResult* includeLocal(const char* name, const char*, size_t) override { return include(name); }
    IncludeResult* includeSystem(const char* name, const char*, size_t) override { return include(name); }
    void releaseInclude(IncludeResult* result) override { delete result; }

 private:
    IncludeResult* include(const char* name) {
        const std::string_view* text = find_kernel_text(name);
        if (!text) return nullptr;
        const std::string& exact = texts_.emplace_back(with_exact_literals(*text));
        return new IncludeResult(name, exact.data(), exact.size(), nullptr);
    }
    std::deque<std::string> texts_;
};

// The names in #include "..." lines.
std::vector<std::string_view> includes_of(std::string_view text) {
    std::vector<std::string_view> names;
    constexpr std::string_view kDirective = "#include \"";
    for (size_t at = 0; (at = text.find(kDirective, at)) != std::string_view::npos;) {
        at += kDirective.size();
        const size_t end = text.find('"', at);
        if (end == std::string_view::npos) break;
        names.push_back(text.substr(at, end - at));
    }
    return names;
}

// Adds a text and everything that it includes.
void add_text(ContentHash& hash, std::string_view text, std::set<std::string_view>& seen) {
    hash.add(text);
    for (const std::string_view name : includes_of(text)) {
        if (!seen.insert(name).second) continue;
        hash.add(name);
        if (const std::string_view* included = find_kernel_text(name)) add_text(hash, *included, seen);
    }
}

ContentHash key_of(const std::string& source, const ShaderOptions& options) {
    ContentHash hash;
    hash.add(kPipelineVersion);
    hash.add(fmt::format("glslang {}.{}.{} {}", GLSLANG_VERSION_MAJOR, GLSLANG_VERSION_MINOR, GLSLANG_VERSION_PATCH,
                         spvSoftwareVersionString()));
    hash.add(fmt::format("precise {} exact {} {} optimize {} inlined {}", options.precise, options.exact,
                         options.flush_denormals, options.optimize, options.inlined));
    if (options.names) hash.add("names");
    std::set<std::string_view> seen;
    add_text(hash, source, seen);
    return hash;
}

Spirv compile_glsl(std::string_view kernel_file, const std::string& source, bool keep_uncalled) {
    static std::mutex mutex;  // protects glslang's process state
    const std::lock_guard lock(mutex);
    static const bool ready = glslang::InitializeProcess();  // for as long as the process lives: any thread may compile
    if (!ready) throw std::logic_error("glslang does not start");
    glslang::TShader shader(EShLangCompute);
    const char* text = source.c_str();
    const int length = static_cast<int>(source.size());
    const std::string name = fmt::format("<entry of {}>", kernel_file);
    const char* names = name.c_str();
    shader.setStringsWithLengthsAndNames(&text, &length, &names, 1);
    shader.setEnvInput(glslang::EShSourceGlsl, EShLangCompute, glslang::EShClientVulkan, 100);
    shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_2);
    shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_5);
    EmbeddedIncluder includer;
    const auto messages = static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules |
                                                   (keep_uncalled ? EShMsgKeepUncalled : EShMsgDefault));
    const bool parsed = shader.parse(GetDefaultResources(), 460, false, messages, includer);
    glslang::TProgram program;
    program.addShader(&shader);
    if (!parsed || !program.link(messages)) {
        throw InputError(fmt::format("error: kernel {} is not valid GLSL:\n{}{}", kernel_file, shader.getInfoLog(),
                                     program.getInfoLog()));
    }
    Spirv spirv;
    glslang::SpvOptions options;
    options.disableOptimizer = true;  // the optimizer runs after forbid_contraction
    glslang::GlslangToSpv(*program.getIntermediate(EShLangCompute), spirv, nullptr, &options);
    return spirv;
}

Spirv run_passes(std::string_view kernel_file, const Spirv& spirv,
                 const std::function<void(spvtools::Optimizer&)>& add_passes) {
    spvtools::Optimizer optimizer(SPV_ENV_VULKAN_1_2);
    std::string log;
    optimizer.SetMessageConsumer(
        [&log](spv_message_level_t level, const char*, const spv_position_t&, const char* message) {
            if (level <= SPV_MSG_WARNING) log += fmt::format("{}\n", message);
        });
    add_passes(optimizer);
    spvtools::OptimizerOptions options;
    options.set_run_validator(false);
    Spirv result;
    if (!optimizer.Run(spirv.data(), spirv.size(), &result, options)) {
        throw std::logic_error(fmt::format("the SPIR-V optimizer failed on kernel {}: {}", kernel_file, log));
    }
    return result;
}

// Without names and the branches that HAS() disables: inlining everything before that takes nine times as long.
Spirv trim(std::string_view kernel_file, const Spirv& spirv, bool names) {
    return run_passes(kernel_file, spirv, [&](spvtools::Optimizer& optimizer) {
        if (!names) optimizer.RegisterPass(spvtools::CreateStripDebugInfoPass());
        optimizer.RegisterPass(spvtools::CreateCCPPass())
            .RegisterPass(spvtools::CreateDeadBranchElimPass())
            .RegisterPass(spvtools::CreateEliminateDeadFunctionsPass())
            .RegisterPass(spvtools::CreateAggressiveDCEPass(false, true));
    });
}

Spirv inline_all(std::string_view kernel_file, const Spirv& spirv) {
    return run_passes(kernel_file, spirv, [](spvtools::Optimizer& optimizer) {
        optimizer.RegisterPerformancePasses();
        optimizer.RegisterPass(spvtools::CreateAggressiveDCEPass(false, true));
    });
}

}  // namespace

std::string shader_source(std::string_view kernel_file, const ShaderOptions& options) {
    std::string includes;
    bool int64 = false, ray_query = options.ray_query;
    for (const std::string_view part : kernel_parts(kernel_file)) {
        includes += fmt::format("#include \"{}\"\n", part);
        const std::string_view* text = find_kernel_text(part);
        int64 = int64 || (text && text->find("uint64") != std::string_view::npos);
        ray_query = ray_query || (text && text->find("accelerationStructureEXT") != std::string_view::npos);
    }
    return fmt::format(
        "#version 460\n"
        "#extension GL_GOOGLE_include_directive : require\n"
        "{}{}{}{}"
        "#define KERNEL_TRACER_{} 1\n"
        "#define KERNEL_LOCAL_SIZE {}\n"
        "#define EffectSet uvec2\n"
        "#define EFFECT_BIT(bit) uvec2((bit) < 32 ? 1u << ((bit) & 31) : 0u, (bit) < 32 ? 0u : 1u << ((bit) & 31))\n"
        "const EffectSet kEffects = EffectSet({:#x}u, {:#x}u);\n"
        "{}{}"
        "#include \"core/kernel/entry.glsl\"\n",
        int64 || options.wide_reads ? "#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require\n" : "",
        int64 ? "#extension GL_EXT_shader_atomic_int64 : require\n" : "",
        ray_query ? "#extension GL_EXT_ray_query : require\n" : "",
        options.wide_reads ? "#define KERNEL_WIDE_READS 1\n" : "", options.ray_query ? "ray_query" : "bvh2",
        options.local_size, uint32_t(options.effects), uint32_t(options.effects >> 32),
        options.exact ? "#include \"core/kernel/exact.glsl\"\n" : "", includes);
}

std::optional<Spirv> find_shader(std::string_view kernel_file, const ShaderOptions& options, const ShaderCache& cache) {
    return cache.find(key_of(shader_source(kernel_file, options), options));
}

CompiledShader compile_shader(std::string_view kernel_file, const ShaderOptions& options, const ShaderCache& cache,
                              const std::function<void(size_t words)>& trimmed) {
    for (const std::string_view part : kernel_parts(kernel_file))
        if (!find_kernel_text(part)) throw std::logic_error(fmt::format("there is no kernel {}", part));
    const std::string source = shader_source(kernel_file, options);
    const ContentHash key = key_of(source, options);
    if (auto found = cache.find(key)) return {std::move(*found), true};
    Spirv spirv = compile_glsl(kernel_file, source, options.exact);  // keep exact.glsl, not called yet
    if (options.exact) spirv = exact_arithmetic(spirv, options.flush_denormals);
    if (options.precise) spirv = forbid_contraction(spirv);
    if (options.optimize) {
        spirv = trim(kernel_file, spirv, options.names);
        if (trimmed) trimmed(spirv.size());
        if (options.inlined) spirv = inline_all(kernel_file, spirv);
    }
    cache.store(key, spirv);
    return {std::move(spirv), false};
}

}  // namespace lampyris::shaders
