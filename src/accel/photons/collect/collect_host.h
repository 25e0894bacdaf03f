// The records of collect_layout.h for host code.
#pragma once

#include "core/device/kernel_types.h"

namespace lampyris::kernel {
#include "accel/photons/collect/collect_layout.h"
}  // namespace lampyris::kernel
