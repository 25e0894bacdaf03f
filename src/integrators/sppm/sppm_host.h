// The records of sppm.layout.h for host code.
#pragma once

#include "core/kernel_types.h"

namespace lampyris::kernel {
#define CONST inline constexpr
#include "integrators/sppm/sppm.layout.h"
#undef CONST
}  // namespace lampyris::kernel
