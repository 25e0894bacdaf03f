// Hard cases with known radiance, by every integrator on the CPU; on its other backends by the first one of each case, since what is
// theirs is the tracing of rays (hard_cases_long_test has the others there).
#include "support/hard_cases.h"

#include <gtest/gtest.h>

namespace lampyris::test {
namespace {

class HardCaseTest : public testing::TestWithParam<size_t> {
 protected:
    const HardCase& hard() const { return hard_cases()[GetParam()]; }
};

TEST_P(HardCaseTest, HasItsRadianceOnTheCpu) {
    for (const std::string& integrator : hard().integrators) expect_case(hard(), integrator, "cpu");
}

TEST_P(HardCaseTest, HasItsRadianceWithTheOtherTracer) { expect_case(hard(), hard().integrators[0], "cpu-bvh2"); }

TEST_P(HardCaseTest, HasItsRadianceOnVulkan) { expect_case(hard(), hard().integrators[0], "vulkan"); }

std::string name_of(const testing::TestParamInfo<size_t>& info) {
    std::string name;
    for (const char c : hard_cases()[info.param].name) name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    return name;
}

INSTANTIATE_TEST_SUITE_P(Cases, HardCaseTest, testing::Range(size_t(0), hard_cases().size()), name_of);

}  // namespace
}  // namespace lampyris::test
