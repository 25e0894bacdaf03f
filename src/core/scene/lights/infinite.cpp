// Light "infinite": the sky, constant or an image.
#include "core/scene/lights/common.h"

#include "core/scene/light_distribution.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace lampyris {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;

// The z of the direction at a point of the equal-area octahedral square (Clarberg 2008, "Fast equal-area mapping of the
// (hemi)sphere using SIMD").
float octahedral_z(float s, float t) {
    const float u = std::abs(2.0f * s - 1.0f), v = std::abs(2.0f * t - 1.0f);
    const float distance = 1.0f - (u + v), r = 1.0f - std::abs(distance);
    return std::copysign(1.0f - r * r, distance);
}

// The integral of the cosine over the part of a texel, of n x n, in the upper half of the sphere; the whole sphere is 4 pi. The
// horizon goes through texels, so that small maps need many points in each.
double falling_share(uint32_t x, uint32_t y, uint32_t n) {
    constexpr uint32_t kPoints = 1024;  // along a side of the map: the error of a constant sky is 2e-6
    const uint32_t points = (kPoints + n - 1) / n;
    double sum = 0.0;
    for (uint32_t j = 0; j < points; ++j)
        for (uint32_t i = 0; i < points; ++i)
            sum += std::max(0.0f, octahedral_z((float(x) + (float(i) + 0.5f) / float(points)) / float(n),
                                               (float(y) + (float(j) + 0.5f) / float(points)) / float(n)));
    return sum * 4.0 * std::numbers::pi / (double(points) * points * n * n);
}

void build_constant(LightContext& context, float scale) {
    kernel::LightRecord record = blank_light(kernel::LIGHT_INFINITE);
    Spectrum radiance = scale * read_spectrum(context.build, context.reader, "L", SpectrumUse::kLight, Spectrum(1.0f));
    if (const float illuminance = context.reader.get_float("illuminance"); illuminance > 0.0f)
        radiance *= illuminance / kPi;
    record.emission = radiance;
    context.ask(kernel::EFFECT_ENVIRONMENT);
    context.build.infinite_lights.push_back(
        {record, luminance_of(radiance) * 4.0 * std::numbers::pi * std::numbers::pi, true, context.light.location});
}

void build_image(LightContext& context, const std::string& filename, float scale) {
    BuildContext& build = context.build;
    kernel::LightRecord record = blank_light(kernel::LIGHT_INFINITE_IMAGE);
    const Location where = context.reader.location("filename");
    record.image = build.textures.image(filename, TextureBuilder::Content::kEnvironment, where);
    if (record.image == kNone) return;
    const kernel::ImageRecord& image = build.scene.images[record.image];
    const uint32_t width = image.width, height = image.height;
    if (width != height) {
        context.reader.error("filename", fmt::format("the image is {}x{}", width, height),
                             "infinite lights take square images in the equal-area octahedral mapping, as pbrt-v4 does "
                             "(imgtool makeequiarea converts)");
        return;
    }
    std::vector<float> weights;
    const float illuminance = context.reader.get_float("illuminance");
    double average = 0.0, falling = 0.0;  // luminance over the sphere; over its upper half, by the cosine
    const std::vector<glm::vec3> pixels = build.textures.pixels(record.image);
    weights.reserve(pixels.size());
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            const double luminance = luminance_of(pixels[size_t(y) * width + x]);
            // A weight for choosing the light: it must be positive unless the light is black.
            using Limits = std::numeric_limits<float>;
            weights.push_back(
                luminance > 0.0 ? float(std::clamp(luminance, double(Limits::min()), double(Limits::max()))) : 0.0f);
            average += luminance;
            if (illuminance > 0.0f && luminance > 0.0) falling += luminance * falling_share(x, y, width);
        }
    average /= double(pixels.size());
    // As pbrt-v4 (lights.cpp, Light::Create), which looks at the middle of each texel alone.
    if (illuminance > 0.0f) scale = falling > 0.0 ? float(double(scale) * illuminance / falling) : 0.0f;
    record.transform = build.add_transform(context.light.world_from_light.matrix[0], context.light.location);
    record.distribution = append_sky_distributions(weights, width, height, build.scene.distributions);
    record.emission = Spectrum(scale);
    context.ask(kernel::EFFECT_ENVIRONMENT);
    context.ask(kernel::EFFECT_ENVIRONMENT_IMAGE);
    context.ask(kernel::EFFECT_IMAGES);
    build.infinite_lights.push_back(
        {record, average * double(scale) * 4.0 * std::numbers::pi * std::numbers::pi, true, context.light.location});
}

void build(LightContext& context) {
    ParameterReader& reader = context.reader;
    const float scale = reader.get_float("scale");
    const std::string filename = reader.get_string("filename");
    if (reader.find("portal"))
        context.build.diagnostics.unsupported(reader.location("portal"), "portals of infinite lights",
                                              "--skip-unsupported samples all of the sky");
    if (filename.empty()) {
        build_constant(context, scale);
        return;
    }
    if (reader.find("L")) reader.error("L", "both \"L\" and \"filename\" are given", "one of them");
    build_image(context, filename, scale);
}

const RegisterLight infinite(
    "infinite", "Light from all around: constant, or an equal-area octahedral image.",
    {emission_spec("L", "radiance"), scale_spec(),
     real("illuminance", 0.0, "on a surface that faces +z of light space; 0: given by the other parameters")
         .at_least(0),
     text("filename", "", "an image of the sky instead of L; the pole is +z of light space"),
     values("portal", ParameterType::kPoint3, "none", "the window through which light comes (not supported)")},
    build);

}  // namespace

}  // namespace lampyris
