// Lights "projection" and "goniometric": an intensity that an image gives for each direction.
#include "core/scene/lights/common.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <cmath>
#include <numbers>

namespace lampyris {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;

// Position, image and transform; false where there is no image.
bool begin_light(LightContext& context, kernel::LightRecord& record, TextureBuilder::Content content) {
    const std::string filename = context.reader.get_string("filename");
    context.ask(kernel::EFFECT_PROJECTION_LIGHTS);
    if (filename.empty()) return false;
    const glm::mat4& m = context.light.world_from_light.matrix[0];
    record.image = context.build.textures.image(filename, content, context.reader.location("filename"));
    record.transform = context.build.add_transform(m, context.light.location);
    record.p0 = transformed_point(m, glm::vec3(0.0f));
    context.ask(kernel::EFFECT_IMAGES);
    return record.image != kNone;
}

void add_light(LightContext& context, kernel::LightRecord& record, Spectrum scale, double emitted) {
    if (const float power = context.reader.get_float("power"); power > 0.0f) {
        scale = emitted > 0.0 ? scale * float(power / emitted) : Spectrum(0.0f);
    }
    record.emission = scale;
    context.build.lights.push_back({record, luminance_of(scale) * emitted, false, context.light.location});
}

void build_projection(LightContext& context) {
    kernel::LightRecord record = blank_light(kernel::LIGHT_PROJECTION);
    const float scale = context.reader.get_float("scale");
    const double half = std::tan(double(context.reader.get_float("fov")) * std::numbers::pi / 360.0);
    if (!begin_light(context, record, TextureBuilder::Content::kProjection)) return;
    const kernel::ImageRecord& image = context.build.scene.images[record.image];
    const uint32_t width = image.width, height = image.height;
    const double aspect = double(width) / height;
    // The field of view is that of the shorter side, as for cameras.
    const double x = half * std::fmax(aspect, 1.0), y = half * std::fmax(1.0 / aspect, 1.0);
    set_projection_window(record, {float(-x), float(-y), float(x), float(y)});
    // Luminous power: the sum of intensity over the solid angles of pixels, each the difference of those of four rectangles that
    // have a corner on the axis.
    const std::vector<glm::vec3> pixels = context.build.textures.pixels(record.image);
    const auto corner = [&](uint32_t i, uint32_t j) {
        const double px = x * (2.0 * i / width - 1.0), py = y * (2.0 * j / height - 1.0);
        return std::atan(px * py / std::sqrt(1.0 + px * px + py * py));
    };
    double emitted = 0.0;
    for (uint32_t j = 0; j < height; ++j)
        for (uint32_t i = 0; i < width; ++i)
            emitted += luminance_of(pixels[size_t(j) * width + i]) *
                       (corner(i + 1, j + 1) - corner(i, j + 1) - corner(i + 1, j) + corner(i, j));
    add_light(context, record, Spectrum(scale), emitted);
}

void build_goniometric(LightContext& context) {
    kernel::LightRecord record = blank_light(kernel::LIGHT_GONIOMETRIC);
    const Spectrum intensity = read_emission(context, "I");
    if (!begin_light(context, record, TextureBuilder::Content::kEnvironment)) {
        // Without an image it is a plain point light, as in pbrt-v4.
        context.ask(kernel::EFFECT_POINT_LIGHTS);
        record = blank_light(kernel::LIGHT_POINT);
        record.p0 = transformed_point(context.light.world_from_light.matrix[0], glm::vec3(0.0f));
        add_light(context, record, intensity, 4.0 * kPi);
        return;
    }
    const kernel::ImageRecord& image = context.build.scene.images[record.image];
    if (image.width != image.height) {
        context.reader.error("filename", fmt::format("the image is {}x{}", image.width, image.height),
                             "goniometric lights take square images in the equal-area octahedral mapping");
        return;
    }
    add_light(context, record, intensity, 4.0 * kPi * luminance_of(context.build.textures.average(record.image)));
}

const RegisterLight projection(
    "projection", "Projects an image from a point, like a slide projector.",
    {text("filename", "", "the picture").needed(), scale_spec(), power_spec(),
     real("fov", 90.0, "field of view across the shorter side").above(0).between(0, 179.9).in("degrees")},
    build_projection);
const RegisterLight goniometric("goniometric", "A point light whose intensity an image gives for each direction.",
                                {emission_spec("I", "intensity, times the image's"), scale_spec(), power_spec(),
                                 text("filename", "", "an equal-area octahedral image; the pole is +y of light space")},
                                build_goniometric);

}  // namespace

}  // namespace lampyris
