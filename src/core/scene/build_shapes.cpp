#include "core/scene/build_shapes.h"

#include "core/scene/area_lights.h"
#include "core/scene/quadric_box.h"
#include "core/scene/touching.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace lampyris {

uint32_t ShapeContext::add_geometry(uint32_t kind, uint32_t flags, uint32_t primitive_count) {
    kernel::GeometryRecord record{};
    if (shape.reverse_orientation) flags |= kernel::GEOMETRY_REVERSED;
    if (shape.reverse_orientation != swaps_handedness(shape.world_from_object.matrix[0]))
        flags |= kernel::GEOMETRY_FLIP;
    record.kind = kind;
    record.flags = flags;
    record.material = material;
    record.first_light = record.alpha_texture = record.transform = kernel::NONE;
    record.first_normal = record.first_uv = kernel::NONE;
    record.primitive_count = primitive_count;
    record.media = build.medium(shape.interior_medium) << 16 | build.medium(shape.exterior_medium);
    FloatSlot alpha = read_float(build, reader, "alpha");
    // A constant texture is treated as a plain number, because add_area_light decides LIGHT_PASSED by it, as pbrt-v4's lights
    // do.
    if (alpha.texture != kNone) {
        const kernel::TextureOp& op = build.scene.texture_ops[alpha.texture];
        if (op.operation == kernel::TEXTURE_CONSTANT && (op.flags & 1u) != 0u)
            alpha = {std::clamp(op.a.x, 0.0f, 1.0f), kNone, true};
    }
    record.alpha_texture = alpha.texture;
    record.alpha = alpha.value;
    if (alpha.texture != kNone || alpha.value < 1.0f) build.ask(kernel::EFFECT_ALPHA, asked_by);
    build.scene.geometries.push_back(record);
    return uint32_t(build.scene.geometries.size() - 1);
}

namespace {

struct Box {
    glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
    void add(glm::dvec3 p) { low = glm::min(low, p), high = glm::max(high, p); }
    bool empty() const { return low.x > high.x; }
    bool too_far() const {
        const glm::dvec3 most = glm::max(glm::abs(low), glm::abs(high));
        return !(std::max({most.x, most.y, most.z}) <= double(kLargestCoordinate));
    }
    // The corners of this box, transformed, into another.
    void add_to(Box& box, const kernel::TransformRecord& t) const {
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec4 p(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z,
                               1.0);
            box.add({glm::dot(glm::dvec4(t.to0), p), glm::dot(glm::dvec4(t.to1), p), glm::dot(glm::dvec4(t.to2), p)});
        }
    }
};

Box set_bounds(const Scene& scene, const GeometrySet& set) {
    Box box;
    for (uint32_t i = set.first_geometry; i < set.first_geometry + set.geometry_count; ++i) {
        const kernel::GeometryRecord& g = scene.geometries[i];
        if (g.kind <= kernel::GEOMETRY_BILINEAR) {
            const uint32_t corners = g.kind == kernel::GEOMETRY_TRIANGLES ? 3 : 4;
            for (uint32_t k = 0; k < g.primitive_count * corners; ++k) {
                const size_t v = size_t(g.first_vertex) + scene.indices[g.first_index + k];
                box.add({scene.positions[3 * v], scene.positions[3 * v + 1], scene.positions[3 * v + 2]});
            }
        } else {
            for (const glm::dvec3& p : quadric_corners(scene, g)) box.add(p);
        }
    }
    return box;
}

// Limit for rays in an instance's space: Embree ignores whatever lies farther out than 1.8e18.
constexpr float kLargestRay = 0.5e18f;
// A scene whose bounding sphere is this small is a single point, which no ray hits.
constexpr float kNoRadius = 1e-30f;

void refuse_distance(Diagnostics& diagnostics, Location where, const char* what) {
    diagnostics.error(where, fmt::format("the {} reaches farther out than rays are traced", what),
                      fmt::format("coordinates in the world are at most {:g}", kLargestCoordinate));
}

}  // namespace

namespace {

class ShapeBuilder {
 public:
    explicit ShapeBuilder(BuildContext& context)
        : context_(context), area_lights_(context.description.area_lights.size()) {}

