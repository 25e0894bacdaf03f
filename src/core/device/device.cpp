#include "core/device/device.h"

#include "core/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <stdexcept>

namespace lampyris {
namespace {

struct Backend {
    std::string name, summary;
    std::function<std::unique_ptr<Device>(const DeviceOptions&)> create;
    std::function<std::vector<DeviceInfo>()> list;
};

// Registrations run before main, in no defined order, so names are sorted on demand.
std::map<std::string, Backend>& backends() {
    static std::map<std::string, Backend> map;
    return map;
}

}  // namespace

Kernel::Kernel(std::string_view file, std::vector<KernelBuffer> found) : file_(file) {
    std::optional<std::vector<KernelBuffer>> declared = find_kernel_buffers(file);
    all_known_ = declared.has_value();
    buffers_ = all_known_ ? std::move(*declared) : std::move(found);
}

bool Kernel::declares(std::string_view buffer) const {
    return std::any_of(buffers_.begin(), buffers_.end(), [&](const KernelBuffer& b) { return b.name == buffer; });
}

std::vector<BufferHandle> Kernel::bind(std::span<const NamedBuffer> given) const {
    const auto fail = [&](const std::string& what) {
        std::vector<std::string> names;
        for (const KernelBuffer& declared : buffers_) names.push_back(declared.name);
        throw std::logic_error(fmt::format("kernel {}: {}; it declares {}", file_, what, list_of(names)));
    };
    std::vector<BufferHandle> bound;
    for (const KernelBuffer& declared : buffers_) {
        const auto of_name = [&](const NamedBuffer& buffer) { return buffer.name == declared.name; };
        const auto found = std::find_if(given.begin(), given.end(), of_name);
        if (found == given.end() || !found->buffer) fail(fmt::format("it was not given \"{}\"", declared.name));
        if (std::find_if(found + 1, given.end(), of_name) != given.end())
            fail(fmt::format("it was given \"{}\" twice", declared.name));
        if (found->buffer->size() > 0 && found->buffer->size() < declared.element_bytes)
            fail(fmt::format("\"{}\" has {} bytes, and one element takes {}", declared.name, found->buffer->size(),
                             declared.element_bytes));
        if (bound.size() <= declared.binding) bound.resize(declared.binding + 1);
        bound[declared.binding] = found->buffer;
    }
    if (all_known_)
        for (const NamedBuffer& buffer : given)
            if (!declares(buffer.name)) fail(fmt::format("it was given \"{}\"", buffer.name));
    return bound;
}

size_t Device::build_boxes(const BufferHandle&, uint32_t) {
    throw MachineError(fmt::format("error: {} builds no acceleration structures over boxes", description()));
}

BackendRegistration::BackendRegistration(const char* name, const char* summary,
                                         std::function<std::unique_ptr<Device>(const DeviceOptions&)> create,
                                         std::function<std::vector<DeviceInfo>()> list) {
    backends().insert_or_assign(name, Backend{name, summary, std::move(create), std::move(list)});
}

void check_settings(const std::string& backend, const DeviceOptions& options, const std::vector<std::string>& known) {
    for (const auto& [key, value] : options.settings)
        if (std::find(known.begin(), known.end(), key) == known.end())
            throw InputError(fmt::format("error: backend {} has no setting \"{}\"{}; {}", backend, key,
                                         did_you_mean(key, known),
                                         known.empty() ? "it has none" : "settings are " + list_of(known)));
}

Switch read_switch(const DeviceOptions& options, const std::string& key, Switch otherwise) {
    const auto found = options.settings.find(key);
    if (found == options.settings.end()) return otherwise;
    if (found->second == "on" || found->second == "true") return Switch::on;
    if (found->second == "off" || found->second == "false") return Switch::off;
    if (found->second == "auto") return Switch::automatic;
    throw InputError(fmt::format("error: --set backend.{}={}: valid are on, off and auto", key, found->second));
}

std::filesystem::path read_cache_folder(const DeviceOptions& options) {
    if (const auto found = options.settings.find("cache"); found != options.settings.end())
        return found->second == "off" ? std::filesystem::path() : std::filesystem::path(found->second);
    if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg && *xdg) return std::filesystem::path(xdg) / "lampyris";
    if (const char* home = std::getenv("HOME"); home && *home)
        return std::filesystem::path(home) / ".cache" / "lampyris";
    return {};
}

std::unique_ptr<Device> create_device(const std::string& backend, const DeviceOptions& options) {
    const auto found = backends().find(backend);
    if (found == backends().end())
        throw InputError(fmt::format("error: there is no backend \"{}\"{}; backends are {}", backend,
                                     did_you_mean(backend, backend_names()), list_of(backend_names())));
    return found->second.create(options);
}

std::vector<std::string> backend_names() {
    std::vector<std::string> names;
    for (const auto& [name, backend] : backends()) names.push_back(name);
    return names;
}

std::vector<std::pair<std::string, std::string>> backend_summaries() {
    std::vector<std::pair<std::string, std::string>> summaries;
    for (const auto& [name, backend] : backends()) summaries.emplace_back(name, backend.summary);
    return summaries;
}

std::vector<DeviceInfo> list_devices() {
    std::vector<DeviceInfo> devices;
    for (const auto& [name, backend] : backends())
        for (DeviceInfo& device : backend.list()) devices.push_back(std::move(device));
    return devices;
}

}  // namespace lampyris
