// The kernels' records (core/kernel/layout.h) for host code, in namespace lampyris::kernel.
#pragma once

#include "core/device/spectrum.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstdint>

namespace lampyris::kernel {
using uint = uint32_t;
using EffectSet = uint64_t;  // one bit an effect
#define EFFECT_BIT(bit) (::lampyris::kernel::EffectSet(1) << (bit))
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;
#define CONST inline constexpr
#include "core/kernel/effects.h"
#include "core/kernel/layout.h"
#include "core/kernel/path_log_layout.h"
#include "core/kernel/photon_layout.h"
#include "core/kernel/scene_buffers.h"
#undef CONST
}  // namespace lampyris::kernel

namespace lampyris {
// For host code, what core/kernel/spectrum.h is for kernels.
using kernel::Spectrum;
inline Spectrum spectrum_of_rgb(glm::vec3 rgb) { return {rgb.x, rgb.y, rgb.z}; }
inline glm::vec3 rgb_of(Spectrum s) { return {s[0], s[1], s[2]}; }
}  // namespace lampyris
