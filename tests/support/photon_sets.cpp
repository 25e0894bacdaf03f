#include "support/photon_sets.h"

#include "support/device_run.h"

#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace lampyris::test {
namespace {

using Random = std::mt19937;

float uniform(Random& random, float low = 0, float high = 1) {
    return std::uniform_real_distribution<float>(low, high)(random);
}
glm::vec3 in_box(Random& random, float low = 0, float high = 1) {
    const float x = uniform(random, low, high), y = uniform(random, low, high);
    return {x, y, uniform(random, low, high)};
}

struct Shape {
    const char* name;
    glm::vec3 (*point)(Random&);
    float radius;  // at 10^4 points; with n of them times (10^4 / n)^(1 / dimension)
    float dimension;
};

// A query of about ten photons, if possible.
constexpr Shape kShapes[] = {
    {"random", [](Random& r) { return in_box(r); }, 0.06f, 3},
    {"clustered",
     [](Random& r) {
         Random centre(unsigned(r() % 10));
         std::normal_distribution<float> normal(0, 0.01f);
         const glm::vec3 c = in_box(centre);
         const float x = normal(r), y = normal(r);
         return c + glm::vec3(x, y, normal(r));
     },
     0.005f, 3},
    {"planar", [](Random& r) { return glm::vec3(uniform(r), 0.25f, uniform(r)); }, 0.018f, 2},
    {"tilted",
     [](Random& r) {
         const float u = uniform(r), v = uniform(r);
         return glm::vec3(u, v, 0.3f * u + 0.7f * v);
     },
     0.018f, 2},
    {"collinear", [](Random& r) { return glm::vec3(1, 2, 3) * uniform(r); }, 0.002f, 1},
    {"coincident", [](Random&) { return glm::vec3(0.3f, -0.2f, 7.0f); }, 0.5f, 0},
    {"few_places", [](Random& r) { return glm::vec3(float(r() % 5), float(r() % 5), float(r() % 5)); }, 1.0f, 0},
    {"negative", [](Random& r) { return in_box(r, -3, -2); }, 0.06f, 3},
    {"across_zero", [](Random& r) { return in_box(r, -0.5f, 0.5f); }, 0.06f, 3},
    {"huge", [](Random& r) { return in_box(r, 1e6f, 1.001e6f); }, 60.0f, 3},
    {"huge_extent", [](Random& r) { return in_box(r, -1e18f, 1e18f); }, 1e17f, 3},
    {"far_and_fine", [](Random& r) { return in_box(r, 1e5f, 1e5f + 1); }, 0.06f, 3},
    {"tiny_radius", [](Random& r) { return in_box(r); }, 1e-7f, 0},
    {"underflowing_radius", [](Random& r) { return in_box(r) * 1e-20f; }, 1e-21f, 0},
    {"all_in_range", [](Random& r) { return in_box(r); }, 5.0f, 0},
};

}  // namespace

std::vector<std::string> photon_case_names() {
    std::vector<std::string> names;
    for (const Shape& shape : kShapes) names.emplace_back(shape.name);
    return names;
}

PhotonCase make_photon_case(const std::string& name, uint32_t photons, uint32_t queries, uint32_t seed) {
    const Shape& shape =
        *std::find_if(std::begin(kShapes), std::end(kShapes), [&](const Shape& s) { return s.name == name; });
    Random random(seed);
    PhotonCase result;
    result.name = name;
    std::vector<uint32_t> keys(photons);
    std::iota(keys.begin(), keys.end(), 0u);
    std::shuffle(keys.begin(), keys.end(), random);
    std::vector<glm::vec3> positions(photons);
    result.low = glm::vec3(INFINITY);
    result.high = glm::vec3(-INFINITY);
    for (uint32_t i = 0; i < photons; ++i) {
        positions[i] = shape.point(random);
        result.low = glm::min(result.low, positions[i]);
        result.high = glm::max(result.high, positions[i]);
        const glm::vec3 power(uniform(random), uniform(random), uniform(random, 0, 100));
        result.photons.push_back(make_photon(positions[i], glm::vec3(0, 0, 1), power, keys[i]));
    }
    const float scale = shape.dimension > 0 ? std::pow(1e4f / float(photons), 1.0f / shape.dimension) : 1.0f;
    const float radius = shape.radius * scale;
    for (uint32_t i = 0; i < queries; ++i) {
        glm::vec3 p = positions[random() % photons];
        if (i % 2) p += radius * in_box(random, -1, 1);
        if (i % 8 == 1) p = result.low + (result.high - result.low) * in_box(random, -0.2f, 1.2f);
        float r = radius * (i % 3 ? 1.0f : uniform(random));
        if (i % 101 == 0) r = 0;
        if (i % 103 == 0) r = -1;
        result.queries.emplace_back(p, r);
    }
    result.radius = radius;
    return result;
}

