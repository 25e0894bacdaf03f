// Hard cases with known radiance by every integrator on the backends where hard_cases_test has one.
#include "support/hard_cases.h"

#include <gtest/gtest.h>

namespace lampyris::test {
namespace {

class HardCaseLongTest : public testing::TestWithParam<std::string> {};

void expect_cases(const std::string& chosen, const std::string& backend) {
    for (const HardCase& hard : hard_cases())
        for (const std::string& integrator : hard.integrators)
            if (integrator == chosen) expect_case(hard, integrator, backend);
}

TEST_P(HardCaseLongTest, HasItsRadianceWithTheOtherTracer) { expect_cases(GetParam(), "cpu-bvh2"); }

TEST_P(HardCaseLongTest, HasItsRadianceOnVulkan) { expect_cases(GetParam(), "vulkan"); }

INSTANTIATE_TEST_SUITE_P(Integrators, HardCaseLongTest, testing::Values("path", "bdpt", "vcm", "mlt", "sppm"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace lampyris::test
