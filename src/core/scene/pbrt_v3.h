// Recognises scenes in the format of pbrt-v3 (and older), which looks much like pbrt-v4's and means other things.
#pragma once

#include "core/base/error.h"

#include <string>
#include <string_view>

namespace lampyris {

// Each question returns whether the thing exists in pbrt-v3 but not in pbrt-v4. The first yes is reported, with what
// stands in its place today and how a scene is upgraded; the rest of an old scene would only repeat it.
class OldFormat {
 public:
    explicit OldFormat(Diagnostics& diagnostics) : diagnostics_(&diagnostics) {}
    bool directive(std::string_view word, Location location);
    bool entity(std::string_view directive, std::string_view type, Location location);
    bool parameter_type(std::string_view type, Location location);
    bool parameter_name(std::string_view name, Location location);

 private:
    bool found(const std::string& what, const std::string& instead, Location location);
    Diagnostics* diagnostics_;
    bool reported_ = false;
};

}  // namespace lampyris
