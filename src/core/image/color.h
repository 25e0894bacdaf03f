// From scene-linear light to what a display shows, by OpenColorIO and a configuration of our own (color_config.h).
//
// The configuration is built in, and the OCIO environment variable is ignored: the same file and options make the same picture
// on every machine.
#pragma once

#include "core/image/image.h"

#include <cstdint>
#include <string>
#include <vector>

namespace lampyris {

inline constexpr const char* kDefaultView = "Standard";

struct View {
    std::string name;
    std::string description;
};

// The views that `--view` knows, in the order in which the configuration lists them.
const std::vector<View>& views();
std::vector<std::string> view_names();
// Throws an InputError that lists the views if there is none of this name.
void check_view(const std::string& view);

// Scene-linear Rec.709 light to display values, 0 = black to 1 = white, in place. `rgb` must have exactly three
// channels. `exposure` is in stops: light is multiplied by 2^exposure first. NaN becomes black.
void apply_view(Image& rgb, const std::string& view, float exposure);
// The same, rounded to 8 bits: [height][width][3].
std::vector<uint8_t> display_bytes(const Image& rgb, const std::string& view, float exposure);

}  // namespace lampyris
