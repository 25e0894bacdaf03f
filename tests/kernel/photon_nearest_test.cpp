// The nearest photons, on every backend: each structure that passes on all photons in range finds the same ones as a sort on
// the host, in the same order, and the density computed from them is unbiased.
#include "core/photons/photon_map.h"
#include "support/device_run.h"
#include "support/photon_sets.h"
#include "support/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace lampyris {
namespace {

using namespace test;

constexpr const char* kNearest = "accel/photons/collect/collect_nearest.consumer.h";

struct Found {
    uint32_t count = 0, checksum = 0;  // of the keys, in order
    float disk = 0;                    // squared radius
    bool operator==(const Found&) const = default;
};

std::vector<std::string> nearest_maps() {
    std::vector<std::string> names = exact_photon_maps();
    names.emplace_back("brute_force");
    names.emplace_back("bvh:leaf=1");
    std::erase_if(names, [](const std::string& name) { return create_photon_map(name)->capabilities().sums_only; });
    return names;
}

std::vector<CollectResult> gather_nearest(Device& device, PhotonMap& map, const PhotonSet& set, uint32_t photons) {
    const BufferHandle results = device.create_buffer(size_t(set.query_count) * sizeof(CollectResult), "results");
    const BufferHandle wanted = device.create_buffer(sizeof(glm::uvec4), "wanted");
    const glm::uvec4 record(photons, 0, 0, 0);
    wanted->upload(&record, sizeof record);
    map.build(set);
    map.gather({kNearest, 0, nullptr, {{"results", results}, {"wanted", wanted}}}, set.queries, 0, set.query_count);
    return download<CollectResult>(results, set.query_count);
}

Found of_result(const CollectResult& result) { return {result.found.x, result.found.y, result.sum.y}; }

// core/kernel/nearest.h defines what is found; this finds it by sorting everything.
Found by_sorting(const PhotonCase& photon_case, glm::vec4 query, uint32_t wanted) {
    Found found;
    const float radius = query.w;
    found.disk = std::max(radius * radius, 1e-37f);
    std::vector<std::pair<float, uint32_t>> all;
    for (const kernel::PhotonRecord& photon : photon_case.photons) {
        const glm::vec3 p(std::bit_cast<float>(photon.place.x), std::bit_cast<float>(photon.place.y),
                          std::bit_cast<float>(photon.place.z));
        const glm::vec3 d = p - glm::vec3(query);
        const float d2 = d.x * d.x + d.y * d.y + d.z * d.z;
        if (d2 <= found.disk) all.emplace_back(d2, photon.place.w);
    }
    const size_t sorted = std::min<size_t>(all.size(), wanted + 1);
    std::partial_sort(all.begin(), all.begin() + std::ptrdiff_t(sorted), all.end());
    found.count = uint32_t(std::min<size_t>(all.size(), wanted));
    if (all.size() > wanted) found.disk = std::max(all[wanted].first, 1e-37f);
    for (uint32_t i = 0; i < found.count; ++i) found.checksum = 31u * found.checksum + all[i].second;
    return found;
}

// Ties, coincident photons and photons without a neighbour included. Squares that underflow are excluded, because the host
// keeps them.
TEST(PhotonNearest, AreThoseThatASortFinds) {
    std::vector<PhotonCase> cases;
    for (const std::string& name : photon_case_names()) {
        if (name == "underflowing_radius") continue;
        cases.push_back(make_photon_case(name, 3000, 300));
        for (glm::vec4& query : cases.back().queries) query.w *= 3.0f;
        cases.back().radius *= 3.0f;
    }
    cases.push_back(make_photon_case("random", 2, 50));
    for (const uint32_t wanted : {1u, 20u, 256u}) {
        std::vector<std::vector<Found>> expected;
        size_t full = 0, not_full = 0;
        for (const PhotonCase& photon_case : cases) {
            std::vector<Found>& of_case = expected.emplace_back();
            for (const glm::vec4& query : photon_case.queries) {
                of_case.push_back(query.w >= 0 ? by_sorting(photon_case, query, wanted) : Found{});
                (of_case.back().count == wanted ? full : not_full) += 1;
            }
        }
        EXPECT_GT(full, 100u);
        EXPECT_GT(not_full, 100u);
        for (const std::string& backend : kernel_backends()) {
            if (backend != "cpu" && wanted != 20u) continue;  // kernels are the same ones for any number
            const auto device = create_device(backend);
            for (const std::string& choice : nearest_maps()) {
                const auto map = create_photon_map(choice);
                if (!can_run(*device, *map)) continue;
                map->open(*device);
                for (size_t c = 0; c < cases.size(); ++c) {
                    SCOPED_TRACE(backend + " " + choice + " " + cases[c].name + " " + std::to_string(wanted));
                    const auto results = gather_nearest(*device, *map, upload_case(*device, cases[c]), wanted);
                    size_t wrong = 0;
                    for (size_t i = 0; i < results.size(); ++i)
                        wrong += cases[c].queries[i].w >= 0 && !(of_result(results[i]) == expected[c][i]);
                    EXPECT_EQ(wrong, 0u) << "of " << results.size();
                }
            }
        }
    }
}

// Structures that claim to stop early do: of 20,000 photons in range, they pass on only a few leaves.
TEST(PhotonNearest, StructuresThatStopEarlyHandOverFew) {
    const PhotonCase photon_case = make_photon_case("all_in_range", 20'000, 200);
    size_t tested = 0;
    for (const std::string& backend : kernel_backends()) {
        const auto device = create_device(backend);
        for (const std::string& name : photon_maps().names()) {
            const auto map = create_photon_map(name);
            if (!map->capabilities().k_nearest) continue;
            map->open(*device);
            double handed = 0.0;
            size_t queries = 0;
            for (const CollectResult& result : gather_nearest(*device, *map, upload_case(*device, photon_case), 50)) {
                if (result.found.x < 50) continue;
                handed += double(result.sum.z);
                ++queries;
            }
            ASSERT_GT(queries, 100u);
            EXPECT_LT(handed / double(queries), 1000.0) << name;
            ++tested;
        }
    }
    EXPECT_GT(tested, 0u);
}

// The density over the disk is unbiased, whether the query's radius or the next photon ends it. Squares of 100 photons each,
// far apart, with one query: false alarms 1e-6 per test. Counting the photon at the rim, too, would add 1/k: more than five
// standard errors.
TEST(PhotonNearest, DensityIsUnbiased) {
    constexpr uint32_t kSquares = 8000, kPhotons = 100;
    PhotonCase photon_case;
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(-0.5f, 0.5f);
    for (uint32_t i = 0; i < kSquares; ++i) {
        const glm::vec3 centre(float(i % 100) * 2.0f, float(i / 100) * 2.0f, 0.0f);
        for (uint32_t k = 0; k < kPhotons; ++k) {
            const float x = uniform(random), y = uniform(random);
            photon_case.photons.push_back(
                make_photon(centre + glm::vec3(x, y, 0), glm::vec3(0, 0, 1), glm::vec3(1), i * kPhotons + k));
        }
        photon_case.queries.emplace_back(centre, 0.0f);
    }
    photon_case.low = glm::vec3(-1, -1, 0);
    photon_case.high = glm::vec3(200, 161, 0);
    const auto device = create_device("cpu");
    const auto map = create_photon_map("bvh");
    map->open(*device);
    // 79, 20 and 10 photons in range on average.
    for (const float radius : {0.5f, 0.25f, 0.18f}) {
        for (const uint32_t wanted : {10u, 20u}) {
            SCOPED_TRACE(std::to_string(radius) + " " + std::to_string(wanted));
            photon_case.radius = radius;
            for (glm::vec4& query : photon_case.queries) query.w = radius;
            Mean density, with_the_last;
            size_t full = 0;
            for (const CollectResult& result :
                 gather_nearest(*device, *map, upload_case(*device, photon_case), wanted)) {
                const double area = M_PI * double(result.sum.y);
                // A disk wider than the square would have a different expectation; there is none.
                ASSERT_LE(result.sum.y, 0.25f);
                const bool rim = result.sum.y < radius * radius;
                full += rim;
                density.add(double(result.found.x) / area);
                with_the_last.add(double(result.found.x + rim) / area);
            }
            EXPECT_LT(std::abs(density.value() - kPhotons), normal_threshold(1e-6) * density.error());
            if (full > kSquares / 2) {
                EXPECT_GT(with_the_last.value() - kPhotons, 5.0 * with_the_last.error());
            }
        }
    }
}

}  // namespace
}  // namespace lampyris
