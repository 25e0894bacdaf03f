#include "core/device/device_choice.h"

#include "core/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace lampyris {
namespace {

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return text;
}

}  // namespace

size_t choose_device(std::span<const std::string> names, const std::string& wish, const std::string& backend) {
    if (wish.empty()) return 0;
    const bool is_number = std::all_of(wish.begin(), wish.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
    std::string list;
    for (size_t i = 0; i < names.size(); ++i) {
        const bool meant =
            is_number ? wish == std::to_string(i) : lower(names[i]).find(lower(wish)) != std::string::npos;
        if (meant) return i;
        list += fmt::format("{}{} {}", i ? ", " : "", i, names[i]);
    }
    throw MachineError(fmt::format("error: --device {}: {} has no such device; it has {}", wish, backend, list));
}

}  // namespace lampyris
