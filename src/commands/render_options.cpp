#include "commands/render_options.h"

#include "commands/console.h"
#include "core/base/error.h"
#include "core/base/plugin.h"
#include "core/scene/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string_view>
#include <system_error>
#include <utility>

namespace lampyris {
namespace {

// The number at the beginning of `text`, and what follows it.
bool leading_number(const std::string& text, double& value, std::string& rest) {
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || !std::isfinite(value) || value < 0.0) return false;
    rest.assign(stop, end);
    return true;
}

}  // namespace

double parse_duration(const std::string& text) {
    double value = 0.0;
    std::string unit;
    if (leading_number(text, value, unit) && value > 0.0) {
        if (unit.empty() || unit == "s") return value;
        if (unit == "ms") return value * 1e-3;
        if (unit == "m" || unit == "min") return value * 60.0;
        if (unit == "h") return value * 3600.0;
    }
    throw InputError(fmt::format("error: \"{}\" is no duration; write 30s, 500ms, 5min or 2h", text));
}

uint64_t parse_size(const std::string& text) {
    double value = 0.0;
    std::string unit;
    if (leading_number(text, value, unit) && value > 0.0 && value < 1e15) {
        if (unit.empty() || unit == "B") return uint64_t(value);
        if (unit == "K" || unit == "k") return uint64_t(value * 1024.0);
        if (unit == "M") return uint64_t(value * 1048576.0);
        if (unit == "G") return uint64_t(value * 1073741824.0);
    }
    throw InputError(fmt::format("error: \"{}\" is no amount of memory; write 512M or 8G", text));
}

std::vector<int> parse_integers(const std::string& text, char separator, size_t count, const std::string& option,
                                const std::string& form) {
    std::vector<int> numbers;
    const char* at = text.data();
    const char* const end = at + text.size();
    while (at != end) {
        int value = 0;
        const auto [stop, error] = std::from_chars(at, end, value);
        if (error == std::errc::result_out_of_range)
            throw InputError(
                fmt::format("error: {} {}: numbers are at most {}", option, text, std::numeric_limits<int>::max()));
        if (error != std::errc()) break;
        numbers.push_back(value);
        at = stop;
        if (at == end) break;
        if (*at != separator || ++at == end) {
            numbers.clear();
            break;
        }
    }
    if (numbers.size() != count || at != end)
        throw InputError(fmt::format("error: {} {}: write {}", option, text, form));
    return numbers;
}

void RenderOptions::tell_what_a_replay_ignores() const {
    if (quiet) return;
    for (const auto& [option, given] :
         {std::pair{"--output", !outputs.empty()}, std::pair{"--stats", !statistics_file.empty()},
          std::pair{"--crop", !texts.crop.empty()}, std::pair{"--passes", texts.passes.has_value()},
          std::pair{"--time", !texts.time.empty()}, std::pair{"--every", !texts.every.empty()},
          std::pair{"--target-error", request.limits.target_error.has_value()}})
        if (given) tell("note: {} has no effect: --replay prints one sample of one pixel\n", option);
}

void RenderOptions::finish() {
    load_plugins(plugins);
    request.scene = SceneSource::of_file(texts.scene);
    request.scene.allowed_folders = allowed_folders(allowed);
    if (!texts.resolution.empty()) {
        const std::vector<int> size =
            parse_integers(texts.resolution, 'x', 2, "--resolution", "WIDTHxHEIGHT, for example 640x480");
        request.build.resolution = {size[0], size[1]};
    }
    if (!texts.crop.empty()) {
        const std::vector<int> c = parse_integers(texts.crop, ',', 4, "--crop", "x0,y0,x1,y1 in pixels");
        request.build.crop = {c[0], c[1], c[2], c[3]};
    }
    if (!texts.replay.empty()) {
        const std::vector<int> r = parse_integers(texts.replay, ',', 3, "--replay", "x,y,pass");
        if (r[2] < 0) throw InputError(fmt::format("error: --replay {}: passes are counted from 0", texts.replay));
        request.replay = {r[0], r[1], r[2]};
        tell_what_a_replay_ignores();
    }
    BudgetLimits& limits = request.limits;
    if (!texts.every.empty()) request.checkpoint_every_s = every_s = parse_duration(texts.every);
    if (!texts.time.empty()) limits.seconds = parse_duration(texts.time);
    if (!texts.max_memory.empty())
        request.max_process_memory = request.device_options.max_memory = parse_size(texts.max_memory);
    for (const auto& [option, count] : {std::pair{"--spp", texts.spp}, std::pair{"--passes", texts.passes}})
        if (count && (*count < 1 || *count > kMostSamples))
            throw InputError(fmt::format("error: {} {}: expected 1 to {}", option, *count, kMostSamples));
    if (texts.spp) request.samples_per_pixel = uint32_t(*texts.spp);
    if (texts.passes) limits.passes = uint64_t(*texts.passes);
    if (!std::isfinite(write.exposure)) throw InputError("error: --exposure must be a number of stops");
    if (limits.accept_unstable && !limits.target_error)
        throw InputError("error: --accept-unstable has no effect without --target-error");
    for (const std::string& setting : texts.settings) {
        const size_t dot = setting.find('.'), equals = setting.find('=');
        if (dot == std::string::npos || equals == std::string::npos || dot > equals || dot == 0)
            throw InputError(
                fmt::format("error: --set {}: write SECTION.KEY=VALUE, for example integrator.maxdepth=12", setting));
        const std::string section = setting.substr(0, dot);
        std::string key = setting.substr(dot + 1, equals - dot - 1), value = setting.substr(equals + 1);
        if (section == "integrator")
            request.integrator_settings.emplace_back(std::move(key), std::move(value));
        else if (section == "backend")
            request.device_options.settings[key] = std::move(value);
        else
            throw InputError(fmt::format(
                "error: --set {}: there is no section \"{}\"; sections are integrator, backend", setting, section));
    }
}

