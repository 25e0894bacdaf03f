// Plugins by name. One registry per kind (shapes, materials, integrators, ...); entries register themselves when the
// library, or a plugin's shared object, is loaded. No list of plugins is kept by hand.
#pragma once

#include "core/base/error.h"
#include "core/base/parameters.h"

#include <fmt/format.h>

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lampyris {

struct PluginInfo {
    std::string name;
    std::string summary;  // one sentence
    ParameterSpecs parameters;
};

// What all registries have in common: enough for `lampyris plugins` and the reference page.
class RegistryBase {
 public:
    RegistryBase(std::string kind, std::string title);
    virtual ~RegistryBase() = default;
    RegistryBase(const RegistryBase&) = delete;
    RegistryBase& operator=(const RegistryBase&) = delete;

    const std::string& kind() const { return kind_; }    // the kind's name in messages and on the command line: "shape"
    const std::string& title() const { return title_; }  // what a plugin of this kind is, in one sentence
    std::vector<std::string> names() const;
    const PluginInfo* find_info(std::string_view name) const;
    // "unknown shape \"sphre\"", and a hint for Diagnostics with the nearest name and the list.
    std::pair<std::string, std::string> unknown(std::string_view name) const;

 protected:
    bool add_info(PluginInfo info);  // false if the name is taken, which is recorded as an error

 private:
    std::string kind_, title_;
    std::map<std::string, PluginInfo, std::less<>> infos_;
};

// Every registry with entries, by kind.
std::vector<const RegistryBase*> registries();
// Reports two plugins with the same name, which are detected while static initializers run. Throws InputError. To be called
// once everything is loaded, and again after each plugin.
void check_registrations();

template <typename Factory>
class Registry : public RegistryBase {
 public:
    using RegistryBase::RegistryBase;

    void add(PluginInfo info, Factory factory) {
        std::string name = info.name;
        if (add_info(std::move(info))) factories_.emplace(std::move(name), std::move(factory));
    }
    const Factory* find(std::string_view name) const {
        const auto found = factories_.find(name);
        return found == factories_.end() ? nullptr : &found->second;
    }
    // For names from the command line. Throws InputError with the list.
    const Factory& require(std::string_view name) const {
        if (const Factory* found = find(name)) return *found;
        const auto [message, hint] = unknown(name);
        throw InputError(fmt::format("error: {}{}{}", message, hint.starts_with(' ') ? "" : "; ", hint));
    }

 private:
    std::map<std::string, Factory, std::less<>> factories_;
};

}  // namespace lampyris