    GeometrySet build(std::vector<ShapeDescription>& shapes, bool in_object) {
        GeometrySet set{uint32_t(context_.scene.geometries.size()), 0};
        for (ShapeDescription& shape : shapes) {
            build(shape, in_object);
            shape.parameters.parameters.clear();
            shape.parameters.parameters.shrink_to_fit();
        }
        set.geometry_count = uint32_t(context_.scene.geometries.size()) - set.first_geometry;
        return set;
    }

    // Where the shape of each of Scene::geometries stands.
    const std::vector<Location>& places() const { return places_; }

 private:
    void build(ShapeDescription& shape, bool in_object) {
        const ShapeFactory* factory = shape_registry().find(shape.type);
        if (!factory) {
            refuse(shape);
            return;
        }
        if (shape.world_from_object.animated()) context_.refuse_motion(shape.world_from_object, shape.location);
        const glm::mat4& matrix = shape.world_from_object.matrix[0];
        if (!invertible(matrix)) {
            context_.diagnostics.error(shape.location, "the transform in force here cannot be inverted",
                                       "a scale by 0, or numbers out of range?");
            return;
        }
        ParameterReader reader(shape_registry().find_info(shape.type)->parameters, shape, context_.diagnostics);
        ShapeContext context{context_,
                             shape,
                             reader,
                             context_.material(shape.material),
                             area_light(shape, in_object),
                             in_object,
                             {&context_, &shape, "Shape"}};
        const GeometrySet before{uint32_t(context_.scene.geometries.size()), 0};
        (*factory)(context);
        places_.resize(context_.scene.geometries.size(), shape.location);
        const Box box = set_bounds(context_.scene, {before.first_geometry, uint32_t(context_.scene.geometries.size()) -
                                                                               before.first_geometry});
        if (!box.empty() && box.too_far()) refuse_distance(context_.diagnostics, shape.location, "shape");
        reader.finish("shape");
    }

    void refuse(const ShapeDescription& shape) {
        if (shape.type == "curve" || shape.type == "heightfield") {
            context_.diagnostics.unsupported(shape.type_location, fmt::format("shape \"{}\"", shape.type),
                                             "it is left out if skipped");
            return;
        }
        const auto [message, hint] = shape_registry().unknown(shape.type);
        context_.diagnostics.error(shape.type_location, message, hint);
    }

    const AreaLight* area_light(const ShapeDescription& shape, bool in_object) {
        if (shape.area_light == kNone) return nullptr;
        std::optional<AreaLight>& light = area_lights_[shape.area_light];
        if (!light) light = read_area_light(context_, context_.description.area_lights[shape.area_light]);
        const auto ignore = [&](const char* why) {
            context_.diagnostics.warning(shape.location, fmt::format("the area light is ignored: {}", why),
                                         "as in pbrt-v4");
            return nullptr;
        };
        if (in_object) return ignore("the shape is a part of an instanced object");
        if (context_.scene.materials[context_.material(shape.material)].kind == kernel::MATERIAL_INTERFACE)
            return ignore("the shape's material is \"interface\"");
        return light->valid ? &*light : nullptr;
    }

    BuildContext& context_;
    std::vector<std::optional<AreaLight>> area_lights_;  // read when a shape first needs one
    std::vector<Location> places_;
};

}  // namespace

namespace {

void note_unused(BuildContext& context, const std::vector<uint32_t>& set_of_object) {
    constexpr size_t kMostNamed = 10;
    size_t unused = 0;
    std::vector<std::string>& notes = context.scene.notes;
    for (size_t i = 0; i < set_of_object.size(); ++i)
        if (set_of_object[i] == kNone && ++unused <= kMostNamed)
            notes.push_back(fmt::format("object \"{}\" is never instanced", context.description.objects[i].name));
    if (unused > kMostNamed) notes.push_back(fmt::format("{} more objects are never instanced", unused - kMostNamed));
}

}  // namespace

