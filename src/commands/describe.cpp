// lampyris describe SCENE: the effects that the scene needs, the directives that need them, and their cost.
#include "commands/command.h"
#include "commands/console.h"
#include "commands/render_options.h"
#include "core/base/error.h"
#include "core/base/text.h"
#include "core/render/pbrt_integrators.h"
#include "core/scene/load.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

namespace lampyris {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kDescribeSchema = "lampyris.describe/1";

struct DescribeOptions {
    std::string scene;
    std::vector<std::string> allowed;
    bool json = false, skip_unsupported = false;
};

struct Counts {
    size_t triangles = 0, patches = 0, quadrics = 0, triangles_with_instances = 0, memory = 0;
};

template <typename T>
size_t bytes_of(const std::vector<T>& values) {
    return values.size() * sizeof(T);
}

Counts count(const Scene& scene) {
    Counts counts;
    std::vector<size_t> triangles_of_set;
    for (const GeometrySet& set : scene.sets) {
        size_t triangles = 0;
        for (uint32_t i = set.first_geometry; i < set.first_geometry + set.geometry_count; ++i) {
            const kernel::GeometryRecord& geometry = scene.geometries[i];
            size_t& kind = geometry.kind == kernel::GEOMETRY_TRIANGLES  ? triangles
                           : geometry.kind == kernel::GEOMETRY_BILINEAR ? counts.patches
                                                                        : counts.quadrics;
            kind += geometry.primitive_count;
        }
        triangles_of_set.push_back(triangles);
        counts.triangles += triangles;
    }
    for (const uint32_t set : scene.instance_sets) counts.triangles_with_instances += triangles_of_set[set];
    counts.memory = bytes_of(scene.geometries) + bytes_of(scene.indices) + bytes_of(scene.positions) +
                    bytes_of(scene.normals) + bytes_of(scene.uvs) + bytes_of(scene.transforms) +
                    bytes_of(scene.instances) + bytes_of(scene.materials) + bytes_of(scene.texture_ops) +
                    bytes_of(scene.images) + bytes_of(scene.texels) + bytes_of(scene.lights) +
                    bytes_of(scene.distributions) + bytes_of(scene.media);
    return counts;
}

const EffectRequest* request_of(const Effects& effects, uint64_t effect) {
    for (const EffectRequest& request : effects.requests())
        if (request.effect == effect) return &request;
    return nullptr;
}

void print_table(const LoadedScene& loaded) {
    const Scene& scene = loaded.scene;
    const Counts counts = count(scene);
    const std::array<int, 4>& crop = loaded.settings.crop;
    print("scene        {}\n", scene.name);
    print("picture      {}x{}", scene.width(), scene.height());
    if (crop != std::array<int, 4>{0, 0, int(scene.width()), int(scene.height())})
        print(", of which {},{} to {},{}", crop[0], crop[1], crop[2], crop[3]);
    print(", {} a pixel ({})\n", counted(uint64_t(loaded.settings.samples_per_pixel), "sample"),
          loaded.settings.sampler);
    const std::string& asked = loaded.settings.integrator.type;
    const std::string renders = rendering_integrator(asked);
    print("integrator   {}{}\n", asked, renders == asked ? "" : fmt::format(" (rendered by {})", renders));
    print("shapes       {}, {}, {} in {}; {}", counted(counts.triangles, "triangle"),
          counted(counts.patches, "patch", "patches"), counted(counts.quadrics, "quadric"),
          counted(scene.geometries.size(), "geometry", "geometries"), counted(scene.instances.size() - 1, "instance"));
    if (scene.instances.size() > 1) print(" ({} in all)", counted(counts.triangles_with_instances, "triangle"));
    print("\nlights       {}, of which {} infinite\n", scene.lights.size(), scene.record.infinite_lights);
    print("materials    {}; {}, {}\n", scene.materials.size(), counted(scene.texture_ops.size(), "texture operation"),
          counted(scene.images.size(), "image"));
    print("memory       {:.1f} MB before acceleration structures\n\n", double(counts.memory) * 1e-6);

    size_t name_width = 6, asked_width = 8;
    for (const EffectInfo& info : known_effects())
        name_width = std::max(name_width, std::string_view(info.name).size());
    for (const EffectRequest& request : scene.effects.requests())
        asked_width = std::max(asked_width, request.asked_by.size());
    print("{:<{}}  {:<9}  {:<{}}  {}\n", "effect", name_width, "simulated", "asked by", asked_width, "cost");
    for (const EffectInfo& info : known_effects())
        if (const EffectRequest* request = request_of(scene.effects, info.effect))
            print("{:<{}}  {:<9}  {:<{}}  {}\n", info.name, name_width, "yes", request->asked_by, asked_width,
                  info.cost);
    for (const std::string& what : scene.unsupported)
        print("{:<{}}  {:<9}  {}\n", "(unsupported)", name_width, "no", what);
    std::string rest;
    for (const EffectInfo& info : known_effects())
        if (!request_of(scene.effects, info.effect)) rest += fmt::format("{}{}", rest.empty() ? "" : ", ", info.name);
    if (!rest.empty()) print("\nnot needed by this scene: {}\n", rest);
    for (const std::string& note : scene.notes) print("note: {}\n", note);
}

void print_json(const LoadedScene& loaded) {
    const Scene& scene = loaded.scene;
    const Counts counts = count(scene);
    Json json;
    json["schema"] = kDescribeSchema;
    json["scene"] = scene.name;
    json["scene_hash"] = fmt::format("{:016x}", scene.hash);
    json["resolution"] = {scene.width(), scene.height()};
    json["crop"] = loaded.settings.crop;
    json["samples_per_pixel"] = loaded.settings.samples_per_pixel;
    json["sampler"] = loaded.settings.sampler;
    json["integrator"] = loaded.settings.integrator.type;
    json["rendered_by"] = rendering_integrator(loaded.settings.integrator.type);
    json["triangles"] = counts.triangles;
    json["triangles_with_instances"] = counts.triangles_with_instances;
    json["patches"] = counts.patches;
    json["quadrics"] = counts.quadrics;
    json["geometries"] = scene.geometries.size();
    json["instances"] = scene.instances.size() - 1;
    json["lights"] = scene.lights.size();
    json["infinite_lights"] = scene.record.infinite_lights;
    json["materials"] = scene.materials.size();
    json["texture_operations"] = scene.texture_ops.size();
    json["images"] = scene.images.size();
    json["memory_bytes"] = counts.memory;
    json["parse_s"] = loaded.parse_s;
    json["build_s"] = loaded.build_s;
    json["effects"] = Json::array();
    for (const EffectInfo& info : known_effects()) {
        const EffectRequest* request = request_of(scene.effects, info.effect);
        Json effect;
        effect["name"] = info.name;
        effect["asked_by"] = request ? Json(request->asked_by) : Json(nullptr);
        effect["simulated"] = request != nullptr;
        effect["cost"] = info.cost;
        json["effects"].push_back(effect);
    }
    json["unsupported"] = scene.unsupported;
    json["notes"] = scene.notes;
    json["warnings"] = loaded.warnings;
    print_text(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

int describe(const DescribeOptions& options) {
    SceneSource source = SceneSource::of_file(options.scene);
    source.allowed_folders = allowed_folders(options.allowed);
    LoadedScene loaded = load_scene(std::move(source), {}, options.skip_unsupported);
    for (std::string& note : integrator_notes(loaded.settings.integrator, loaded.scene, *loaded.sources))
        loaded.scene.notes.push_back(std::move(note));
    for (const std::string& warning : loaded.warnings) tell("{}\n", warning);
    if (options.json)
        print_json(loaded);
    else
        print_table(loaded);
    return int(ExitCode::kDone);
}

void add_describe(CLI::App& parent, std::function<int()>& run) {
    auto options = std::make_shared<DescribeOptions>();
    CLI::App* command =
        parent.add_subcommand("describe", "Show what a scene needs, which parts need it, and what it costs");
    command->add_option("SCENE", options->scene, "a pbrt-v4 scene file")->required();
    command->add_flag("--json", options->json, "print JSON (docs/describe.md)");
    add_allow_option(*command, options->allowed);
    command->add_flag("--skip-unsupported", options->skip_unsupported,
                      "leave out what is not supported, instead of failing");
    command->callback([&run, options] { run = [options] { return describe(*options); }; });
}

REGISTER_COMMAND(add_describe);

}  // namespace
}  // namespace lampyris
