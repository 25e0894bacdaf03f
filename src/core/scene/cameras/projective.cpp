// Cameras "perspective" and "orthographic", both with a thin lens.
#include "core/scene/builder.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lampyris {

namespace {

// The rectangle of the plane z = 1 that the picture shows, as xmin, xmax, ymin, ymax, before the field of view is applied. The
// shorter side is [-1, 1] (pbrt-v4, cameras.cpp).
std::array<float, 4> screen_window(CameraContext& camera) {
    const float aspect = camera.reader.has("frameaspectratio") ? camera.reader.get_float("frameaspectratio")
                                                               : camera.resolution.x / camera.resolution.y;
    std::array<float, 4> window = aspect > 1.0f ? std::array{-aspect, aspect, -1.0f, 1.0f}
                                                : std::array{-1.0f, 1.0f, -1.0f / aspect, 1.0f / aspect};
    if (const Parameter* given = camera.reader.find("screenwindow")) {
        const auto* numbers = std::get_if<std::vector<float>>(&given->values);
        if (given->type != ParameterType::kFloat) {
            camera.reader.error("screenwindow",
                                fmt::format("\"screenwindow\" is of type {}, not float", type_name(given->type)));
        } else if (numbers && numbers->size() != 4) {
            camera.reader.warning(
                "screenwindow",
                fmt::format("\"screenwindow\" has {} numbers, not 4: its default is used, as in pbrt-v4",
                            numbers->size()),
                "xmin xmax ymin ymax");
        } else if (!numbers || (*numbers)[0] == (*numbers)[1] || (*numbers)[2] == (*numbers)[3] ||
                   !std::all_of(numbers->begin(), numbers->end(), [](float x) { return std::isfinite(x); })) {
            camera.reader.error("screenwindow", "\"screenwindow\" must be four numbers",
                                "xmin xmax ymin ymax, not equal");
        } else {
            for (size_t i = 0; i < 4; ++i) window[i] = (*numbers)[i];
        }
    }
    return window;
}

void build_projection(CameraContext& camera, uint32_t kind, float scale) {
    const std::array<float, 4> window = screen_window(camera);
    kernel::CameraRecord& record = camera.record;
    record.kind = kind;
    record.screen = {scale * window[0], scale * window[3], scale * (window[1] - window[0]) / camera.resolution.x,
                     scale * (window[2] - window[3]) / camera.resolution.y};
    record.lens_radius = camera.reader.get_float("lensradius");
    record.focal_distance = camera.reader.get_float("focaldistance");
    if (record.lens_radius > 0.0f) camera.build.ask(kernel::EFFECT_DEPTH_OF_FIELD, camera.asked_by);
    const float open = camera.reader.get_float("shutteropen"), close = camera.reader.get_float("shutterclose");
    if (open > close)
        camera.reader.warning("shutterclose", "the shutter closes before it opens: the two are swapped, as in pbrt-v4");
    if (open == close) camera.reader.error("shutterclose", "the shutter closes when it opens");
}

void build_perspective(CameraContext& camera) {
    const float fov = camera.reader.get_float("fov");
    build_projection(camera, kernel::CAMERA_PERSPECTIVE, float(std::tan(double(fov) * std::numbers::pi / 360.0)));
}

void build_orthographic(CameraContext& camera) { build_projection(camera, kernel::CAMERA_ORTHOGRAPHIC, 1.0f); }

ParameterSpecs common_specs() {
    return {
        real("frameaspectratio", 1.0, "width by height of the screen; default: that of the resolution").above(0),
        values("screenwindow", ParameterType::kFloat, "the shorter side is -1 1",
               "part of the plane z = 1 that is shown: xmin xmax ymin ymax"),
        real("lensradius", 0.0, "of the lens; 0: a pinhole").at_least(0).in("scene units"),
        real("focaldistance", 1e6, "distance of the plane that is sharp").above(0).in("scene units"),
        real("shutteropen", 0.0, "when the shutter opens").in("s"),
        real("shutterclose", 1.0, "when it closes; exposure is proportional to the difference").in("s"),
    };
}

ParameterSpecs perspective_specs() {
    ParameterSpecs specs = common_specs();
    specs.insert(specs.begin(),
                 real("fov", 90.0, "field of view across the shorter side").above(0).between(0, 179.9).in("degrees"));
    return specs;
}

const RegisterCamera perspective("perspective", "Central projection, with a thin lens if lensradius is above 0.",
                                 perspective_specs(), build_perspective);
const RegisterCamera orthographic("orthographic", "Parallel projection, with a thin lens if lensradius is above 0.",
                                  common_specs(), build_orthographic);

}  // namespace

}  // namespace lampyris
