// The command line of `lampyris render`.
#pragma once

#include "core/device.h"
#include "core/image/image_io.h"
#include "core/parameters.h"
#include "core/render_session.h"
#include "core/scene/build.h"

#include <CLI/CLI.hpp>

#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lampyris {

struct RenderOptions {
    std::string scene;
    std::vector<std::string> outputs;
    std::string integrator;               // NAME[:key=value,...]; empty: the scene's
    PluginChoice integrator_choice;       // of it and of --set integrator.KEY=VALUE, by finish()
    std::string photon_map;               // the same
    std::optional<uint32_t> eye_samples;  // --spp, for integrators that tell it from --passes
    std::string backend = "cpu";
    DeviceOptions device;
    std::optional<uint32_t> seed;
    BudgetLimits limits;
    BuildOptions build;
    WriteOptions write;
    std::string reference, statistics_file;
    std::vector<std::string> plugins;
    bool skip_unsupported = false, quiet = false;
    std::optional<std::array<int, 3>> replay;  // x, y, pass
    std::vector<std::pair<std::string, std::string>> settings_of(const std::string& section) const;

    // --passes alone: what integrators count that fix their eye samples.
    std::optional<uint64_t> pass_limit() const {
        return texts.passes ? std::optional<uint64_t>(uint64_t(*texts.passes)) : std::nullopt;
    }

    // Interprets the texts below; throws InputError. Loads the plugins.
    void finish();
    struct Texts {
        std::string resolution, crop, time, max_memory, replay;
        std::vector<std::string> settings;  // SECTION.KEY=VALUE
        std::optional<int64_t> spp, passes;
        std::optional<double> target_error;
    } texts;

 private:
    std::map<std::string, std::vector<std::pair<std::string, std::string>>> sections_;
};

void add_render_options(CLI::App& command, RenderOptions& options);

// "90", "30s", "5min", "2h", "500ms" in seconds; "8G", "512M", "1000" in bytes. Throw InputError that shows what is valid.
double parse_duration(const std::string& text);
uint64_t parse_size(const std::string& text);
// N integers separated by `separator`. Throws InputError: "error: OPTION text: expected FORM".
std::vector<int> parse_integers(const std::string& text, char separator, size_t count, const std::string& option,
                                const std::string& form);

}  // namespace lampyris