PhotonSet upload_case(Device& device, const PhotonCase& photon_case) {
    PhotonSet set;
    set.photons = upload(device, photon_case.photons, "photons");
    set.count = uint32_t(photon_case.photons.size());
    set.queries = upload(device, photon_case.queries, "queries");
    set.query_count = uint32_t(photon_case.queries.size());
    set.radius = photon_case.radius;
    set.low = photon_case.low;
    set.high = photon_case.high;
    set.mean_power = 17;
    return set;
}

bool can_run(const Device& device, const PhotonMap& map) {
    return !map.capabilities().boxes || device.offers(DeviceFeature::kBoxes);
}

std::vector<CollectResult> collect(Device& device, PhotonMap& map, const PhotonSet& set) {
    const BufferHandle results = device.create_buffer(size_t(set.query_count) * sizeof(CollectResult), "results");
    const PhotonConsumer consumer{kCollect, 0, nullptr, {{"results", results}}};
    map.build(set);
    map.gather(consumer, set.queries, 0, set.query_count);
    return download<CollectResult>(results, set.query_count);
}

bool same_photons(const CollectResult& found, const CollectResult& expected, bool sums_only) {
    if (!sums_only) return found.found == expected.found;
    bool same = found.found.x == expected.found.x;
    for (int c = 0; c < 3; ++c)
        same = same &&
               std::abs(found.sum[c] - expected.sum[c]) <= 1e-6f * float(expected.found.x) * expected.sum[c] + 1e-6f;
    return same;
}

void expect_exact(const std::vector<std::string>& maps, const std::vector<PhotonCase>& cases,
                  const std::vector<std::string>& backends) {
    const auto reference = create_device("cpu");
    const auto brute = create_photon_map("brute_force");
    brute->open(*reference);
    std::vector<std::vector<CollectResult>> expected;
    for (const PhotonCase& photon_case : cases)
        expected.push_back(collect(*reference, *brute, upload_case(*reference, photon_case)));
    for (const std::string& backend : backends) {
        const auto device = create_device(backend);
        for (const std::string& choice : maps) {
            if (choice == "brute_force" && backend == "cpu") continue;
            const auto map = create_photon_map(choice);
            if (!can_run(*device, *map)) continue;
            map->open(*device);
            for (size_t c = 0; c < cases.size(); ++c) {
                SCOPED_TRACE(backend + " " + choice + " " + cases[c].name);
                std::vector<CollectResult> found;
                try {
                    found = collect(*device, *map, upload_case(*device, cases[c]));
                } catch (const MachineError& error) {
                    // Mesa before 25 ends long loops, which must be reported: thousands of coincident photons cause such loops.
                    ASSERT_NE(device->description().find("Mesa 22"), std::string::npos) << error.what();
                    ASSERT_NE(std::string(error.what()).find("could not finish a loop"), std::string::npos);
                    continue;
                }
                size_t wrong = 0;
                for (size_t i = 0; i < found.size(); ++i) {
                    if (same_photons(found[i], expected[c][i], map->capabilities().sums_only)) continue;
                    if (wrong++ == 0)
                        ADD_FAILURE() << "query " << i << " finds " << found[i].found.x << " of "
                                      << expected[c][i].found.x;
                }
                EXPECT_EQ(wrong, 0u) << "of " << found.size();
            }
        }
    }
}

std::vector<std::string> exact_photon_maps() {
    std::vector<std::string> names;
    for (const std::string& name : photon_maps().names())
        if (name != "brute_force" && create_photon_map(name)->capabilities().exact) names.push_back(name);
    names.emplace_back("bvh:ray_query=on");
    // Cells much smaller and larger than a query, a table that is full, and a tree with as many rounds as possible.
    for (const char* other :
         {"sorted_grid:cell_size=0.5,table_size=0.02", "sorted_grid:cell_size=7", "linked_list:table_size=0.02",
          "cuckoo:stash=0,table_size=1.05", "uniform_grid:capacity=1,cells=0.1", "kd_tree:leaf=4"})
        names.emplace_back(other);
    return names;
}

}  // namespace lampyris::test
