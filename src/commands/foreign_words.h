// Options of pbrt-v4 and Mitsuba 3, and what Lampyris calls them.
#pragma once

#include <string>
#include <string_view>

namespace lampyris {

// "; pbrt's --outfile is -o IMAGE here" for an option of theirs that Lampyris does not have; empty for any other.
std::string advice_on_option(std::string_view option);

// For a plugin's kind and name in Mitsuba's or pbrt's terms: "; pbrt's ... is `lampyris plugins ...` here". Empty for any
// other.
std::string advice_on_plugin(std::string_view kind, std::string_view name);

}  // namespace lampyris
