// How closed closed meshes are: docs/numerics.md has the shares of rays that escape, which are not 0 yet. Bounds are four times
// what was measured. holes_long_test has more rays.
#include "support/closed_mesh.h"
#include "support/render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

namespace lampyris::test {
namespace {

class Holes : public testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(Holes, AreRare) {
    const auto& [mesh, backend] = GetParam();
    const Escaped random = escaped_rays(mesh, backend, 1 << 19, false);
    EXPECT_LE(random.closest, 4u);
    EXPECT_LE(random.occlusion, 4u);
    constexpr uint64_t kAimed = 1 << 17;
    const Escaped aimed = escaped_rays(mesh, backend, kAimed, true);
    EXPECT_LT(aimed.closest, kAimed / 8);
    EXPECT_LT(aimed.occlusion, kAimed / 8);
}

INSTANTIATE_TEST_SUITE_P(Meshes, Holes,
                         testing::Combine(testing::ValuesIn(closed_meshes()), testing::ValuesIn(usable_backends())),
                         [](const auto& info) {
                             std::string name = std::get<0>(info.param) + "_" + std::get<1>(info.param);
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

}  // namespace
}  // namespace lampyris::test