// What is empty counts as not given, so that a script's unset variable would go unnoticed.
static const CLI::Validator not_empty(
    [](const std::string& text) { return std::string(text.empty() ? "is empty" : ""); }, "");

void add_render_options(CLI::App& command, RenderOptions& o) {
    command.add_option("SCENE", o.texts.scene, "Scene in pbrt-v4's text format")->required();
    command.add_option("-o,--output", o.outputs, "Image to write: .exr, .pfm or .png; may be given several times")
        ->type_name("IMAGE");
    command
        .add_option("--integrator", o.request.integrator, "Integrator to use instead of the scene's, with parameters")
        ->type_name("NAME[:key=value,...]");
    command
        .add_option("--photon-map", o.request.photon_map,
                    "Photon-query structure of integrators that use one, with parameters")
        ->type_name("NAME[:key=value,...]");
    command.add_option("--backend", o.request.backend, "Backend that renders: see `lampyris devices`")
        ->capture_default_str()
        ->type_name("NAME");
    command.add_option("--device", o.request.device_options.device, "Number or part of the name of the device")
        ->type_name("N|NAME");
    command.add_option("--threads", o.request.device_options.threads, "Threads of the CPU (default: all)")
        ->check(CLI::Range(1u, 4096u));
    command.add_option("--seed", o.request.seed, "Seed of the random numbers");
    command.add_option("--resolution", o.texts.resolution, "Size to use instead of the scene's")->type_name("WxH");
    command.add_option("--crop", o.texts.crop, "Render these pixels only (half-open)")->type_name("x0,y0,x1,y1");
    command
        .add_option(
            "--spp", o.texts.spp,
            "Stop after this many samples per pixel; ppm: number of hit points per pixel, which all passes share")
        ->type_name("N");
    command.add_option("--passes", o.texts.passes, "Stop after this many passes")->type_name("N");
    command.add_option("--time", o.texts.time, "Stop after this much rendering time: 30s, 5min, 2h")
        ->type_name("DURATION");
    command
        .add_option("--target-error", o.request.limits.target_error,
                    "Stop when the estimated relMSE is below this and can be trusted")
        ->type_name("E");
    command.add_flag("--accept-unstable", o.request.limits.accept_unstable,
                     "Let --target-error also stop at an estimate that cannot be trusted");
    command
        .add_option("--reference", o.request.reference,
                    "Reference image: the statistics then include the error against it over time")
        ->type_name("REF.exr");
    command.add_option("--stats", o.statistics_file, "Write statistics of the rendering as JSON")
        ->type_name("FILE.json");
    command
        .add_option("--checkpoint", o.request.checkpoint,
                    "Keep the state of the rendering in this file, so that --resume goes on after a crash")
        ->type_name("FILE");
    command.add_flag("--resume", o.request.resume, "Go on from the checkpoint, if there is one");
    command
        .add_option("--every", o.texts.every,
                    "Write the image and statistics so far, and the checkpoint, this often: 60s, 5min (default of "
                    "checkpoints: 60s)")
        ->type_name("DURATION");
    command.add_option("--plugin", o.plugins, "Load a plugin; may be given several times")->type_name("FILE.so");
    add_allow_option(command, o.allowed);
    command.add_flag("--skip-unsupported", o.request.skip_unsupported,
                     "Leave out what Lampyris does not simulate, and list it");
    command
        .add_option("--max-memory", o.texts.max_memory,
                    "Most memory for the program; buffers that do not fit are not made: 512M, 8G")
        ->type_name("SIZE");
    command.add_option("--view", o.write.view, "Display transform of a PNG")->capture_default_str()->type_name("NAME");
    command.add_option("--exposure", o.write.exposure, "Exposure of a PNG, in stops")->type_name("EV");
    command.add_option("--replay", o.texts.replay, "Render one sample of one pixel and print it")
        ->type_name("X,Y,PASS");
    command.add_option("--set", o.texts.settings, "Any parameter: integrator.maxdepth=12, backend.ray_query=on")
        ->type_name("SECTION.KEY=VALUE");
    command.add_flag("-q,--quiet", o.quiet, "Print errors only");
    for (CLI::Option* option : command.get_options())
        if (option->get_items_expected_max() > 0) option->check(not_empty);
}

void add_allow_option(CLI::App& command, std::vector<std::string>& folders) {
    command
        .add_option(
            "--allow", folders,
            "Let the scene read files in FOLDER, too, beyond its own folder; may be given several times, or as A:B; "
            "LAMPYRIS_ALLOW has more")
        ->type_name("FOLDER")
        ->allow_extra_args(false);
}

std::vector<std::string> allowed_folders(const std::vector<std::string>& lists) {
    std::vector<std::string> folders;
    const auto add = [&](std::string_view list, const char* giver) {
        while (!list.empty()) {
            const std::string folder(list.substr(0, list.find(':')));
            list.remove_prefix(std::min(folder.size() + 1, list.size()));
            std::error_code ignored;
            if (folder.empty()) continue;
            if (!std::filesystem::is_directory(folder, ignored))
                throw InputError(fmt::format("error: {}: there is no folder '{}'", giver, shown(folder)));
            folders.push_back(folder);
        }
    };
    for (const std::string& list : lists) add(list, "--allow");
    if (const char* list = std::getenv("LAMPYRIS_ALLOW")) add(list, "LAMPYRIS_ALLOW");
    return folders;
}

}  // namespace lampyris
