// The records of photon_paths_layout.h for host code.
#pragma once

#include "core/device/kernel_types.h"

namespace lampyris::kernel {
#define CONST inline constexpr
#include "integrators/photon_paths/photon_paths_layout.h"
#undef CONST
}  // namespace lampyris::kernel
