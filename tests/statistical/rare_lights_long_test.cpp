// As rare_lights_test.cpp, with as many lights as a large scene has: 2 million. False alarms: 9e-7 a mean, 2 means.
#include "support/rare_lights.h"

namespace lampyris::test {
namespace {

class ManyRareLights : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, ManyRareLights, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return name_of(info.param); });

TEST_P(ManyRareLights, ALampInTwoMillionPiecesIsTheLamp) {
    const double expected = mean_wall_radiance();
    const std::string text = lamp_in_pieces(1024);
    expect_mean_of_runs(text, GetParam(), "path:maxdepth=1", 128, expected, 0.0, 0.1);
    expect_mean_of_runs(text, GetParam(), "sppm:maxdepth=1,direct=photons,photonsperiteration=100000,radius=0.3", 1,
                        expected, 0.01, 0.15);
}

}  // namespace
}  // namespace lampyris::test
