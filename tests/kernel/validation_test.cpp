// The Khronos validation layers check the Vulkan backend at work, and report nothing; and they are really active.
#include "backends/vulkan/validation.h"
#include "core/base/error.h"
#include "core/device/device.h"
#include "core/scene/scene.h"
#include "support/photon_sets.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lampyris {
namespace {

std::unique_ptr<Device> validated(std::map<std::string, std::string> settings) {
    settings["validation"] = "on";
    settings["cache"] = "off";
    DeviceOptions options;
    options.settings = std::move(settings);
    return create_device("vulkan", options);
}

// Settings under which everything must be clean: mapped and staged memory, and ray query where the device offers it.
std::vector<std::map<std::string, std::string>> variants() {
    std::vector<std::map<std::string, std::string>> result;
    for (const DeviceInfo& info : list_devices()) {
        if (info.backend != "vulkan" || info.index != 0) continue;
        result.push_back({{"ray_query", "off"}});
        result.push_back({{"ray_query", "off"}, {"wide_reads", "off"}, {"staging", "on"}});
        result.push_back({{"ray_query", "off"}, {"max_binding", "16"}});  // all buffers but the smallest by address
        if (info.features.at("ray_query") == "yes") result.push_back({{"ray_query", "on"}, {"staging", "on"}});
    }
    return result;
}

// Two triangles and an instance of them: enough for every kind of acceleration structure but boxes.
Scene small_scene() {
    Scene scene;
    const kernel::TransformRecord identity{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0},
                                           {1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    scene.positions = {0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 2, 0, 0, 0, 0};
    scene.indices = {0, 1, 2, 1, 3, 2};
    for (uint32_t g = 0; g < 2; ++g) {
        kernel::GeometryRecord geometry{};
        geometry.kind = kernel::GEOMETRY_TRIANGLES;
        geometry.first_light = geometry.alpha_texture = kernel::NONE;
        geometry.primitive_count = 2;
        scene.geometries.push_back(geometry);
        scene.sets.push_back({g, 1});
        scene.instances.push_back({identity, g, 1, 0, 0});
        scene.instance_sets.push_back(g);
    }
    scene.effects.ask(kernel::EFFECT_INSTANCES, "test");
    return scene;
}

TEST(Validation, LayersAreLoadedAndSeeAWrongCall) {
    if (variants().empty()) GTEST_SKIP() << "no Vulkan device";
    const auto device = validated({});
    const auto messages = vulkan::provoke_validation_message(*device);
    ASSERT_FALSE(messages.empty()) << "the layers said nothing to a buffer of size 0";
    EXPECT_NE(messages[0].find("VUID-VkBufferCreateInfo-size-00912"), std::string::npos) << messages[0];
    EXPECT_TRUE(vulkan::provoke_validation_message(*create_device("vulkan")).empty())
        << "validation is off unless asked for";
}

// Device throws if a layer complains, so no exception means no complaint.
TEST(Validation, KernelsRunWithoutAMessage) {
    for (const auto& settings : variants()) {
        for (const auto& [key, value] : settings) SCOPED_TRACE(key + "=" + value);
        const Scene scene = small_scene();
        const auto device = validated(settings);
        const auto work = [&] {
            const auto on_device = device->upload(scene);
            const auto kernel = device->compile("kernel/trace_probe.kernel.h", scene.effects.mask());
            const auto rays = device->create_buffer(1000 * 32, "rays"), hits = device->create_buffer(1000 * 16, "hits");
            std::vector<glm::vec4> data;
            for (int i = 0; i < 1000; ++i) {
                data.emplace_back(0.001f * float(i), 0.25f, 0.0f, 1e30f);
                data.emplace_back(0.0f, 0.0f, 1.0f, 0.0f);
            }
            rays->upload(data.data(), rays->size());
            const NamedBuffer buffers[] = {{"rays", rays}, {"hits", hits}};
            device->run(*kernel, on_device.get(), buffers, 0, 1000);
            device->run(*kernel, on_device.get(), buffers, 0, 500);
            std::vector<glm::uvec4> found(1000);
            hits->download(found.data(), hits->size());
            EXPECT_NE(found[100].y, kernel::NONE);
            hits->fill_zero();
            // A second kernel, without a scene.
            const auto square = device->compile("kernel/device_square.kernel.h", 0);
            const auto counter = device->create_buffer(4, "counter");
            const NamedBuffer more[] = {{"inputs", rays}, {"results", hits}, {"counters", counter}};
            device->run(*square, nullptr, more, 3, 100);
            // Structures over boxes that a kernel wrote: built, traversed, and built again, larger and smaller.
            if (!device->offers(DeviceFeature::kBoxes)) return;
            const auto map = create_photon_map("bvh:ray_query=on");
            map->open(*device);
            for (const uint32_t photons : {1000u, 3000u, 0u, 500u}) {
                PhotonSet set = test::upload_case(*device, test::make_photon_case("random", 3000, 100));
                set.count = photons;
                const auto results = test::collect(*device, *map, set);
                EXPECT_EQ(photons == 0, std::all_of(results.begin(), results.end(),
                                                    [](const auto& result) { return result.found.x == 0; }));
            }
        };
        ASSERT_NO_THROW(work());
        EXPECT_FALSE(vulkan::provoke_validation_message(*device).empty()) << "the layers slept";
    }
}

}  // namespace
}  // namespace lampyris
