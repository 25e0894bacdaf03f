// The backends that tests run on.
#pragma once

#include "core/device/device.h"

#include <cstdlib>
#include <string>
#include <vector>

namespace lampyris::test {

// All that this build has; without Vulkan if LAMPYRIS_WITHOUT_VULKAN is set. The system is not asked which have a device: a test
// names its cases before it runs any, and the loading of Vulkan's drivers would take most of the time of most tests.
inline std::vector<std::string> usable_backends() {
    std::vector<std::string> names = backend_names();
    if (std::getenv("LAMPYRIS_WITHOUT_VULKAN")) std::erase(names, "vulkan");
    return names;
}

// Of these, one for each build of kernels that trace no rays: those of cpu-bvh2 are the CPU's.
inline std::vector<std::string> kernel_backends() {
    std::vector<std::string> names = usable_backends();
    std::erase(names, "cpu-bvh2");
    return names;
}

}  // namespace lampyris::test