void build_shapes(BuildContext& context) {
    SceneDescription& description = context.description;
    Scene& scene = context.scene;
    ShapeBuilder builder(context);
    scene.sets.push_back(builder.build(description.shapes, false));
    kernel::InstanceRecord world{};
    world.transform = transform_record(glm::mat4(1.0f));
    world.geometry_count = scene.sets[0].geometry_count;
    world.root_node = kernel::NONE;
    scene.instances.push_back(world);
    scene.instance_sets.push_back(0);

    std::vector<uint32_t> set_of_object(description.objects.size(), kNone);
    std::vector<Box> object_boxes(description.objects.size());
    std::vector<Location> places{Location{}};  // of Scene::instances
    for (const InstanceDescription& instance : description.instances) {
        if (instance.object >= description.objects.size()) continue;
        ObjectDescription& object = description.objects[instance.object];
        if (set_of_object[instance.object] == kNone) {
            set_of_object[instance.object] = uint32_t(scene.sets.size());
            scene.sets.push_back(builder.build(object.shapes, true));
            object_boxes[instance.object] = set_bounds(scene, scene.sets.back());
        }
        const uint32_t index = set_of_object[instance.object];
        const GeometrySet& set = scene.sets[index];
        if (instance.world_from_object.animated()) context.refuse_motion(instance.world_from_object, instance.location);
        const glm::mat4& matrix = instance.world_from_object.matrix[0];
        if (!invertible(matrix)) {
            context.diagnostics.error(instance.location, "the transform in force here cannot be inverted",
                                      "a scale by 0, or numbers out of range?");
            continue;
        }
        if (set.geometry_count == 0) continue;
        kernel::InstanceRecord record{};
        record.transform = transform_record(matrix);
        record.first_geometry = set.first_geometry;
        record.geometry_count = set.geometry_count;
        record.root_node = kernel::NONE;
        record.swaps_handedness = swaps_handedness(matrix) ? 1u : 0u;
        Box box;
        object_boxes[instance.object].add_to(box, record.transform);
        if (box.too_far()) refuse_distance(context.diagnostics, instance.location, "instance");
        scene.instances.push_back(record);
        scene.instance_sets.push_back(index);
        places.push_back(instance.location);
        context.ask(kernel::EFFECT_INSTANCES, [&] {
            return fmt::format("{} (ObjectInstance \"{}\")", description.sources->describe(instance.location),
                               object.name);
        });
    }
    scene.record.bounds = bounding_sphere(scene);
    if (scene.record.bounds.w > kNoRadius && scene.record.bounds.w < kSmallestScene)
        context.diagnostics.error(
            description.shapes.empty() ? description.instances.front().location : description.shapes.front().location,
            "the scene is too small for rays to be traced",
            fmt::format("the radius of its bounding sphere is at least {:g}", kSmallestScene));
    // Rays from anywhere in the scene, and from the camera, must be in range within each instance.
    const kernel::CameraRecord& camera = scene.record.camera;
    const glm::vec3 centre(scene.record.bounds), eye(camera.to0.w, camera.to1.w, camera.to2.w);
    const float reach = std::max(glm::length(centre) + scene.record.bounds.w, glm::length(eye));
    for (size_t i = 1; i < scene.instances.size(); ++i) {
        const kernel::TransformRecord& t = scene.instances[i].transform;
        for (const kernel::vec4& row : {t.from0, t.from1, t.from2}) {
            if (glm::length(glm::vec3(row)) * std::max(reach, 1.0f) + std::abs(row.w) <= kLargestRay) continue;
            context.diagnostics.error(places[i], "the instance is too small beside the scene for rays to be traced",
                                      "a larger scale");
            break;
        }
    }
    note_unused(context, set_of_object);
    separate_touching_surfaces(context, builder.places());
}

kernel::vec4 bounding_sphere(const Scene& scene) {
    Box world;
    std::vector<Box> boxes;
    for (const GeometrySet& set : scene.sets) boxes.push_back(set_bounds(scene, set));
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Box& box = boxes[scene.instance_sets[i]];
        if (!box.empty()) box.add_to(world, scene.instances[i].transform);
    }
    if (world.empty()) return {0.0f, 0.0f, 0.0f, 1.0f};
    const glm::dvec3 centre = 0.5 * (world.low + world.high);
    return {glm::vec3(centre), float(std::max(glm::length(world.high - centre), double(kNoRadius)))};
}

}  // namespace lampyris
