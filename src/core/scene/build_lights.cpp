#include "core/scene/build_lights.h"

#include "core/scene/light_distribution.h"
#include "core/scene/light_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lampyris {

void build_lights(BuildContext& context) {
    for (LightDescription& light : context.description.lights) {
        const LightFactory* factory = light_registry().find(light.type);
        if (!factory) {
            const auto [message, hint] = light_registry().unknown(light.type);
            context.diagnostics.error(light.type_location, message, hint);
            continue;
        }
        if (light.world_from_light.animated()) context.refuse_motion(light.world_from_light, light.location);
        ParameterReader reader(light_registry().find_info(light.type)->parameters, light, context.diagnostics);
        const size_t infinite = context.infinite_lights.size(), distant = context.distant_lights.size(),
                     others = context.lights.size();
        LightContext light_context{context, light, reader, {&context, &light, "LightSource"}};
        (*factory)(light_context);
        const uint32_t medium = context.medium(light.medium) << 16;
        for (size_t i = infinite; i < context.infinite_lights.size(); ++i)
            context.infinite_lights[i].record.flags |= medium;
        for (size_t i = distant; i < context.distant_lights.size(); ++i)
            context.distant_lights[i].record.flags |= medium;
        for (size_t i = others; i < context.lights.size(); ++i) context.lights[i].record.flags |= medium;
        reader.finish("light");
    }
}

void finish_lights(BuildContext& context) {
    Scene& scene = context.scene;
    const uint32_t infinite = uint32_t(context.infinite_lights.size());
    std::vector<BuildContext::PendingLight> all = std::move(context.infinite_lights);
    all.insert(all.end(), context.distant_lights.begin(), context.distant_lights.end());
    const uint32_t placeless = uint32_t(all.size());
    all.insert(all.end(), context.lights.begin(), context.lights.end());
    for (kernel::GeometryRecord& geometry : scene.geometries)
        if (geometry.first_light != kernel::NONE) geometry.first_light += placeless;

    const double radius = double(scene.record.bounds.w);
    std::vector<double> powers;
    for (const auto& light : all) {
        const Spectrum emission = light.record.emission;
        if (!std::isfinite(emission[0]) || !std::isfinite(emission[1]) || !std::isfinite(emission[2]))
            context.diagnostics.error(light.location, "the light's emission is not finite", "smaller numbers");
        // Positions and directions are computed with the current transform; p0 of triangles is in world space already.
        const kernel::vec3 place = light.record.p0 + light.record.p1;
        if (!std::isfinite(place.x + place.y + place.z) ||
            std::abs(place.x) + std::abs(place.y) + std::abs(place.z) > 8.0f * kLargestCoordinate)
            context.diagnostics.error(light.location, "the light has no finite position or direction",
                                      "the transform in force here scales by 0, or numbers are out of range?");
        scene.lights.push_back(light.record);
        const double power = light.power * (light.scales_with_scene ? radius * radius : 1.0);
        powers.push_back(std::isfinite(power) ? power : 0.0);  // not finite: reported above
    }
    scene.record.light_count = uint32_t(all.size());
    scene.record.infinite_lights = infinite;
    scene.record.placeless_lights = placeless;
    if (all.empty()) return;
    choose_lights(scene, powers);
    if (!context.diagnostics.has_errors() && build_light_tree(scene, powers))
        context.ask(kernel::EFFECT_LIGHT_TREE, [&] {
            return fmt::format("{} (the last of {} lights)", context.description.sources->describe(all.back().location),
                               all.size());
        });
}

}  // namespace lampyris
