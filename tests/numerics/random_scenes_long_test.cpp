// More random scenes, and those on Vulkan, where each needs shaders of its own.
#include "support/random_scenes.h"

#include <gtest/gtest.h>

namespace lampyris::test {
namespace {

TEST(RandomScenesLong, IntegratorsAgree) {
    for (uint32_t seed = 100; seed < 250; ++seed) expect_integrators_agree(seed, {"bdpt", "vcm", "mlt"});
}

TEST(RandomScenesLong, BackendsAgree) {
    for (uint32_t seed = 100; seed < 400; ++seed)
        for (const char* integrator : {"path", "bdpt", "vcm", "mlt", "sppm:photonsperiteration=2000"})
            expect_backends_agree(seed, "cpu-bvh2", integrator);
}

TEST(RandomScenesLong, VulkanAgrees) {
    for (uint32_t seed = 1; seed <= 12; ++seed) expect_backends_agree(seed, "vulkan", "path");
}

}  // namespace
}  // namespace lampyris::test
