// The records of light_layout.h for host code.
#pragma once

#include "core/device/kernel_types.h"

namespace lampyris::kernel {
#define CONST inline constexpr
#include "integrators/light/light_layout.h"
#undef CONST
}  // namespace lampyris::kernel
