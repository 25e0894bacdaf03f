// checkpoint_test for every integrator on Vulkan: minutes, where shaders are compiled anew.
#include "support/checkpoint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace lampyris::test {
namespace {

TEST(CheckpointLong, EveryIntegratorGoesOnOnVulkan) {
    const std::vector<std::string> backends = usable_backends();
    ASSERT_EQ(std::ranges::count(backends, "vulkan"), 1) << "no Vulkan device";
    for (const std::string& integrator : kCheckpointIntegrators) {
        SCOPED_TRACE(integrator);
        expect_to_go_on(integrator, "vulkan");
    }
}

}  // namespace
}  // namespace lampyris::test
