// Scenes that are moved by a power of two, together with the camera, give the same image: some scenes of scenes/analytic and
// scenes/reference here, all of them in moved_long_test.cpp.
#include "support/moved.h"

#include <algorithm>

namespace lampyris::test {
namespace {

class MovedTest : public testing::TestWithParam<std::string> {};

// Not moved back yet, and far out. On Vulkan one scene: lavapipe takes ten seconds to compile a scene's shaders.
TEST_P(MovedTest, ScenesAreTheSameFarAway) {
    const std::vector<Shift> shifts{{32, 0, 0}, {0, 64, 0}, {-(1 << 20), 0, 1 << 20}};
    const std::string scenes = std::string(LAMPYRIS_SOURCE_DIR) + "/scenes/";
    for (const char* scene : {"analytic/lamp-sphere", "analytic/lamp-rectangle", "reference/instances"}) {
        for (const char* integrator : kMovedIntegrators)
            expect_moved_alike(scenes + scene + ".pbrt", GetParam(), integrator, shifts, integrator[0] == 'p' ? 16 : 4);
        if (GetParam() == "vulkan") break;
    }
}

INSTANTIATE_TEST_SUITE_P(Backends, MovedTest, testing::ValuesIn(usable_backends()), [](const auto& info) {
    std::string name = info.param;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

}  // namespace
}  // namespace lampyris::test
