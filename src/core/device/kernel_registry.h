// Kernels by name: their text for glslang, their C++ builds for the CPU. Filled by static registration (built in, or when
// a plugin is loaded); see cmake/LampyrisKernels.cmake.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lampyris {

// The primitive that a ray hit. Distance and position are recomputed in shared code, so that backends agree to the bit.
struct TraceHit {
    uint32_t instance, geometry, primitive;
};

// The ray tracer that a C++ kernel calls. Rays are half-open: hits with 0 < t < t_max count.
struct CpuTracer {
    void* scene = nullptr;
    bool (*closest)(void* scene, const float origin[3], const float direction[3], float t_max, TraceHit& hit) = nullptr;
    bool (*occluded)(void* scene, const float origin[3], const float direction[3], float t_max) = nullptr;
};

// A buffer that a kernel declares (BUFFER_RO, BUFFER_RW).
struct KernelBuffer {
    uint32_t binding = 0;  // of set 1
    std::string name;
    size_t element_bytes = 0;
};

// The kernel's buffers by binding. If `declared` is set, accesses are recorded there, and no buffer is returned.
struct KernelBufferTable {
    void* const* pointers = nullptr;
    std::vector<KernelBuffer>* declared = nullptr;
    void* at(uint32_t binding, const char* name, size_t element_bytes) const {
        if (!declared) return pointers[binding];
        declared->push_back({binding, name, element_bytes});
        return nullptr;
    }
};

struct CpuInvocation {
    void* const* scene_buffers;
    void* const* kernel_buffers;
    const CpuTracer* tracer;
    uint32_t begin, end;
    uint32_t* unfinished = nullptr;  // set to nonzero if a kernel reports an unfinished loop
};

using CpuKernelFunction = void (*)(const CpuInvocation&);
using CpuKernelDeclaration = void (*)(std::vector<KernelBuffer>& declared);

// A C++ build of a kernel for a set of effects; registers itself.
struct CpuKernelVariant {
    CpuKernelVariant(const char* file, uint64_t effects, CpuKernelFunction run, CpuKernelDeclaration declare);
};

// A kernel file's or header's text; registers itself.
struct KernelText {
    KernelText(const char* file, std::string_view text);
};

// The text of a registered file ("core/kernel/prelude.h"); nullptr if there is none.
const std::string_view* find_kernel_text(std::string_view file);
std::vector<std::string> kernel_text_files();

// The files that make up a kernel: "a+b" is a, then b. A radiance function, "NAME.radiance.h", is followed by the loop over
// pixels.
std::vector<std::string_view> kernel_parts(std::string_view file);
inline constexpr std::string_view kPixelLoop = "core/kernel/pixel_loop.h";

// The C++ build that includes all of `effects` and the fewest others. Throws std::logic_error for an unknown kernel, and
// InputError for a pair of files from two plugins, for which there is no build.
CpuKernelFunction find_cpu_kernel(std::string_view file, uint64_t effects);

// The buffers that a kernel's C++ build declares; empty if there is no such build.
std::optional<std::vector<KernelBuffer>> find_kernel_buffers(std::string_view file);

}  // namespace lampyris
