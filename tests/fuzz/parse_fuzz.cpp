// Any text is either a scene or an InputError: never a crash, a hang, or a description whose indices are out of range.
#include "core/scene/description.h"

#include <cassert>

using namespace lampyris;

namespace {

void ask_for_everything(ParameterList& list, Diagnostics& diagnostics) {
    for (const std::string name : {"radius", "P", "indices", "filename", "reflectance", "type", "fov"}) {
        list.get_float(name, 1.0f, diagnostics);
        list.get_int(name, 1, diagnostics);
        list.get_bool(name, true, diagnostics);
        list.get_choice(name, "a", {"a", "b"}, diagnostics);
        list.get_floats(name, ParameterType::kRgb, 3, diagnostics);
        list.take_floats(name, ParameterType::kPoint3, diagnostics);
        list.take_ints(name, diagnostics);
    }
    list.report_unused("the fuzzer", {"radius", "filename"}, diagnostics);
}

void check(const SceneDescription& scene, const ShapeDescription& shape) {
    assert(shape.material == kNone || shape.material < scene.materials.size());
    assert(shape.area_light == kNone || shape.area_light < scene.area_lights.size());
    assert(shape.interior_medium == kNone || shape.interior_medium < scene.media.size());
    assert(shape.exterior_medium == kNone || shape.exterior_medium < scene.media.size());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    auto sources = std::make_shared<Sources>();
    Diagnostics diagnostics(*sources);
    diagnostics.set_skip_unsupported(size % 2 == 0);
    SceneDescription scene = parse_scene_text("fuzz.pbrt", std::string(reinterpret_cast<const char*>(data), size),
                                              std::string("/nonexistent"), sources, diagnostics);
    for (const ShapeDescription& shape : scene.shapes) check(scene, shape);
    for (const ObjectDescription& object : scene.objects)
        for (const ShapeDescription& shape : object.shapes) check(scene, shape);
    for (const InstanceDescription& instance : scene.instances)
        assert(instance.object == kNone ? diagnostics.has_errors() : instance.object < scene.objects.size());
    for (ShapeDescription& shape : scene.shapes) ask_for_everything(shape.parameters, diagnostics);
    for (MaterialDescription& material : scene.materials) ask_for_everything(material.parameters, diagnostics);
    ask_for_everything(scene.camera.parameters, diagnostics);
    try {
        diagnostics.throw_if_errors();
    } catch (const InputError&) {}
    return 0;
}
