// The records of mlt_layout.h for host code.
#pragma once

#include "core/device/kernel_types.h"

namespace lampyris::kernel {
#define CONST inline constexpr
#include "integrators/mlt/mlt_layout.h"
#undef CONST
}  // namespace lampyris::kernel
