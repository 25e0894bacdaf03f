// Photon maps on every backend: exact ones find the same photons as brute force, and results that must not depend on the
// machine do not.
#include "core/photons/photon_map.h"
#include "support/device_run.h"
#include "support/photon_sets.h"

#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

namespace lampyris {
namespace {

using namespace test;

std::unique_ptr<PhotonMap> open_map(Device& device, const std::string& choice) {
    auto map = create_photon_map(choice);
    map->open(device);
    return map;
}

// A device of the first backend that can run the map; null if there is none.
std::unique_ptr<Device> device_for(const std::string& choice) {
    for (const std::string& backend : kernel_backends()) {
        auto device = create_device(backend);
        if (can_run(*device, *create_photon_map(choice))) return device;
    }
    return nullptr;
}

// photon_map_long_test has the sizes that matter. Other backends than the CPU get a third of the cases, each of another kind: many
// queries, many photons, one photon.
TEST(PhotonMap, ExactOnesFindWhatBruteForceFinds) {
    std::vector<std::string> maps = exact_photon_maps();
    maps.emplace_back("brute_force");
    std::vector<PhotonCase> cases, few;
    for (const std::string& name : photon_case_names()) {
        cases.push_back(make_photon_case(name, 2000, 4000));
        cases.push_back(make_photon_case(name, 20'000, 200));
        cases.push_back(make_photon_case(name, 1, 50));
        few.push_back(cases[cases.size() - 3 + few.size() % 3]);
    }
    expect_exact(maps, cases, {"cpu"});
    std::vector<std::string> others = kernel_backends();
    std::erase(others, "cpu");
    expect_exact(maps, few, others);
}

// The same sums, to the bit, on any number of threads and any backend, and in whatever order photons were stored.
TEST(PhotonMap, FixedOrderMeansTheSameSums) {
    std::vector<std::string> choices;
    for (const std::string& name : photon_maps().names())
        if (create_photon_map(name)->capabilities().fixed_order) choices.push_back(name);
    for (const char* other : {"stochastic_hash:slots=3,table_size=0.1", "bvh:ray_query=off"}) {
        ASSERT_TRUE(create_photon_map(other)->capabilities().fixed_order) << other;
        choices.emplace_back(other);
    }
    struct Machine {
        std::string backend;
        unsigned threads;
    };
    std::vector<Machine> machines{{"cpu", 1}, {"cpu", 2}, {"cpu", 7}};
    for (const std::string& backend : kernel_backends())
        if (backend != "cpu") machines.push_back({backend, 0});
    for (const char* name : {"random", "few_places", "planar"}) {
        PhotonCase photon_case = make_photon_case(name, 50'000, 2000);
        if (std::string(name) == "few_places") photon_case = make_photon_case(name, 5000, 2000);
        for (const std::string& choice : choices) {
            std::vector<CollectResult> first;
            std::mt19937 random(3);
            for (const Machine& machine : machines) {
                SCOPED_TRACE(choice + " " + name + " " + machine.backend + " " + std::to_string(machine.threads));
                DeviceOptions options = exact_options(machine.backend);
                options.threads = machine.threads;
                const auto device = create_device(machine.backend, options);
                const auto map = open_map(*device, choice);
                const auto found = collect(*device, *map, upload_case(*device, photon_case));
                if (first.empty()) first = found;
                EXPECT_EQ(std::memcmp(first.data(), found.data(), found.size() * sizeof(found[0])), 0);
                std::shuffle(photon_case.photons.begin(), photon_case.photons.end(), random);
            }
        }
    }
}

// Cells that did not get an entry are found in the stash. With a table this tight about 115 of 10^6 cells are stashed, and
// four of these would have found an empty entry next. If lookups ended at empty entries, these would be lost.
// On the CPU alone, since other backends need half a minute for so many photons, and have the same kernels.
TEST(PhotonMap, CuckooFindsWhatItStashed) {
    constexpr uint32_t kSide = 100;
    std::mt19937 random(1);
    std::uniform_real_distribution<float> jitter(0.25f, 0.75f);
    PhotonCase grid;
    grid.low = glm::vec3(0.0f), grid.high = glm::vec3(float(kSide)), grid.radius = 0.1f;
    for (uint32_t i = 0; i < kSide * kSide * kSide; ++i) {
        const glm::vec3 p(float(i % kSide) + jitter(random), float(i / kSide % kSide) + jitter(random),
                          float(i / kSide / kSide) + jitter(random));
        grid.photons.push_back(make_photon(p, glm::vec3(0, 0, 1), glm::vec3(1.0f), i));
        grid.queries.emplace_back(p, grid.radius);
    }
    const auto device = create_device("cpu");
    const auto map = open_map(*device, "cuckoo:table_size=1.05,stash=1024,cell_size=2");
    uint32_t lost = 0;
    for (const CollectResult& found : collect(*device, *map, upload_case(*device, grid)))
        lost += uint32_t(found.found.x != 1);
    EXPECT_EQ(lost, 0u);
}

TEST(PhotonMap, NoPhotonsAndNoQueriesAreNoError) {
    for (const std::string& backend : kernel_backends()) {
        const auto device = create_device(backend);
        std::vector<std::string> choices = photon_maps().names();
        choices.emplace_back("bvh:ray_query=on");
        for (const std::string& choice : choices) {
            SCOPED_TRACE(backend + " " + choice);
            if (!can_run(*device, *create_photon_map(choice))) continue;
            const auto map = open_map(*device, choice);
            PhotonSet set = upload_case(*device, make_photon_case("random", 10, 10));
            set.count = 0;
            for (const CollectResult& result : collect(*device, *map, set)) EXPECT_EQ(result.found.x, 0u);
            map->gather({kCollect, 0, nullptr, {{"results", set.queries}}}, set.queries, 0, 0);
        }
    }
}

TEST(PhotonMap, MapsAreReusedFromPassToPass) {
    for (const std::string& choice : exact_photon_maps()) {
        SCOPED_TRACE(choice);
        const auto device = device_for(choice);
        if (!device) continue;
        const auto map = open_map(*device, choice);
        const auto fresh = open_map(*device, "brute_force");
        size_t bytes = 0;
        for (const uint32_t photons : {20'000u, 500u, 20'000u, 18'000u}) {
            PhotonSet set = upload_case(*device, make_photon_case("random", photons, 300, photons));
            set.pass = photons;
            const auto found = collect(*device, *map, set), expected = collect(*device, *fresh, set);
            for (size_t i = 0; i < found.size(); ++i)
                ASSERT_TRUE(same_photons(found[i], expected[i], map->capabilities().sums_only)) << "query " << i;
            if (bytes == 0) bytes = map->memory_bytes();
            EXPECT_LE(map->memory_bytes(), bytes + bytes / 8) << "memory grows from pass to pass";
        }
        const PhotonMapStatistics statistics = map->statistics();
        EXPECT_GT(statistics.construction_s, 0);
        EXPECT_GT(statistics.gathering_kernel_s, 0);
        EXPECT_EQ(statistics.lost_photons, 0u);
    }
}

// For speed only, the set's radius is that of the largest query, except in a structure over the hit points, whose layout
// depends on it.
TEST(PhotonMap, QueriesMayBeLargerThanTheSetSays) {
    for (const std::string& choice : exact_photon_maps()) {
        SCOPED_TRACE(choice);
        const auto device = device_for(choice);
        if (!device || create_photon_map(choice)->capabilities().needs_queries) continue;
        PhotonSet set = upload_case(*device, make_photon_case("random", 5000, 1000));
        set.radius *= 0.5f;
        const auto found = collect(*device, *open_map(*device, choice), set);
        const auto expected = collect(*device, *open_map(*device, "brute_force"), set);
        for (size_t i = 0; i < found.size(); ++i)
            ASSERT_TRUE(same_photons(found[i], expected[i], false)) << "query " << i;
    }
}

// ray_query=on is refused if the device does not offer it; auto follows the device's setting for a scene's rays.
TEST(PhotonMap, RayQueryIsWhatWasAskedFor) {
    const auto bytes = [](Device& device, const char* choice) {
        const auto map = open_map(device, choice);
        collect(device, *map, upload_case(device, make_photon_case("random", 1000, 100)));
        return map->memory_bytes();
    };
    for (const DeviceInfo& info : list_devices()) {
        SCOPED_TRACE(info.name);
        DeviceOptions options;
        options.device = std::to_string(info.index);
        const auto feature = info.features.find("ray_query");
        if (feature == info.features.end() || feature->second != "yes") {
            const auto device = create_device(info.backend, options);
            EXPECT_EQ(bytes(*device, "bvh"), bytes(*device, "bvh:ray_query=off"));
            try {
                open_map(*device, "bvh:ray_query=on");
                ADD_FAILURE() << "was not refused";
            } catch (const MachineError& error) {
                EXPECT_NE(std::string(error.what()).find("VK_KHR_ray_query"), std::string::npos) << error.what();
            }
            EXPECT_THROW(device->build_boxes(device->create_buffer(24, "boxes"), 1), MachineError);
            continue;
        }
        for (const char* rays : {"on", "off"}) {
            options.settings["ray_query"] = rays;
            const auto device = create_device(info.backend, options);
            const size_t on = bytes(*device, "bvh:ray_query=on"), off = bytes(*device, "bvh:ray_query=off");
            EXPECT_NE(on, off);
            EXPECT_EQ(bytes(*device, "bvh"), std::string(rays) == "on" ? on : off);
        }
    }
}

TEST(PhotonMap, UnknownNamesAndParametersAreBadInput) {
    EXPECT_THROW(create_photon_map("sorted_gird"), InputError);
    EXPECT_THROW(create_photon_map("sorted_grid:cells=2"), InputError);
    EXPECT_THROW(create_photon_map("stochastic_hash:selection=lottery"), InputError);
    const auto device = create_device("cpu");
    EXPECT_THROW(create_photon_map("stochastic_hash:selection=race,slots=2")->open(*device), InputError);
    const auto map = create_photon_map("stochastic_hash:selection=flux");
    EXPECT_EQ(show_photon_map("stochastic_hash", *map)[0], (std::pair<std::string, std::string>("selection", "flux")));
}

// The direction after unpacking has a smaller error than photon.h states, and is exact on the axes.
TEST(PhotonMap, PackedDirectionsKeepTheirPromise) {
    std::mt19937 random(1);
    std::normal_distribution<float> normal;
    double worst = 0;
    for (int i = 0; i < 1'000'000; ++i) {
        glm::dvec3 d(normal(random), normal(random), normal(random));
        d = glm::normalize(d);
        const glm::dvec3 back(direction_of(make_photon({}, glm::vec3(d), {}, 0)));
        worst = std::max(worst, glm::length(glm::cross(d, back)));
        ASSERT_GT(glm::dot(d, back), 0);
    }
    EXPECT_LT(worst, 7e-5);
    EXPECT_GT(worst, 1e-5);
    for (int axis = 0; axis < 3; ++axis) {
        for (const float sign : {-1.0f, 1.0f}) {
            glm::vec3 d(0.0f);
            d[axis] = sign;
            EXPECT_EQ(direction_of(make_photon({}, d, {}, 0)), d);
        }
    }
}

}  // namespace
}  // namespace lampyris
