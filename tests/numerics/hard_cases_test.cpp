// Hard cases with known radiance, by every integrator on the CPU; by the first one with the other tracer, of those cases that are hard
// for rays, and on Vulkan of a few of these, since a compiler is at work for seconds for each (hard_cases_long_test has all).
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

class HardVulkanTest : public HardCaseTest {};

TEST_P(HardVulkanTest, HasItsRadianceOnVulkan) { expect_case(hard(), hard().integrators[0], "vulkan"); }

std::string name_of(const testing::TestParamInfo<size_t>& info) {
    std::string name;
    for (const char c : hard_cases()[info.param].name) name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    return name;
}

std::vector<size_t> those(bool HardCase::*chosen) {
    std::vector<size_t> all;
    for (size_t i = 0; i < hard_cases().size(); ++i)
        if (hard_cases()[i].*chosen) all.push_back(i);
    return all;
}

INSTANTIATE_TEST_SUITE_P(Cases, HardCaseTest, testing::Range(size_t(0), hard_cases().size()), name_of);
INSTANTIATE_TEST_SUITE_P(Cases, HardRayTest, testing::ValuesIn(those(&HardCase::for_tracers)), name_of);
INSTANTIATE_TEST_SUITE_P(Cases, HardVulkanTest, testing::ValuesIn(those(&HardCase::for_vulkan)), name_of);

}  // namespace
}  // namespace lampyris::test
