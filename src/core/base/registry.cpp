#include "core/base/registry.h"

#include <algorithm>

namespace lampyris {

namespace {

struct Registrations {
    std::vector<const RegistryBase*> registries;
    std::vector<std::string> errors;
};

// Registrations run before main, in no defined order, so this must be created on first use.
Registrations& registrations() {
    static Registrations all;
    return all;
}

}  // namespace

RegistryBase::RegistryBase(std::string kind, std::string title) : kind_(std::move(kind)), title_(std::move(title)) {
    registrations().registries.push_back(this);
}

std::vector<std::string> RegistryBase::names() const {
    std::vector<std::string> names;
    for (const auto& [name, info] : infos_) names.push_back(name);
    return names;
}

const PluginInfo* RegistryBase::find_info(std::string_view name) const {
    const auto found = infos_.find(name);
    return found == infos_.end() ? nullptr : &found->second;
}

std::pair<std::string, std::string> RegistryBase::unknown(std::string_view name) const {
    const std::string near = did_you_mean(name, names());
    return {fmt::format("unknown {} \"{}\"", kind_, shown(name)),
            fmt::format("{}{}known: {}", near, near.empty() ? "" : "; ", list_of(names()))};
}

bool RegistryBase::add_info(PluginInfo info) {
    for (size_t i = 0; i < info.parameters.size(); ++i)
        for (size_t j = 0; j < i; ++j)
            if (info.parameters[i].name == info.parameters[j].name)
                registrations().errors.push_back(fmt::format("{} \"{}\" declares the parameter \"{}\" twice", kind_,
                                                             info.name, info.parameters[i].name));
    std::string name = info.name;
    if (infos_.emplace(name, std::move(info)).second) return true;
    registrations().errors.push_back(fmt::format("two plugins of kind {} are named \"{}\"", kind_, name));
    return false;
}

std::vector<const RegistryBase*> registries() {
    std::vector<const RegistryBase*> sorted = registrations().registries;
    std::sort(sorted.begin(), sorted.end(), [](const auto* a, const auto* b) { return a->kind() < b->kind(); });
    return sorted;
}

void check_registrations() {
    if (registrations().errors.empty()) return;
    std::string message;
    for (const std::string& error : registrations().errors)
        message += fmt::format("{}error: {}", message.empty() ? "" : "\n", error);
    throw InputError(message);
}

}  // namespace lampyris
