// The log of a replay on Vulkan, in a scene with most effects: the shader takes lavapipe minutes to compile.
#include "support/render.h"
#include "support/replay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>

namespace lampyris::test {
namespace {

TEST(ReplayLong, EventsAddUpToThePixelOnVulkan) {
    ASSERT_EQ(std::ranges::count(usable_backends(), "vulkan"), 1) << "no Vulkan device";
    const std::shared_ptr<Device> device = create_device("vulkan", {});
    std::set<uint32_t> seen;
    for (int y = 2; y < 16; y += 6)
        for (int x = 1; x < 24; x += 9) {
            const RenderOutcome outcome = replay(kCrowded, "path:maxdepth=6", device, {x, y, 0});
            expect_events_to_add_up(outcome);
            for (const PathEvent& event : outcome.paths.events) seen.insert(event.record.event);
        }
    EXPECT_TRUE(seen.contains(kernel::LOG_PASS));
}

}  // namespace
}  // namespace lampyris::test
