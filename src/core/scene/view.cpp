#include "core/scene/film.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <cmath>

namespace lampyris {

Registry<FilmFactory>& film_registry() {
    static Registry<FilmFactory> registry("film", "What the image is written to: `Film \"name\"`.");
    return registry;
}
Registry<SamplerFactory>& sampler_registry() {
    static Registry<SamplerFactory> registry("sampler", "Sequences of sample points: `Sampler \"name\"`.");
    return registry;
}
RegisterFilm::RegisterFilm(const char* name, const char* summary, ParameterSpecs specs, FilmFactory factory) {
    film_registry().add({name, summary, std::move(specs)}, factory);
}
RegisterSampler::RegisterSampler(const char* name, const char* summary, ParameterSpecs specs, SamplerFactory factory) {
    sampler_registry().add({name, summary, std::move(specs)}, factory);
}

namespace {

// pbrt-v4's types for which Lampyris has no plugin.
bool is_pbrts(std::string_view type) { return type == "realistic" || type == "spherical" || type == "spectral"; }

// Finds the plugin of a directive and gives it a reader. If the directive is absent, `fallback` is used, as in pbrt-v4.
template <typename Factory, typename Call>
void build_entity(BuildContext& context, const Registry<Factory>& registry, Entity& entity, const char* fallback,
                  Call&& call) {
    const bool replaced = entity.given() && is_pbrts(entity.type) && !registry.find(entity.type);
    if (replaced)
        context.diagnostics.unsupported(entity.type_location, fmt::format("{} \"{}\"", registry.kind(), entity.type),
                                        fmt::format("--skip-unsupported renders with \"{}\" instead", fallback));
    if (!entity.given() || replaced) entity.type = fallback;
    const Factory* factory = registry.find(entity.type);
    if (!factory) {
        const auto [message, hint] = registry.unknown(entity.type);
        context.diagnostics.error(entity.type_location, message, hint);
        return;
    }
    ParameterReader reader(registry.find_info(entity.type)->parameters, entity, context.diagnostics);
    call(*factory, reader);
    if (replaced) return;  // its parameters were meant for the replaced plugin
    reader.finish(registry.kind());
}

void read_options(BuildContext& context) {
    for (const Parameter& option : context.description.options.parameters) {
        const auto* numbers = std::get_if<std::vector<int32_t>>(&option.values);
        const auto* truths = std::get_if<std::vector<uint8_t>>(&option.values);
        const bool is_on = truths && !truths->empty() && truths->front() != 0;
        if (option.name == "seed" && numbers && !numbers->empty()) {
            if (context.description.sampler.parameters.has("seed")) continue;  // the sampler's own seed wins
            context.settings.seed = uint32_t(numbers->front());
        } else if (is_on && (option.name == "disablepixeljitter" || option.name == "forcediffuse")) {
            context.diagnostics.unsupported(option.location, fmt::format("option \"{}\"", option.name));
        } else if (option.name != "seed") {
            context.scene.notes.push_back(fmt::format("Option \"{}\" does not apply", option.name));
        }
    }
}

void read_accelerator(BuildContext& context) {
    const Entity& accelerator = context.description.accelerator;
    if (!accelerator.given()) return;
    context.scene.notes.push_back(
        fmt::format("Accelerator \"{}\" is ignored: every backend has its own", accelerator.type));
}

}  // namespace

void build_view(BuildContext& context) {
    SceneDescription& description = context.description;
    kernel::CameraRecord& record = context.scene.record.camera;
    // How long the camera's shutter is open; a Film's "exposuretime" overrides it.
    record.imaging_ratio = 1.0f;
    build_entity(context, film_registry(), description.film, "rgb", [&](FilmFactory factory, ParameterReader& reader) {
        FilmContext film{context, reader, record};
        factory(film);
    });
    build_entity(context, filter_registry(), description.pixel_filter, "gaussian",
                 [&](FilterFactory factory, ParameterReader& reader) {
                     FilterContext filter{context, reader, record};
                     factory(filter);
                 });
    CameraDescription& camera = description.camera;
    context.scene.record.camera_medium = context.medium(camera.medium);
    if (camera.world_from_camera.animated()) context.refuse_motion(camera.world_from_camera, camera.location);
    if (!invertible(camera.world_from_camera.matrix[0]))
        context.diagnostics.error(camera.location, "the camera's transform cannot be inverted",
                                  "a scale by 0, or numbers out of range?");
    const kernel::TransformRecord world = transform_record(camera.world_from_camera.matrix[0]);
    record.to0 = world.to0, record.to1 = world.to1, record.to2 = world.to2;
    record.from0 = world.from0, record.from1 = world.from1, record.from2 = world.from2;
    record.volume = float(std::abs(glm::determinant(glm::dmat3(glm::mat3(camera.world_from_camera.matrix[0])))));
    build_entity(context, camera_registry(), camera, "perspective",
                 [&](CameraFactory factory, ParameterReader& reader) {
                     CameraContext view{context,
                                        camera,
                                        reader,
                                        record,
                                        glm::vec2(record.resolution_x, record.resolution_y),
                                        {&context, &camera, "Camera"}};
                     factory(view);
                 });
    build_entity(context, sampler_registry(), description.sampler, "zsobol",
                 [&](SamplerFactory factory, ParameterReader& reader) {
                     SamplerContext sampler{context, reader};
                     factory(sampler);
                 });
    read_options(context);
    read_accelerator(context);
    context.settings.integrator = std::move(description.integrator);
    if (!context.settings.integrator.given()) context.settings.integrator.type = "path";
}

}  // namespace lampyris
