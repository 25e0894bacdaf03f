#include "core/scene/area_lights.h"

#include "core/scene/lights/common.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <algorithm>
#include <bit>
#include <numbers>

namespace lampyris {

Registry<AreaLightFactory>& area_light_registry() {
    static Registry<AreaLightFactory> registry("area light", "Light from surfaces: `AreaLightSource \"name\"`.");
    return registry;
}
RegisterAreaLight::RegisterAreaLight(const char* name, const char* summary, ParameterSpecs specs,
                                     AreaLightFactory factory) {
    area_light_registry().add({name, summary, std::move(specs)}, factory);
}

AreaLight read_area_light(BuildContext& context, Entity& entity) {
    AreaLight light;
    const AreaLightFactory* factory = area_light_registry().find(entity.type);
    if (!factory) {
        const auto [message, hint] = area_light_registry().unknown(entity.type);
        context.diagnostics.error(entity.type_location, message, hint);
        return light;
    }
    light.asked_by = {&context, &entity, "AreaLightSource"};
    ParameterReader reader(area_light_registry().find_info(entity.type)->parameters, entity, context.diagnostics);
    AreaLightContext area_light{context, entity, reader, light};
    (*factory)(area_light);
    reader.finish("area light");
    light.valid = true;
    return light;
}

namespace {

void build_diffuse(AreaLightContext& context) {
    ParameterReader& reader = context.reader;
    AreaLight& light = context.light;
    light.two_sided = reader.get_bool("twosided");
    const float scale = reader.get_float("scale");
    light.power = reader.get_float("power");
    const std::string filename = reader.get_string("filename");
    if (!filename.empty()) {
        if (reader.has("L")) reader.error("L", "both \"L\" and \"filename\" are given", "one of them");
        light.radiance = Spectrum(scale);
        light.texture = context.build.textures.image_program(filename, glm::vec3(1.0f), reader.location("filename"));
        if (light.texture != kNone)
            light.texture_average =
                context.build.textures.average(context.build.scene.texture_ops[light.texture].image);
        light.power_luminance = float(luminance_of(light.texture_average));
        context.build.ask(kernel::EFFECT_LIGHT_TEXTURES, light.asked_by);
        reader.find("L");
    } else {
        light.radiance = scale * read_spectrum(context.build, reader, "L", SpectrumUse::kLight, Spectrum(1.0f));
    }
    context.build.ask(kernel::EFFECT_AREA_LIGHTS, light.asked_by);
}

ParameterSpecs diffuse_specs() {
    return {
        value("L", ParameterType::kSpectrum, "1 1 1",
              "radiance that leaves the surface; a spectrum other than rgb is scaled to luminance 1"),
        real("scale", 1.0, "multiplies the radiance").at_least(0),
        real("power", 0.0,
             "luminous power of each primitive; 0: given by L and scale; as in pbrt-v4, rgb values of L multiply it")
            .at_least(0),
        boolean("twosided", false, "whether the back emits, too"),
        text("filename", "", "an image over uv instead of L"),
    };
}

const RegisterAreaLight diffuse("diffuse", "Emits the same radiance in all directions.", diffuse_specs(),
                                build_diffuse);

}  // namespace

constexpr double kHalfUlp = 0x1p-24;  // of 1: eps, as MACHINE_EPSILON (core/kernel/math.h)

kernel::LightRecord triangle_light(const glm::vec3& p0, const glm::vec3& p1, const glm::vec3& p2,
                                   uint32_t geometry_flags) {
    const glm::dvec3 a(p0), b(p1), c(p2);
    const glm::dvec3 centroid = (a + b + c) / 3.0;
    const double radius =
        std::max({glm::distance(centroid, a), glm::distance(centroid, b), glm::distance(centroid, c)});
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    const double length = glm::length(cross);
    glm::dvec3 normal = length > 0.0 ? cross / length : glm::dvec3(0.0, 0.0, 1.0);
    const bool smooth = (geometry_flags & kernel::GEOMETRY_HAS_NORMALS) != 0u;
    if (!smooth && (geometry_flags & kernel::GEOMETRY_FLIP) != 0u) normal = -normal;
    kernel::LightRecord light{};
    light.kind = kernel::LIGHT_TRIANGLE;
    light.p0 = p0, light.p1 = p1, light.p2 = p2;
    light.normal = normal;
    light.smooth_normals = smooth ? 1.0f : 0.0f;
    light.area = float(0.5 * length);
    light.inverse_area = 1.0f / light.area;
    light.extent = float(radius);
    // The distance from the triangle, along its normal, at which shadow rays to it end. It is large enough for any point of the
    // triangle (way_out and triangle_plane_error bound a single point): it covers the rounding of the corners' coordinates, and
    // that of the plane as tracers find it from one of them.
    const glm::dvec3 most = glm::max(glm::abs(a), glm::max(glm::abs(b), glm::abs(c))), n = glm::abs(normal);
    const glm::dvec3 e = glm::max(glm::abs(b - a), glm::abs(c - a)), u = glm::abs(b - a), v = glm::abs(c - a);
    const glm::dvec3 products(u.y * v.z + u.z * v.y, u.z * v.x + u.x * v.z, u.x * v.y + u.y * v.x);
    const double plane = length > 0.0 ? std::min(glm::dot(e, products) / length, 16.0 * (e.x + e.y + e.z)) : 0.0;
    light.shadow_end = float((12.0 * glm::dot(n, most) + 6.0 * plane) * kHalfUlp);
    return light;
}

void begin_area_lights(ShapeContext& context, uint32_t geometry, uint32_t primitive_count) {
    // Counted among the lights that are not infinite; build_scene moves it behind the infinite ones.
    context.build.scene.geometries[geometry].first_light = uint32_t(context.build.lights.size());
    if (context.area_light->power > 0.0f && primitive_count > 1)
        context.build.diagnostics.warning(
            context.shape.location, fmt::format("each of the {} primitives emits the whole \"power\"", primitive_count),
            "as in pbrt-v4");
}

void add_area_light(ShapeContext& context, kernel::LightRecord record, uint32_t geometry, uint32_t primitive,
                    float area, float nominal_area) {
    const AreaLight& light = *context.area_light;
    const float sides = light.two_sided ? 2.0f : 1.0f;
    Spectrum radiance = light.radiance;
    // pbrt-v4, lights.cpp, DiffuseAreaLight::Create.
    if (light.power > 0.0f) {
        const float emitted = light.power_luminance * sides * nominal_area * std::numbers::pi_v<float>;
        radiance = emitted > 0.0f ? radiance * (light.power / emitted) : Spectrum(0.0f);
    }
    record.flags = light.two_sided ? kernel::LIGHT_TWO_SIDED : 0u;
    const kernel::GeometryRecord& shape = context.build.scene.geometries[geometry];
    if (shape.alpha_texture == kernel::NONE && shape.alpha == 0.0f) record.flags |= kernel::LIGHT_PASSED;
    record.image = light.texture;
    record.transform = kernel::NONE;
    record.geometry = geometry, record.primitive = primitive;
    record.emission = radiance;
    const glm::dvec3 average =
        glm::dvec3(rgb_of(radiance)) * (light.texture == kNone ? glm::dvec3(1.0) : glm::dvec3(light.texture_average));
    context.build.lights.push_back(
        {record, luminance_of(average) * sides * area * std::numbers::pi, false, context.shape.location});
    if (record.kind == kernel::LIGHT_GEOMETRY) context.build.ask(kernel::EFFECT_QUADRIC_LIGHTS, light.asked_by);
}

}  // namespace lampyris
