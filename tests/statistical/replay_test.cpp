// The log of a replay: what its events add up to is the pixel, for every integrator, on every backend.
#include "core/render/render.h"
#include "support/render.h"
#include "support/replay.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cctype>
#include <initializer_list>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace lampyris {
namespace {

using kernel::PathLogRecord;
using test::expect_events_to_add_up;
using test::kCrowded;
using test::kRoom;
using test::replay;
using test::usable_backends;

const std::vector<std::string> kIntegrators = {"path:maxdepth=6",
                                               "light:maxdepth=6,lightpaths=20000",
                                               "bdpt:maxdepth=6",
                                               "bdpt:maxdepth=6,connections=1",
                                               "bdpt:maxdepth=6,cache=2",
                                               "bdpt:maxdepth=6,counts=auto",
                                               "vcm:maxdepth=6,radius=0.2,lightpaths=4000",
                                               "bpm:maxdepth=6,radius=0.2,lightpaths=4000",
                                               "sppm:maxdepth=6,radius=0.2,photonsperiteration=4000",
                                               "ppm:maxdepth=6,radius=0.2,photonsperiteration=4000",
                                               "mlt:maxdepth=6,chains=64"};

class ReplayTest : public testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(ReplayTest, EventsAddUpToThePixel) {
    const auto& [integrator, backend] = GetParam();
    const std::shared_ptr<Device> device = create_device(backend, {});
    // A shader with every effect takes a driver minutes to compile: replay_long_test has it.
    const bool slow = backend == "vulkan";
    std::map<uint32_t, int> seen;
    double lit = 0.0;
    for (const std::string* scene : {&kRoom, &kCrowded}) {
        if (slow && scene == &kCrowded) continue;
        for (int y = 2; y < 16; y += slow ? 6 : 3)
            for (int x = 1; x < 24; x += slow ? 9 : 3) {
                SCOPED_TRACE(fmt::format("{} pixel {} {}", scene == &kRoom ? "room" : "crowded", x, y));
                const RenderOutcome outcome = replay(*scene, integrator, device, {x, y, 0});
                expect_events_to_add_up(outcome);
                lit += double(outcome.pixels[0].sum.x);
                for (const PathEvent& event : outcome.paths.events) ++seen[event.record.event];
            }
    }
    EXPECT_GT(lit, 0.0);
    EXPECT_GT(seen[kernel::LOG_VERTEX], 0);
    EXPECT_GT(seen[kernel::LOG_SCATTER], 0);
    if (!slow) {
        EXPECT_GT(seen[kernel::LOG_PASS], 0);
    }
    const std::string name = integrator.substr(0, integrator.find(':'));
    if (name == "bpm" || name == "vcm" || name.ends_with("ppm")) {
        EXPECT_GT(seen[kernel::LOG_MERGE], 0);
    }
    if (name == "vcm" || name == "bdpt") {
        EXPECT_GT(seen[kernel::LOG_CONNECTION], 0);
    }
    if (name == "mlt" || name == "light") {
        EXPECT_GT(seen[kernel::LOG_SPLAT], 0);
    }
}

INSTANTIATE_TEST_SUITE_P(Integrators, ReplayTest,
                         testing::Combine(testing::ValuesIn(kIntegrators), testing::ValuesIn(usable_backends())),
                         [](const auto& info) {
                             std::string name = std::get<0>(info.param) + "_" + std::get<1>(info.param);
                             for (char& c : name)
                                 if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                             return name;
                         });

// Replays of some pixels of the room, by the integrators with light paths.
template <typename Check>
void for_pixels_with_light_paths(std::initializer_list<const char*> integrators, Check check) {
    const std::shared_ptr<Device> device = create_device("cpu", {});
    for (const char* integrator : integrators) {
        SCOPED_TRACE(integrator);
        size_t found = 0;
        for (const int y : {6, 12})
            for (const int x : {2, 7, 12, 17, 22}) found += check(replay(kRoom, integrator, device, {x, y, 0}).paths);
        EXPECT_GT(found, 0u);
    }
}

// A light path has its vertices in the log if, and only if, it contributes or is connected.
TEST(Replay, LightPathsThatContributeAreFollowed) {
    const auto check = [](const PathLog& log) {
        std::set<uint32_t> named, followed;
        for (const PathEvent& event : log.events) {
            const PathLogRecord& r = event.record;
            if (r.event == kernel::LOG_SPLAT) named.insert(r.path);
            if (r.event == kernel::LOG_CONNECTION || r.event == kernel::LOG_MERGE) named.insert(r.partner);
            if (r.kind == kernel::LOG_LIGHT_PATH && r.event == kernel::LOG_START) followed.insert(r.path);
        }
        EXPECT_EQ(named, followed);
        return named.size();
    };
    for_pixels_with_light_paths({"light:lightpaths=20000", "bdpt", "vcm:radius=0.2,lightpaths=4000",
                                 "sppm:radius=0.2,photonsperiteration=4000"},
                                check);
}

// The photon that was merged is a vertex of the light path that the log names.
TEST(Replay, MergedPhotonsAreVerticesOfTheirPaths) {
    const auto check = [](const PathLog& log) {
        std::set<std::array<float, 4>> vertices;
        for (const PathEvent& event : log.events) {
            const PathLogRecord& r = event.record;
            if (r.kind == kernel::LOG_LIGHT_PATH && r.event == kernel::LOG_VERTEX)
                vertices.insert({float(r.path), r.position.x, r.position.y, r.position.z});
        }
        size_t merged = 0;
        for (const PathEvent& event : log.events) {
            const PathLogRecord& r = event.record;
            if (r.event != kernel::LOG_MERGE) continue;
            ++merged;
            EXPECT_TRUE(vertices.contains({float(r.partner), r.position.x, r.position.y, r.position.z})) << r.partner;
        }
        return merged;
    };
    for_pixels_with_light_paths({"vcm:radius=0.2,lightpaths=4000", "sppm:radius=0.2,photonsperiteration=4000"}, check);
}

TEST(Replay, AnOrdinaryRenderingHasNoLog) {
    RenderRequest request;
    request.scene = SceneSource::of_text(kRoom);
    request.limits.passes = 1;
    const RenderOutcome outcome = render(request);
    EXPECT_TRUE(outcome.paths.events.empty());
    EXPECT_EQ(outcome.record.effects.size(),
              replay(kRoom, "path", create_device("cpu", {}), {1, 1, 0}).record.effects.size())
        << "the log is no effect of the scene";
}

}  // namespace
}  // namespace lampyris
