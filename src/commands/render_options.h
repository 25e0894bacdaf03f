// The command line of `lampyris render`.
#pragma once

#include "core/image/image_io.h"
#include "core/render/render.h"

#include <CLI/CLI.hpp>

#include <optional>
#include <string>
#include <vector>

namespace lampyris {

struct RenderOptions {
    RenderRequest request;  // complete after finish()
    std::vector<std::string> outputs;
    WriteOptions write;
    std::string statistics_file;
    double every_s = 0.0;  // between images of what is done so far; 0: none
    std::vector<std::string> plugins, allowed;
    bool quiet = false;

    // Interprets the texts below; throws InputError. Loads the plugins.
    void finish();
    void tell_what_a_replay_ignores() const;
    struct Texts {
        std::string scene, resolution, crop, time, max_memory, replay, every;
        std::vector<std::string> settings;  // SECTION.KEY=VALUE
        std::optional<int64_t> spp, passes;
    } texts;
};

void add_render_options(CLI::App& command, RenderOptions& options);
// For every command that reads a scene.
void add_allow_option(CLI::App& command, std::vector<std::string>& folders);
// Those folders, of which each text may name several, and LAMPYRIS_ALLOW's. Throws InputError if there is no such folder.
std::vector<std::string> allowed_folders(const std::vector<std::string>& lists);

// "90", "30s", "5min", "2h", "500ms" in seconds; "8G", "512M", "1000" in bytes. Throw InputError that shows what is valid.
double parse_duration(const std::string& text);
uint64_t parse_size(const std::string& text);
// N integers separated by `separator`. Throws InputError: "error: OPTION text: expected FORM".
std::vector<int> parse_integers(const std::string& text, char separator, size_t count, const std::string& option,
                                const std::string& form);

}  // namespace lampyris
