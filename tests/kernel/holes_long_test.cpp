// holes_test with 10^9 rays on each backend of the CPU: for each mesh, 3 * 10^8 in random directions and 4 * 10^7 at edges.
#include "support/closed_mesh.h"

#include <gtest/gtest.h>

namespace lampyris::test {
namespace {

class HolesLong : public testing::TestWithParam<std::string> {};

TEST_P(HolesLong, AreNotThere) {
    for (const std::string& mesh : closed_meshes()) {
        for (const Aim aim : {Aim::kNowhere, Aim::kEdges}) {
            const Escaped escaped = escaped_rays(mesh, GetParam(), aim == Aim::kNowhere ? 300000000 : 40000000, aim);
            EXPECT_EQ(escaped.closest, 0u) << mesh << int(aim);
            EXPECT_EQ(escaped.occlusion, 0u) << mesh << int(aim);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Backends, HolesLong, testing::Values("cpu", "cpu-bvh2"),
                         [](const auto& info) { return info.param == "cpu" ? "cpu" : "cpu_bvh2"; });

}  // namespace
}  // namespace lampyris::test
