// What --replay prints: one sample of one pixel, and the paths that it is made of.
#pragma once

#include "core/render/render.h"

#include <array>
#include <string>

namespace lampyris {

// JSON, one event of a path a line.
std::string replay_text(const RenderOutcome& outcome, const std::array<int, 3>& replay);

}  // namespace lampyris
