// Every scene of scenes/analytic and scenes/reference, moved by powers of two up to 2^20 along each axis.
#include "support/moved.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace lampyris::test {
namespace {

const std::string kScenes = std::string(LAMPYRIS_SOURCE_DIR) + "/scenes/";

std::vector<std::string> scenes() {
    std::vector<std::string> all;
    for (const char* folder : {"analytic", "reference"})
        for (const auto& entry : std::filesystem::directory_iterator(kScenes + folder))
            if (entry.path().extension() == ".pbrt")
                all.push_back(std::string(folder) + "/" + entry.path().stem().string());
    std::sort(all.begin(), all.end());
    return all;
}

class MovedLongTest : public testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(MovedLongTest, IsTheSameFarAway) {
    const auto& [scene, backend] = GetParam();
    std::vector<Shift> shifts;
    for (const int exponent : {3, 6, 10, 15, 20})
        for (size_t axis = 0; axis < 3; ++axis) {
            Shift by{0, 0, 0};
            by[axis] = std::ldexp(axis == 1 ? 1.0 : -1.0, exponent);
            shifts.push_back(by);
        }
    for (const char* integrator : kMovedIntegrators)
        expect_moved_alike(kScenes + scene + ".pbrt", backend, integrator, shifts, integrator[0] == 'p' ? 16 : 4);
}

std::string test_name(const testing::TestParamInfo<std::tuple<std::string, std::string>>& info) {
    std::string name = std::get<0>(info.param) + "_" + std::get<1>(info.param);
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return name;
}

INSTANTIATE_TEST_SUITE_P(Cpu, MovedLongTest,
                         testing::Combine(testing::ValuesIn(scenes()), testing::Values("cpu", "cpu-bvh2")), test_name);
// Each scene needs shaders of its own, which lavapipe takes a minute to compile, so Vulkan only renders those with special
// lights and shapes.
INSTANTIATE_TEST_SUITE_P(Vulkan, MovedLongTest,
                         testing::Combine(testing::Values("analytic/lamp-cylinder", "analytic/lamp-patch",
                                                          "analytic/lamp-spot", "analytic/medium-nested",
                                                          "reference/infinite-image", "reference/textures"),
                                          testing::Values("vulkan")),
                         test_name);

}  // namespace
}  // namespace lampyris::test
