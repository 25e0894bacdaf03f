// A floor of tiles, each with a random choice that photons and eye paths both encounter, and the share of light that it leaves.
#pragma once

#include "support/one_of_each.h"
#include "support/runs.h"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

namespace lampyris::test {

// Standard errors of a tile come from the spread over 18 pairs of its pixels, whose discs of photons hardly overlap. With 17
// degrees of freedom, 7.4 of them are exceeded with a probability below 1e-6.
inline constexpr double kTileThreshold = 7.4;
inline constexpr int kTiles = 4, kTilePixels = 8;  // tiles a row, pixels a tile and row
inline constexpr double kTileSize = 0.2, kShown = 0.8;

inline constexpr const char* kRampedAlpha = "\"texture alpha\" \"ramp\"";

// A tile of the floor, and its radiance as a share of a matte floor's. `material` is the name of one of the materials below.
struct Tile {
    const char* material;
    double share;
    const char* alpha = "";
    bool instance = false;
    bool floor_below = false;  // another matte floor, which rays reach through the mask
};

// Everything that is not matte is a pane of glass, and black behind that. "ramp" is a texture that rises from 0 to 1 across the
// tile.
inline const std::vector<Tile> kFloor = {
    {"matte", 1.0},
    {"none", 1.0},
    {"quarter", 0.75},
    {"half", 0.5},
    {"all", 0.0},
    {"half-of-half", 0.25},
    {"pane-or-half", 0.25},
    {"ramped", 0.5},
    {"matte", 0.25, "\"float alpha\" 0.25"},
    {"matte", 0.5, "\"float alpha\" 0.5"},
    {"matte", 0.5, kRampedAlpha},
    {"matte", 0.5, "\"float alpha\" 0.5", true},
    {"half", 0.25, "\"float alpha\" 0.5"},
    // The lower floor is seen by half of the eye paths and lit by half of the photons.
    {"matte", 0.75, "\"float alpha\" 0.5", false, true},
    {"half", 0.25, "\"float alpha\" 0.5", true},
    {"half-of-half", 0.25, "", true},
};

inline std::string quad(double x, double y, double z, const std::string& more) {
    return fmt::format(
        "Shape \"trianglemesh\" \"point3 P\" [ {0} {1} {4}  {2} {1} {4}  {2} {3} {4}  {0} {3} {4} ] "
        "\"point2 uv\" [ 0 0  1 0  1 1  0 1 ] \"integer indices\" [ 0 1 2 0 2 3 ] {5}\n",
        x, y, x + kTileSize, y + kTileSize, z, more);
}

// The tiles under a light from straight above, seen from there: a matte one of albedo 0.8 shows 0.8.
// Without textures, the ramps are replaced by their mean: lavapipe takes minutes to compile kernels with textured masks and
// mixes.
inline std::string floor_scene(bool textured) {
    std::string text = fmt::format(
        "LookAt 0 0 1  0 0 0  0 1 0\n"
        "Camera \"orthographic\" \"float screenwindow\" [ -{0} {0} -{0} {0} ]\n"
        "Film \"rgb\" \"integer xresolution\" {1} \"integer yresolution\" {1} \"string filename\" \"x.exr\"\n"
        "PixelFilter \"box\" \"float xradius\" 0.5 \"float yradius\" 0.5\n"
        "Sampler \"independent\" \"integer pixelsamples\" 16\n"
        "Integrator \"path\" \"integer maxdepth\" 1\n"
        "WorldBegin\n"
        "LightSource \"distant\" \"rgb L\" [ 3.14159265 3.14159265 3.14159265 ] \"point3 from\" [ 0 0 1 ] "
        "\"point3 to\" [ 0 0 0 ]\n"
        "MakeNamedMaterial \"matte\" \"string type\" \"diffuse\" \"rgb reflectance\" [ 0.8 0.8 0.8 ]\n"
        "MakeNamedMaterial \"pane\" \"string type\" \"thindielectric\"\n",
        kShown / 2.0, kTiles * kTilePixels);
    const auto mix = [&](const char* name, const char* a, const char* b, const char* amount) {
        text +=
            fmt::format("MakeNamedMaterial \"{}\" \"string type\" \"mix\" \"string materials\" [ \"{}\" \"{}\" ] {}\n",
                        name, a, b, amount);
    };
    if (textured)
        text +=
            "Texture \"ramp\" \"float\" \"bilerp\" \"float v00\" 0 \"float v01\" 0 \"float v10\" 1 \"float v11\" 1\n";
    text += one_of_each(-0.3);  // under the corner of four tiles
    mix("none", "matte", "pane", "\"float amount\" 0");
    mix("quarter", "matte", "pane", "\"float amount\" 0.25");
    mix("half", "matte", "pane", "\"float amount\" 0.5");
    mix("all", "matte", "pane", "\"float amount\" 1");
    mix("half-of-half", "half", "pane", "\"float amount\" 0.5");
    mix("pane-or-half", "pane", "half", "\"float amount\" 0.5");
    mix("ramped", "matte", "pane", textured ? "\"texture amount\" \"ramp\"" : "\"float amount\" 0.5");
    for (size_t i = 0; i < kFloor.size(); ++i) {
        const Tile& tile = kFloor[i];
        const double x = double(i % kTiles) * kTileSize - kShown / 2.0;
        const double y = kShown / 2.0 - double(i / kTiles + 1) * kTileSize;
        const char* alpha = !textured && tile.alpha == kRampedAlpha ? "\"float alpha\" 0.5" : tile.alpha;
        const std::string shape = fmt::format("NamedMaterial \"{}\"\n", tile.material) + quad(x, y, 0.0, alpha);
        if (tile.instance)
            text += fmt::format("ObjectBegin \"{0}\"\n{1}ObjectEnd\nObjectInstance \"{0}\"\n", i, shape);
        else
            text += shape;
        if (tile.floor_below) text += "NamedMaterial \"matte\"\n" + quad(x, y, -0.3, "");
    }
    return text;
}

// Pixels at a tile's rim see photons of the next tile. Pixels are used in pairs opposite to each other, so that ramps cancel
// out.
inline Mean tile_mean(const Rendered& image, size_t tile) {
    Mean mean;
    // Seen from above, the camera's x runs against the world's.
    const int x0 = (kTiles - 1 - int(tile % kTiles)) * kTilePixels, y0 = int(tile / kTiles) * kTilePixels;
    for (int y = 1; y < kTilePixels - 1; ++y)
        for (int x = 1; x < kTilePixels / 2; ++x)
            mean.add(0.5 * (image.luminance(x0 + x, y0 + y) +
                            image.luminance(x0 + kTilePixels - 1 - x, y0 + kTilePixels - 1 - y)));
    return mean;
}

// `detectable`: if the standard errors are larger than this, the test is too weak, and fails.
inline void expect_tiles(const Rendered& image, double detectable) {
    for (size_t i = 0; i < kFloor.size(); ++i) {
        const Mean mean = tile_mean(image, i);
        const double expected = 0.8 * kFloor[i].share;
        // If nothing is random, only rounding is allowed.
        EXPECT_LT(std::abs(mean.value() - expected), kTileThreshold * mean.error() + 1e-5)
            << "tile " << i << ": " << mean.value() << " +- " << mean.error() << ", expected " << expected;
        EXPECT_LT(mean.error(), detectable) << "tile " << i << ": the test cannot tell";
    }
}

}  // namespace lampyris::test
