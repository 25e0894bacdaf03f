#include "core/device/kernel_registry.h"

#include "core/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <map>
#include <stdexcept>

namespace lampyris {
namespace {

struct Build {
    uint64_t effects;
    CpuKernelFunction run;
    CpuKernelDeclaration declare;
};

// Function-local statics, because registrations run before main, in no defined order.
std::multimap<std::string, Build, std::less<>>& builds() {
    static std::multimap<std::string, Build, std::less<>> map;
    return map;
}
std::map<std::string, std::string_view, std::less<>>& texts() {
    static std::map<std::string, std::string_view, std::less<>> map;
    return map;
}

}  // namespace

CpuKernelVariant::CpuKernelVariant(const char* file, uint64_t effects, CpuKernelFunction run,
                                   CpuKernelDeclaration declare) {
    builds().insert({file, Build{effects, run, declare}});
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

std::vector<std::string_view> kernel_parts(std::string_view file) {
    std::vector<std::string_view> parts;
    for (size_t plus; (plus = file.find('+')) != std::string_view::npos; file.remove_prefix(plus + 1))
        parts.push_back(file.substr(0, plus));
    parts.push_back(file);
    if (file.ends_with(".radiance.h")) parts.push_back(kPixelLoop);
    return parts;
}

CpuKernelFunction find_cpu_kernel(std::string_view file, uint64_t effects) {
    const Build* best = nullptr;
    const auto [begin, end] = builds().equal_range(file);
    for (auto it = begin; it != end; ++it) {
        const Build& build = it->second;
        if ((effects & ~build.effects) != 0) continue;
        if (!best || std::popcount(build.effects) < std::popcount(best->effects)) best = &build;
    }
    const std::vector<std::string_view> parts = kernel_parts(file);
    const bool known = std::all_of(parts.begin(), parts.end(), [](auto part) { return find_kernel_text(part); });
    if (!best && parts.size() > 1 && known)
        throw InputError(fmt::format(
            "error: {} were not compiled together: they come from two plugins; build both in one (lampyris_add_plugin)",
            list_of({parts.begin(), parts.end()})));
    if (!best) throw std::logic_error(fmt::format("no C++ build of kernel {} with effects {:#x}", file, effects));
    return best->run;
}

std::optional<std::vector<KernelBuffer>> find_kernel_buffers(std::string_view file) {
    const auto found = builds().find(file);
    if (found == builds().end()) return std::nullopt;
    std::vector<KernelBuffer> declared;
    found->second.declare(declared);
    return declared;
}

}  // namespace lampyris
