#include "core/kernel_registry.h"

#include <fmt/format.h>

#include <bit>
#include <map>
#include <stdexcept>

namespace lampyris {
namespace {

struct Build {
    CpuTracerKind tracer;
    uint32_t effects;
    CpuKernelFunction run;
};

// Function-local statics: registrations run before main, in no order.
std::multimap<std::string, Build, std::less<>>& builds() {
    static std::multimap<std::string, Build, std::less<>> map;
    return map;
}
std::map<std::string, std::string_view, std::less<>>& texts() {
    static std::map<std::string, std::string_view, std::less<>> map;
    return map;
}

}  // namespace

CpuKernelVariant::CpuKernelVariant(const char* file, CpuTracerKind tracer, uint32_t effects, CpuKernelFunction run) {
    builds().insert({file, Build{tracer, effects, run}});
}

KernelText::KernelText(const char* file, std::string_view text) { texts().insert_or_assign(file, text); }

const std::string_view* find_kernel_text(std::string_view file) {
    const auto found = texts().find(file);
    return found == texts().end() ? nullptr : &found->second;
}

std::vector<std::string> kernel_text_files() {
    std::vector<std::string> files;
    for (const auto& [file, text] : texts()) files.push_back(file);
    return files;
}

CpuKernelFunction find_cpu_kernel(std::string_view file, CpuTracerKind tracer, uint32_t effects) {
    const Build* best = nullptr;
    const auto [begin, end] = builds().equal_range(file);
    for (auto it = begin; it != end; ++it) {
        const Build& build = it->second;
        if (build.tracer != tracer || (effects & ~build.effects) != 0) continue;
        if (!best || std::popcount(build.effects) < std::popcount(best->effects)) best = &build;
    }
    if (!best) throw std::logic_error(fmt::format("no C++ build of kernel {} with effects {:#x}", file, effects));
    return best->run;
}

}  // namespace lampyris
