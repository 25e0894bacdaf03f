// Every backend has a device here, or the tests of one cannot run: this one says what is missing.
#include "support/backends.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace lampyris::test {
namespace {

TEST(BackendsPresent, EveryBackendHasADevice) {
    std::set<std::string> present;
    for (const DeviceInfo& device : list_devices()) present.insert(device.backend);
    for (const std::string& backend : usable_backends())
        EXPECT_TRUE(present.contains(backend))
            << backend << " has no device here, so that its tests fail; a Vulkan driver is missing (Debian: "
            << "mesa-vulkan-drivers). Set LAMPYRIS_WITHOUT_VULKAN to leave them out.";
}

}  // namespace
}  // namespace lampyris::test
