// Tests run on every backend that has a device: this one fails where that would silently leave one out.
#include "support/render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

namespace lampyris::test {
namespace {

TEST(BackendsPresent, EveryBackendHasADevice) {
    if (std::getenv("LAMPYRIS_WITHOUT_VULKAN")) GTEST_SKIP() << "LAMPYRIS_WITHOUT_VULKAN is set";
    const std::vector<std::string> usable = usable_backends();
    for (const std::string& backend : backend_names())
        EXPECT_NE(std::find(usable.begin(), usable.end(), backend), usable.end())
            << backend
            << " has no device here, so no test ran on it; a Vulkan driver is missing (Debian: mesa-vulkan-drivers). "
            << "Set LAMPYRIS_WITHOUT_VULKAN where that is meant.";
}

}  // namespace
}  // namespace lampyris::test
