// lampyris devices: what this machine can render on.
#include "commands/command.h"
#include "core/device/device.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lampyris {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const std::vector<DeviceInfo>& devices) {
    Json list = Json::array();
    for (const DeviceInfo& device : devices) {
        list.push_back({{"backend", device.backend},
                        {"index", device.index},
                        {"name", device.name},
                        {"driver", device.driver},
                        {"memory_bytes", device.memory_bytes},
                        {"features", device.features}});
    }
    return {{"schema", "lampyris.devices/1"}, {"devices", list}};
}

std::string to_text(const std::vector<DeviceInfo>& devices) {
    std::string text;
    for (const DeviceInfo& device : devices) {
        text += fmt::format("{:<9} {}  {}\n             {}", device.backend, device.index, device.name, device.driver);
        if (device.memory_bytes) text += fmt::format(", {:.1f} GB", double(device.memory_bytes) / 1e9);
        for (const auto& [key, value] : device.features) text += fmt::format(", {} {}", key, value);
        text += "\n";
    }
    return text;
}

void add_devices(CLI::App& parent, std::function<int()>& run) {
    auto json = std::make_shared<bool>(false);
    CLI::App* command =
        parent.add_subcommand("devices", "List what each backend can run on (--backend NAME --device NUMBER)");
    command->add_flag("--json", *json, "print JSON, schema lampyris.devices/1 (docs/backends.md)");
    command->callback([&run, json] {
        run = [json] {
            const auto devices = list_devices();
            fmt::print("{}", *json ? to_json(devices).dump(2) + "\n" : to_text(devices));
            return 0;
        };
    });
}
REGISTER_COMMAND(add_devices);

}  // namespace
}  // namespace lampyris
