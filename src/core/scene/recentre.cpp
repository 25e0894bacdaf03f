#include "core/scene/recentre.h"

#include "core/scene/builder.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lampyris {

namespace {

// A scene is moved if its distance from the origin exceeds its size by this factor: a float has then lost 6 of its 24 bits.
constexpr double kFar = 64.0;

struct Box {
    glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
    void add(const glm::dvec3& a, const glm::dvec3& b) { low = glm::min(low, a), high = glm::max(high, b); }
    bool empty() const { return !(low.x <= high.x); }
    glm::dvec3 centre() const { return 0.5 * (low + high); }
    glm::dvec3 half() const { return 0.5 * (high - low); }
    void add(const Box& box, const AnimatedTransform& transform, const glm::dvec3& place) {
        const glm::dmat3 m(glm::mat3(transform.matrix[0]));
        const glm::dmat3 stretch(glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2]));
        const glm::dvec3 at = place + m * box.centre(), reach = stretch * box.half();
        add(at - reach, at + reach);
    }
};

// The shape's box in its own space. The size of a mesh in a file is not known yet and taken as 1. If that is wrong, the
// coordinates in the file are as large as the distance, and nothing is gained or lost.
Box own_box(const ShapeDescription& shape) {
    Box box;
    double reach = 1.0;
    bool sized = false;
    for (const Parameter& parameter : shape.parameters.parameters) {
        const auto* values = std::get_if<std::vector<float>>(&parameter.values);
        if (!values) continue;
        if (parameter.name == "P") {
            for (size_t i = 0; i + 2 < values->size(); i += 3) {
                const glm::dvec3 p((*values)[i], (*values)[i + 1], (*values)[i + 2]);
                box.add(p, p);
            }
        } else if (values->size() == 1 && (parameter.name == "radius" || parameter.name == "height" ||
                                           parameter.name == "zmin" || parameter.name == "zmax")) {
            reach = std::max(sized ? reach : 0.0, std::abs(double(values->front())));
            sized = true;
        }
    }
    if (box.empty()) box.add(glm::dvec3(-reach), glm::dvec3(reach));
    return box;
}

void move(AnimatedTransform& transform, const glm::dvec3& place, const glm::dvec3& origin) {
    const bool moves = transform.animated();
    transform.matrix[0][3] = glm::vec4(glm::vec3(place - origin), transform.matrix[0][3].w);
    if (moves)
        transform.matrix[1][3] -= glm::vec4(glm::vec3(origin), 0.0f);
    else
        transform.matrix[1] = transform.matrix[0];
}

glm::dvec3 origin_of(const SceneDescription& description, const Places& places) {
    Box box;
    for (size_t i = 0; i < description.shapes.size(); ++i)
        box.add(own_box(description.shapes[i]), description.shapes[i].world_from_object, places.shapes[i]);
    std::vector<Box> objects(description.objects.size());
    for (size_t i = 0; i < objects.size(); ++i)
        for (const ShapeDescription& shape : description.objects[i].shapes)
            objects[i].add(own_box(shape), shape.world_from_object, glm::dvec3(shape.world_from_object.matrix[0][3]));
    for (size_t i = 0; i < description.instances.size(); ++i) {
        const InstanceDescription& instance = description.instances[i];
        if (instance.object < objects.size() && !objects[instance.object].empty())
            box.add(objects[instance.object], instance.world_from_object, places.instances[i]);
    }
    if (box.empty()) return glm::dvec3(0.0);
    const glm::dvec3 centre = box.centre();
    const double size = glm::length(box.half()), distance = glm::length(centre);
    if (!(size > 0.0) || !(distance > kFar * size) || !(distance <= double(kLargestCoordinate))) return glm::dvec3(0.0);
    // The origin is a multiple of a power of two near the size, so that round numbers stay round.
    const double step = std::exp2(std::ceil(std::log2(size)));
    return glm::round(centre / step) * step;
}

}  // namespace

glm::dvec3 recentre(SceneDescription& description, const Places& places) {
    const glm::dvec3 origin = origin_of(description, places);
    if (origin == glm::dvec3(0.0)) return origin;
    move(description.camera.world_from_camera, places.camera, origin);
    for (size_t i = 0; i < places.shapes.size(); ++i)
        move(description.shapes[i].world_from_object, places.shapes[i], origin);
    for (size_t i = 0; i < places.instances.size(); ++i)
        move(description.instances[i].world_from_object, places.instances[i], origin);
    for (size_t i = 0; i < places.lights.size(); ++i)
        move(description.lights[i].world_from_light, places.lights[i], origin);
    for (size_t i = 0; i < places.textures.size(); ++i)
        move(description.textures[i].world_from_texture, places.textures[i], origin);
    return origin;
}

}  // namespace lampyris
