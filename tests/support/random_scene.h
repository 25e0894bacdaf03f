// Random scenes: every shape, lamps of every kind, and most materials, in random places.
#pragma once

#include <cstdint>
#include <string>

namespace lampyris::test {

// `smooth`: with perfectly specular surfaces, small lamps and points, which some integrators find rarely. The text depends on the
// arguments alone.
std::string random_scene(uint32_t seed, bool smooth);

}  // namespace lampyris::test
