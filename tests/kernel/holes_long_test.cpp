// holes_test with 10^8 rays in random directions, on the CPU.
#include "support/closed_mesh.h"

#include <gtest/gtest.h>

namespace lampyris::test {
namespace {

class HolesLong : public testing::TestWithParam<std::string> {};

TEST_P(HolesLong, AreRare) {
    for (const std::string& mesh : closed_meshes()) {
        const Escaped escaped = escaped_rays(mesh, GetParam(), 100000000, false);
        EXPECT_LE(escaped.closest, 40u) << mesh;
        EXPECT_LE(escaped.occlusion, 40u) << mesh;
    }
}

INSTANTIATE_TEST_SUITE_P(Backends, HolesLong, testing::Values("cpu", "cpu-bvh2"),
                         [](const auto& info) { return info.param == "cpu" ? "cpu" : "cpu_bvh2"; });

}  // namespace
}  // namespace lampyris::test
