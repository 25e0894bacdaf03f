// Kernel text to SPIR-V: glslang, then exact_arithmetic and forbid_contraction, then SPIRV-Tools' optimizer, then the cache on disk.
#pragma once

#include "backends/shaders/shader_cache.h"
#include "backends/shaders/spirv.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace lampyris::shaders {

struct ShaderOptions {
    uint64_t effects = 0;          // the exact mask: code for other effects is compiled out
    bool precise = true;           // forbid contraction
    bool exact = false;            // quotients and square roots by core/kernel/exact.glsl
    bool flush_denormals = false;  // as on the CPU; only with `exact`
    bool optimize = true;          // remove code that the effects disable
    bool inlined = true;           // and inline and simplify the rest (every driver does that again)
    bool ray_query = false;        // trace with VK_KHR_ray_query instead of the BVH in the shader
    bool wide_reads = false;       // READ_PAIR reads 64-bit words (prelude.h)
    bool names = false;            // keep them, for kernels without a C++ build that could tell the buffers' names
    uint32_t local_size = 64;
};

struct CompiledShader {
    Spirv spirv;
    bool from_cache = false;
};

// Throws InputError with glslang's messages (file:line of the kernel's own files) where the kernel is not valid GLSL. `trimmed` is told
// the number of words that the effects leave, before most of the time is spent; it may throw.
CompiledShader compile_shader(std::string_view kernel_file, const ShaderOptions& options, const ShaderCache& cache,
                              const std::function<void(size_t words)>& trimmed = {});

// What compile_shader has put into the cache.
std::optional<Spirv> find_shader(std::string_view kernel_file, const ShaderOptions& options, const ShaderCache& cache);

// The entry text that compile_shader hands to glslang: defines, and includes of the kernel and of core/kernel/entry.glsl.
std::string shader_source(std::string_view kernel_file, const ShaderOptions& options);

}  // namespace lampyris::shaders
