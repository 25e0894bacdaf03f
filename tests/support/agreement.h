// How closely the images of two backends agree, given the same seed.
#pragma once

#include "support/render.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace lampyris::test {

struct Agreement {
    size_t pixels = 0;
    size_t identical = 0;                       // to the bit
    size_t within = 0;                          // identical, or each channel within the relative tolerance
    double largest = 0.0;                       // relative difference of a channel
    std::vector<std::array<int, 2>> diverging;  // the first few pixels that are not within it: for --replay
    double share() const { return double(within) / double(pixels); }
};

// Relative to the larger of the two numbers, or to 1e-3 of the image's maximum if both are darker.
Agreement agreement(const Rendered& a, const Rendered& b, double tolerance);

// Every scene of the folders scenes/reference and scenes/analytic, as paths relative to scenes/ without extension; sorted.
std::vector<std::string> small_scenes();
// As few of scenes/reference as have the effects of all of them.
const std::vector<std::string>& scenes_of_all_effects();
// Of the small scenes, those and all with a closed form; and the others, whose effects these have.
std::vector<std::string> varied_scenes();
std::vector<std::string> further_scenes();
uint64_t effects_of(const std::string& scene);
std::string scene_path(const std::string& name);
// A name that GoogleTest accepts.
std::string test_name(std::string text);

// Renders on the CPU and on `other`, with `path` if the settings name no integrator. Prints the shares as a line of a table,
// and saves the images if `least` is not reached.
Agreement expect_agreement(const std::string& scene, const std::string& other, const RenderSettings& settings,
                           double tolerance, double least);

// One sample a pixel on Vulkan with the option for exact quotients, and copies as on a GPU.
void expect_exact_agreement(const std::string& scene);

}  // namespace lampyris::test
