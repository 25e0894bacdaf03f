// Shapes "sphere", "disk" and "cylinder": intersected exactly, in their own space.
#include "core/scene/area_lights.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lampyris {

namespace {

// The factor by which a transform stretches lengths, on average; exact for uniform scales. Only used for choosing lights.
float mean_stretch(const glm::mat4& m) {
    return float(std::cbrt(std::abs(glm::determinant(glm::dmat3(glm::mat3(m))))));
}

void add_quadric(ShapeContext& context, uint32_t kind, const kernel::Quadric& quadric, float area) {
    const glm::mat4& matrix = context.shape.world_from_object.matrix[0];
    context.build.ask(kernel::EFFECT_QUADRICS, context.asked_by);
    const uint32_t index = context.add_geometry(kind, 0u, 1u);
    kernel::GeometryRecord& geometry = context.build.scene.geometries[index];
    geometry.quadric = quadric;
    geometry.transform = context.build.add_transform(matrix, context.shape.location);
    if (!context.area_light) return;
    begin_area_lights(context, index, 1u);
    kernel::LightRecord light{};
    light.kind = kernel::LIGHT_GEOMETRY;
    const float stretch = mean_stretch(matrix);
    add_area_light(context, light, index, 0u, area * stretch * stretch, area);
}

// A sphere or a cylinder.
kernel::Quadric swept(float radius, float low, float high, float phi) {
    kernel::Quadric q{};
    q.radius = radius, q.z_min = low, q.z_max = high, q.phi_max = phi;
    return q;
}

float read_phi(ShapeContext& context) {
    return context.reader.get_float("phimax") * std::numbers::pi_v<float> / 180.0f;
}

// Sorts zmin and zmax; reports an error if they are equal.
bool read_heights(ShapeContext& context, float& low, float& high) {
    if (low > high) std::swap(low, high);
    if (low < high) return true;
    context.reader.error("zmin", "\"zmin\" and \"zmax\" leave nothing of the shape", "different heights");
    return false;
}

void build_sphere(ShapeContext& context) {
    ParameterReader& reader = context.reader;
    const float radius = reader.get_float("radius"), phi = read_phi(context);
    float low = reader.has("zmin") ? reader.get_float("zmin") : -radius;
    float high = reader.has("zmax") ? reader.get_float("zmax") : radius;
    if (!read_heights(context, low, high)) return;
    low = std::clamp(low, -radius, radius), high = std::clamp(high, -radius, radius);
    if (!(low < high)) {
        reader.error("zmin", "\"zmin\" and \"zmax\" leave nothing of the sphere", "heights between -radius and radius");
        return;
    }
    add_quadric(context, kernel::GEOMETRY_SPHERE, swept(radius, low, high, phi), phi * radius * (high - low));
}

void build_disk(ShapeContext& context) {
    ParameterReader& reader = context.reader;
    const float radius = reader.get_float("radius"), inner = reader.get_float("innerradius"), phi = read_phi(context);
    if (!(inner < radius)) {
        reader.error("innerradius", "\"innerradius\" leaves nothing of the disk", "less than \"radius\"");
        return;
    }
    kernel::Quadric disk{};
    disk.height = reader.get_float("height"), disk.radius = radius, disk.inner_radius = inner, disk.phi_max = phi;
    add_quadric(context, kernel::GEOMETRY_DISK, disk, 0.5f * phi * (radius * radius - inner * inner));
}

void build_cylinder(ShapeContext& context) {
    ParameterReader& reader = context.reader;
    const float radius = reader.get_float("radius"), phi = read_phi(context);
    float low = reader.get_float("zmin"), high = reader.get_float("zmax");
    if (!read_heights(context, low, high)) return;
    add_quadric(context, kernel::GEOMETRY_CYLINDER, swept(radius, low, high, phi), phi * radius * (high - low));
}

ParameterSpec radius_spec() { return real("radius", 1.0, "radius").above(0).in("scene units"); }
ParameterSpec phi_spec() {
    return real("phimax", 360.0, "how far the shape goes round the z axis").above(0).between(0, 360).in("degrees");
}

const RegisterShape sphere("sphere", "A sphere around the origin, or a part of it.",
                           {radius_spec(), real("zmin", -1.0, "lowest z; default: -radius").in("scene units"),
                            real("zmax", 1.0, "highest z; default: radius").in("scene units"), phi_spec()},
                           build_sphere);
const RegisterShape disk("disk", "A disk or ring around the z axis, facing +z.",
                         {radius_spec(), real("height", 0.0, "its z").in("scene units"),
                          real("innerradius", 0.0, "of the hole").at_least(0).in("scene units"), phi_spec()},
                         build_disk);
const RegisterShape cylinder("cylinder", "The mantle of a cylinder around the z axis.",
                             {radius_spec(), real("zmin", -1.0, "one end").in("scene units"),
                              real("zmax", 1.0, "the other end").in("scene units"), phi_spec()},
                             build_cylinder);

}  // namespace

}  // namespace lampyris
