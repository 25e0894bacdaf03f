// lampyris bench photon-maps: the cost of each photon-query structure, compared with the memory traffic that it cannot avoid.
#include "commands/command.h"
#include "commands/console.h"
#include "commands/photon_bench.h"
#include "commands/render_options.h"
#include "core/base/error.h"
#include "core/base/plugin.h"
#include "core/device/device.h"
#include "core/photons/photon_map.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace lampyris {
namespace {

using Json = nlohmann::ordered_json;

struct BenchOptions {
    std::vector<std::string> structures, backends{"cpu"}, points{"1e3", "1e4", "1e5", "1e6"}, plugins;
    std::vector<std::string> distributions{"uniform"};
    std::string json_file;
    DeviceOptions device;
    PhotonBenchSettings settings;
    bool json = false;
};

// "1e6", "1000".
uint32_t parse_count(const std::string& text) {
    double value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc() || end != text.data() + text.size() ||
        !(value >= 1 && value <= 2e8 && value == std::floor(value)))
        throw InputError(
            fmt::format("error: --points {}: expected whole numbers from 1 to 2e8, for example 1e3,1e6", text));
    return uint32_t(value);
}

// Commas separate structures, and also the parameters of one: "a,b:x=1,y=2" is a and b:x=1,y=2.
std::vector<std::string> join_parameters(const std::vector<std::string>& pieces) {
    std::vector<std::string> structures;
    for (const std::string& piece : pieces) {
        const bool is_parameter = piece.find('=') != std::string::npos && piece.find(':') == std::string::npos;
        if (is_parameter && !structures.empty() && structures.back().find(':') != std::string::npos) {
            structures.back() += "," + piece;
        } else {
            structures.push_back(piece);
        }
    }
    return structures;
}

// Every structure but the one that is too slow to wait for.
std::vector<std::string> all_structures() {
    std::vector<std::string> names;
    for (const std::string& name : photon_maps().names())
        if (name != "brute_force") names.push_back(name);
    return names;
}

Json to_json(const PhotonBenchRow& row) {
    Json parameters = Json::object();
    for (const auto& [key, value] : row.parameters) parameters[key] = value;
    return {{"structure", row.structure},
            {"parameters", parameters},
            {"backend", row.backend},
            {"points", row.points},
            {"distribution", row.distribution},
            {"construction_ns_per_point", row.construction_ns_per_point},
            {"floor_ns_per_point", row.floor_ns_per_point > 0.0 ? Json(row.floor_ns_per_point) : Json()},
            {"query_ns", row.query_ns},
            {"bytes_per_point", row.bytes_per_point},
            {"photons_found_mean", row.photons_found_mean}};
}

void print_row(const PhotonBenchRow& row) {
    const std::string over_floor = row.floor_ns_per_point > 0
                                       ? fmt::format("{:.2f}", row.construction_ns_per_point / row.floor_ns_per_point)
                                       : "-";
    fmt::print("{:<8} {:<10} {:>10} {:<24} {:>10.2f} {:>8} {:>10.0f} {:>10.1f} {:>10.2f}\n", row.backend,
               row.distribution, row.points, row.structure, row.construction_ns_per_point, over_floor, row.query_ns,
               row.bytes_per_point, row.photons_found_mean);
}

