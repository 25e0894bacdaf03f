// Hard cases with known radiance, by every integrator on the CPU; on the other backends by the first one of those cases that are hard
// for rays (hard_cases_long_test has the others there).
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

class HardRayTest : public HardCaseTest {};

TEST_P(HardRayTest, HasItsRadianceWithTheOtherTracer) { expect_case(hard(), hard().integrators[0], "cpu-bvh2"); }

TEST_P(HardRayTest, HasItsRadianceOnVulkan) { expect_case(hard(), hard().integrators[0], "vulkan"); }

std::string name_of(const testing::TestParamInfo<size_t>& info) {
    std::string name;
    for (const char c : hard_cases()[info.param].name) name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    return name;
}

std::vector<size_t> everywhere() {
    std::vector<size_t> chosen;
    for (size_t i = 0; i < hard_cases().size(); ++i)
        if (hard_cases()[i].everywhere) chosen.push_back(i);
    return chosen;
}

INSTANTIATE_TEST_SUITE_P(Cases, HardCaseTest, testing::Range(size_t(0), hard_cases().size()), name_of);
INSTANTIATE_TEST_SUITE_P(Cases, HardRayTest, testing::ValuesIn(everywhere()), name_of);

}  // namespace
}  // namespace lampyris::test
