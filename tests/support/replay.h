// Replays of small scenes, whose logged events have to add up to the pixel.
#pragma once

#include "core/render/render.h"

#include <glm/common.hpp>
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <utility>

namespace lampyris::test {

// A lamp and a sky, diffuse walls, a glass ball.
inline const std::string kRoom = R"(
LookAt 0 1 4  0 0.8 0  0 1 0
Camera "perspective" "float fov" 45
Film "rgb" "integer xresolution" 24 "integer yresolution" 16 "float maxcomponentvalue" 1000
PixelFilter "gaussian" "float xradius" 1.2 "float yradius" 1.2 "float sigma" 0.5
WorldBegin
LightSource "infinite" "rgb L" [ 0.2 0.3 0.4 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 9 8 7 ]
Shape "trianglemesh" "point3 P" [ -0.5 2 -0.5 0.5 2 -0.5 0.5 2 0.5 -0.5 2 0.5 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd
Material "diffuse" "rgb reflectance" [ 0.7 0.6 0.5 ]
Shape "trianglemesh" "point3 P" [ -3 0 -3 -3 0 3 3 0 3 3 0 -3 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ -3 0 -1.5 3 0 -1.5 3 3 -1.5 -3 3 -1.5 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeBegin
Material "dielectric"
Translate -0.7 0.55 0
Shape "sphere" "float radius" 0.5
AttributeEnd
)";

// The same with a mask, a medium behind an interface, and coats, smooth and rough.
inline const std::string kCrowded = kRoom + R"(
MakeNamedMedium "smoke" "string type" "homogeneous" "rgb sigma_a" [ 0.3 0.6 0.9 ] "rgb sigma_s" [ 0 0 0 ]
AttributeBegin
Material "coateddiffuse" "rgb reflectance" [ 0.6 0.2 0.2 ] "float roughness" 0
Translate 0.3 0.4 -0.6
Shape "sphere" "float radius" 0.4
AttributeEnd
AttributeBegin
Material "coateddiffuse" "rgb reflectance" [ 0.2 0.6 0.2 ] "float roughness" 0.2
Translate 1.2 0.4 -0.6
Shape "sphere" "float radius" 0.4
AttributeEnd
AttributeBegin
Material "interface"
MediumInterface "smoke" ""
Translate 0.5 0.6 0.8
Shape "sphere" "float radius" 0.4
AttributeEnd
AttributeBegin
Material "diffuse" "rgb reflectance" [ 0.3 0.3 0.8 ]
Shape "trianglemesh" "point3 P" [ -1.5 0.2 1 -0.2 0.2 1 -0.2 1.5 1 -1.5 1.5 1 ] "integer indices" [ 0 1 2 0 2 3 ] "float alpha" 0.5
AttributeEnd
)";

inline RenderOutcome replay(const std::string& scene, const std::string& integrator, std::shared_ptr<Device> device,
                            std::array<int, 3> pixel) {
    RenderRequest request;
    request.scene = SceneSource::of_text(scene);
    request.integrator = integrator;
    if (integrator.starts_with("ppm")) request.samples_per_pixel = 3;
    request.device = std::move(device);
    request.replay = pixel;
    request.seed = 7;
    return render(request);
}

inline void expect_events_to_add_up(const RenderOutcome& outcome) {
    const kernel::FilmPixel& pixel = outcome.pixels[0];
    EXPECT_EQ(pixel.left_out, 0u);
    EXPECT_EQ(outcome.paths.missing, 0u);
    EXPECT_FALSE(outcome.paths.events.empty());
    glm::dvec3 sum(0.0), size(0.0);
    for (const PathEvent& event : outcome.paths.events) {
        sum += event.added();
        size += glm::abs(event.added());
        if (!event.unweighted) continue;
        EXPECT_GE(event.record.weight, 0.0f);
        EXPECT_LE(event.record.weight, 1.0f);
    }
    // Rounding of the kernels' sums, and of the quanta of splats.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], double(pixel.sum[c]), 2e-5 * size[c] + 2e-6) << c;
}

}  // namespace lampyris::test
