// Hard cases with known radiance on Vulkan, by every integrator.
#include "support/hard_cases.h"

#include <gtest/gtest.h>

namespace lampyris::test {
namespace {

class HardCaseLongTest : public testing::TestWithParam<std::string> {};

TEST_P(HardCaseLongTest, HasItsRadianceOnVulkan) {
    for (const HardCase& hard : hard_cases())
        for (const std::string& integrator : hard.integrators)
            if (integrator == GetParam()) expect_case(hard, integrator, "vulkan");
}

INSTANTIATE_TEST_SUITE_P(Integrators, HardCaseLongTest, testing::Values("path", "bdpt", "vcm", "mlt", "sppm"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace lampyris::test
