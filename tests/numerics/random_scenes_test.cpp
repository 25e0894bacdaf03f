// Random scenes, by several integrators and on several backends.
#include "support/random_scenes.h"

#include <gtest/gtest.h>

namespace lampyris::test {
namespace {

TEST(RandomScenes, IntegratorsAgree) {
    for (uint32_t seed = 1; seed <= 2; ++seed) expect_integrators_agree(seed, {"bdpt", "vcm", "mlt"});
}

TEST(RandomScenes, BackendsAgree) {
    for (uint32_t seed = 1; seed <= 24; ++seed)
        for (const char* integrator : {"path", "bdpt", "sppm:photonsperiteration=2000"})
            expect_backends_agree(seed, "cpu-bvh2", integrator);
}

}  // namespace
}  // namespace lampyris::test