int bench(const BenchOptions& options) {
    check_registrations();
    load_plugins(options.plugins);
    const std::vector<std::string> structures =
        options.structures.empty() ? all_structures() : join_parameters(options.structures);
    for (const std::string& structure : structures) create_photon_map(structure);  // report errors early
    std::vector<uint32_t> counts;
    for (const std::string& text : options.points) counts.push_back(parse_count(text));
    Json json{{"schema", "lampyris.photon-bench/1"}};
    Json rows = Json::array(), floor_rows = Json::array(), failed = Json::array();
    for (const std::string& backend : options.backends) {
        const std::unique_ptr<Device> device = create_device(backend, options.device);
        DeviceOptions alone = options.device;
        alone.threads = 1;
        // For structures that one thread builds.
        const std::unique_ptr<Device> one_thread = backend == "vulkan" ? nullptr : create_device(backend, alone);
        for (const uint32_t count : counts) {
            // If the device reports no number of threads: as many as a CPU in its place would have.
            const unsigned threads =
                device->threads() ? device->threads() : std::max(1u, std::thread::hardware_concurrency());
            const double sort_ns = measure_sort(count, threads, options.settings);
            // Measured again for each row, because a machine's speed varies from one second to the next.
            const auto measure_floors = [&] {
                PhotonBenchFloors floors;
                floors.all = measure_floor(*device, count, options.settings);
                if (one_thread) floors.one_thread = measure_floor(*one_thread, count, options.settings);
                floors.all.sort_ns = sort_ns;
                floors.one_thread.sort_ns = sort_ns * threads;
                return floors;
            };
            const PhotonBenchFloor floor = measure_floors().all;
            Json entry{{"scatter_ns", floor.scatter_ns},
                       {"atomic_ns", floor.atomic_ns},
                       {"sort_ns", floor.sort_ns},
                       {"backend", backend},
                       {"points", count}};
            json["floor"] = {{"scatter_ns", floor.scatter_ns}, {"atomic_ns", floor.atomic_ns}};
            floor_rows.push_back(entry);
            if (!options.json)
                fmt::print(
                    "{} floor at {} points: random scatter {:.2f} ns, random atomic add {:.2f} ns a point\n"
                    "{:<8} {:<10} {:>10} {:<24} {:>10} {:>8} {:>10} {:>10} {:>10}\n",
                    backend, count, floor.scatter_ns, floor.atomic_ns, "backend", "points are", "points", "structure",
                    "build ns", "x floor", "query ns", "bytes", "found");
            for (const std::string& distribution : options.distributions) {
                for (const std::string& structure : structures) {
                    try {
                        const PhotonBenchRow row = measure_photon_map(*device, structure, count, distribution,
                                                                      measure_floors(), options.settings);
                        rows.push_back(to_json(row));
                        if (!options.json) print_row(row);
                    } catch (const MachineError& error) {
                        // Some structures need more memory than others, or a feature that a device lacks: the others are
                        // measured anyway.
                        tell("{} {} {} {}: {}\n", backend, distribution, count, structure, error.what());
                        failed.push_back({{"structure", structure},
                                          {"backend", backend},
                                          {"points", count},
                                          {"distribution", distribution},
                                          {"error", error.what()}});
                    }
                }
            }
        }
    }
    json["rows"] = rows;
    json["floors"] = floor_rows;
    json["failed"] = failed;
    if (options.json) fmt::print("{}\n", json.dump(2));
    return int(failed.empty() ? ExitCode::kDone : ExitCode::kMachineCannot);
}

void add_bench(CLI::App& parent, std::function<int()>& run) {
    CLI::App* command = parent.add_subcommand("bench", "Measure parts of Lampyris on this machine");
    command->require_subcommand(1);
    auto options = std::make_shared<BenchOptions>();
    CLI::App* maps =
        command->add_subcommand("photon-maps", "Measure photon-query structures: time and memory per photon");
    maps->add_option("--structures", options->structures, "NAME[:key=value,...],... (default: all)")->delimiter(',');
    maps->add_option("--backend", options->backends, "cpu, cpu-bvh2, vulkan; several joined by commas")
        ->delimiter(',')
        ->capture_default_str();
    maps->add_option("--points", options->points, "numbers of photons")->delimiter(',')->capture_default_str();
    maps->add_option("--distribution", options->distributions, "uniform, clustered, planar")
        ->delimiter(',')
        ->check(CLI::IsMember(photon_distributions()))
        ->capture_default_str();
    maps->add_option("--queries", options->settings.queries, "queries per measurement")->capture_default_str();
    maps->add_option("--found", options->settings.found, "average photons per query")->capture_default_str();
    maps->add_option("--seconds", options->settings.seconds, "shortest time of a measurement")->capture_default_str();
    maps->add_option("--device", options->device.device, "number, or part of the name");
    maps->add_option("--threads", options->device.threads, "of the CPU backends (0: all)");
    maps->add_option("--plugin", options->plugins, "load a plugin first")->type_name("FILE.so");
    maps->add_flag("--json", options->json, "print JSON, schema lampyris.photon-bench/1 (docs/photon-maps.md)");
    maps->callback([&run, options] { run = [options] { return bench(*options); }; });
}

REGISTER_COMMAND(add_bench);

}  // namespace
}  // namespace lampyris
