#include "core/device.h"

#include "core/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace lampyris {
namespace {

struct Backend {
    std::string name, summary;
    std::function<std::unique_ptr<Device>(const DeviceOptions&)> create;
    std::function<std::vector<DeviceInfo>()> list;
};

// Registrations run before main, in no order: names are sorted when asked for.
std::map<std::string, Backend>& backends() {
    static std::map<std::string, Backend> map;
    return map;
}

}  // namespace

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
