// The guarantees of a device, on every backend: buffers, ranges of indices, errors of unfinished kernels, and, for Vulkan, the
// cache of compiled kernels.
#include "core/base/error.h"
#include "core/device/device.h"
#include "core/device/kernel_types.h"
#include "support/backends.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numeric>

namespace lampyris {
namespace {

using test::usable_backends;

DeviceOptions with(std::map<std::string, std::string> settings) {
    DeviceOptions options;
    options.settings = std::move(settings);
    return options;
}

bool has_vulkan() {
    const auto names = usable_backends();
    return std::find(names.begin(), names.end(), "vulkan") != names.end();
}

TEST(Device, BuffersKeepWhatIsUploaded) {
    for (const std::string& backend : usable_backends()) {
        SCOPED_TRACE(backend);
        for (const bool staging : {false, true}) {
            if (staging && backend != "vulkan") continue;
            const auto device = create_device(backend, staging ? with({{"staging", "on"}}) : DeviceOptions());
            std::vector<uint32_t> data(5'000'003),
                back(data.size());  // more than one piece of staging, and not a multiple of it
            std::iota(data.begin(), data.end(), 7u);
            const auto buffer = device->create_buffer(data.size() * 4, "data");
            EXPECT_EQ(buffer->size(), data.size() * 4);
            buffer->download(back.data(), buffer->size());
            EXPECT_TRUE(std::all_of(back.begin(), back.end(), [](uint32_t x) { return x == 0; }))
                << "new buffers are zero";
            buffer->upload(data.data(), buffer->size());
            buffer->download(back.data(), buffer->size());
            EXPECT_EQ(back, data);
            uint32_t part[2] = {1, 2};
            buffer->upload(part, 8, 400);
            buffer->download(part, 8, 396);
            EXPECT_EQ(part[0], data[99]);
            EXPECT_EQ(part[1], 1u);
            buffer->fill_zero();
            buffer->download(back.data(), buffer->size());
            EXPECT_EQ(*std::max_element(back.begin(), back.end()), 0u);
        }
    }
}

TEST(Device, RunsEveryIndexOfARangeOnce) {
    for (const std::string& backend : usable_backends()) {
        SCOPED_TRACE(backend);
        const auto device = create_device(backend);
        constexpr uint32_t kSize = 300'000;
        std::vector<float> inputs(kSize), results(kSize);
        for (uint32_t i = 0; i < kSize; ++i) inputs[i] = float(i % 1000);
        const auto in = device->create_buffer(kSize * 4, "inputs"), out = device->create_buffer(kSize * 4, "results");
        const auto counter = device->create_buffer(4, "counter");
        in->upload(inputs.data(), kSize * 4);
        const auto kernel = device->compile("kernel/device_square.kernel.h", 0);
        const NamedBuffer buffers[] = {{"inputs", in}, {"results", out}, {"counters", counter}};
        uint32_t expected = 0;
        for (const auto& [begin, count] :
             {std::pair{0u, 1u}, {17u, 1000u}, {1017u, 250'000u}, {299'999u, 1u}, {5u, 0u}}) {
            out->fill_zero();
            device->run(*kernel, nullptr, buffers, begin, count);
            expected += count;
            out->download(results.data(), kSize * 4);
            for (uint32_t i = 0; i < kSize; ++i) {
                const bool inside = i >= begin && i < begin + count;
                ASSERT_EQ(results[i], inside ? inputs[i] * inputs[i] + float(i) : 0.0f)
                    << "index " << i << " of [" << begin << ", +" << count << ")";
            }
        }
        uint32_t counted = 0;
        counter->download(&counted, 4);
        EXPECT_EQ(counted, expected);
        EXPECT_GT(device->statistics().kernel_s.at("kernel/device_square.kernel.h"), 0.0);
        EXPECT_GE(device->statistics().peak_memory_bytes, 2u * kSize * 4);
    }
}

TEST(Device, ChecksBuffersByName) {
    for (const std::string& backend : usable_backends()) {
        SCOPED_TRACE(backend);
        const auto device = create_device(backend);
        const float inputs[4] = {2, 3, 4, 5};
        const auto in = device->create_buffer(16, "a"), out = device->create_buffer(16, "b"),
                   counter = device->create_buffer(4, "c"), small = device->create_buffer(2, "d");
        in->upload(inputs, 16);
        const auto kernel = device->compile("kernel/device_square.kernel.h", 0);
        const auto message = [&](std::vector<NamedBuffer> given) -> std::string {
            try {
                device->run(*kernel, nullptr, given, 0, 4);
            } catch (const std::logic_error& error) {
                return error.what();
            }
            return "";
        };
        // The order does not matter.
        EXPECT_EQ(message({{"results", out}, {"counters", counter}, {"inputs", in}}), "");
        float results[4];
        out->download(results, 16);
        EXPECT_EQ(results[2], 18.0f);
        const std::string end = "; it declares inputs, results, counters";
        const std::string start = "kernel kernel/device_square.kernel.h: ";
        EXPECT_EQ(message({{"inputs", in}, {"results", out}}), start + "it was not given \"counters\"" + end);
        EXPECT_EQ(message({{"inputs", in}, {"results", nullptr}, {"counters", counter}}),
                  start + "it was not given \"results\"" + end);
        EXPECT_EQ(message({{"inputs", in}, {"results", out}, {"counters", counter}, {"result", out}}),
                  start + "it was given \"result\"" + end);
        EXPECT_EQ(message({{"inputs", in}, {"results", out}, {"counters", counter}, {"inputs", out}}),
                  start + "it was given \"inputs\" twice" + end);
        EXPECT_EQ(message({{"inputs", in}, {"results", out}, {"counters", small}}),
                  start + "\"counters\" has 2 bytes, and one element takes 4" + end);
    }
}

TEST(Device, UnfinishedLoopIsAnErrorAndTheDeviceLivesOn) {
    for (const std::string& backend : usable_backends()) {
        SCOPED_TRACE(backend);
        const auto device = create_device(backend);
        const auto limits = device->create_buffer(400, "limits"), sums = device->create_buffer(400, "sums");
        std::vector<uint32_t> data(100, 10u);
        limits->upload(data.data(), 400);
        const auto kernel = device->compile("kernel/device_loop.kernel.h", 0);
        const NamedBuffer buffers[] = {{"limits", limits}, {"sums", sums}};
        EXPECT_NO_THROW(device->run(*kernel, nullptr, buffers, 0, 100));
        data[57] = 1001;
        limits->upload(data.data(), 400);
        try {
            device->run(*kernel, nullptr, buffers, 0, 100);
            FAIL() << "an unfinished loop went unnoticed";
        } catch (const MachineError& error) {
            EXPECT_NE(std::string(error.what()).find("kernel/device_loop.kernel.h"), std::string::npos) << error.what();
        }
        data[57] = 10;
        limits->upload(data.data(), 400);
        EXPECT_NO_THROW(device->run(*kernel, nullptr, buffers, 0, 100)) << "the flag must not stick";
    }
}

TEST(Device, MemoryLimitIsAnErrorThatNamesTheBuffer) {
    for (const std::string& backend : usable_backends()) {
        SCOPED_TRACE(backend);
        DeviceOptions options;
        options.max_memory = 1 << 20;
        const auto device = create_device(backend, options);
        const auto fits = device->create_buffer(1 << 19, "half of it");
        try {
            device->create_buffer(1 << 20, "the film");
            FAIL() << "the limit was passed";
        } catch (const MachineError& error) {
            EXPECT_NE(std::string(error.what()).find("the film"), std::string::npos) << error.what();
        }
    }
}

TEST(Device, UnknownBackendsAreBadInputAndTheMachineLacksUnknownDevices) {
    EXPECT_THROW(create_device("volkan"), InputError);
    DeviceOptions options;
    options.device = "no such device";
    EXPECT_THROW(create_device("cpu", options), MachineError);
    if (!has_vulkan()) GTEST_SKIP() << "no Vulkan device";
    EXPECT_THROW(create_device("vulkan", options), MachineError);
    EXPECT_THROW(create_device("vulkan", with({{"precise", "perhaps"}})), InputError);
    EXPECT_THROW(create_device("vulkan", with({{"ray_qeury", "on"}})), InputError);
    options.device = "0";
    EXPECT_NO_THROW(create_device("vulkan", options));
}

class ShaderCacheTest : public testing::Test {
 protected:
    void SetUp() override {
        if (!has_vulkan()) GTEST_SKIP() << "no Vulkan device";
    }
    // Compiles and runs on a new device; returns results[3].
    float run(uint64_t effects = 0) {
        const auto device = create_device("vulkan", with({{"cache", folder_.string()}}));
        const auto kernel = device->compile("kernel/device_effects.kernel.h", effects);
        spirv_bytes_ = device->statistics().spirv_bytes.at("kernel/device_effects.kernel.h");
        const auto out = device->create_buffer(64, "results");
        const NamedBuffer buffers[] = {{"results", out}};
        device->run(*kernel, nullptr, buffers, 0, 16);
        float values[16];
        out->download(values, 64);
        return values[3];
    }
    std::vector<std::filesystem::path> entries() const {
        std::vector<std::filesystem::path> found;
        for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) found.push_back(entry.path());
        return found;
    }
    const test::TemporaryFolder folder_;
    size_t spirv_bytes_ = 0;
};

TEST_F(ShaderCacheTest, SecondCompileHitsTheCache) {
    EXPECT_EQ(run(), 3.0f);
    ASSERT_EQ(entries().size(), 1u) << "one entry, no temporary file";
    const auto written = std::filesystem::last_write_time(entries()[0]);
    EXPECT_EQ(run(), 3.0f);
    EXPECT_EQ(entries().size(), 1u);
    EXPECT_EQ(std::filesystem::last_write_time(entries()[0]), written) << "it was made again";
}

TEST_F(ShaderCacheTest, DamagedEntryIsMadeAgain) {
    EXPECT_EQ(run(), 3.0f);
    const auto entry = entries().at(0);
    const auto size = std::filesystem::file_size(entry);
    std::string good(size, 0);
    std::ifstream(entry, std::ios::binary).read(good.data(), std::streamsize(size));
    for (const int damage : {0, 1, 2, 3}) {
        std::string bad = good;
        if (damage == 0) bad[size / 2] = char(bad[size / 2] ^ 0x10);
        if (damage == 1) bad.resize(size / 2);
        if (damage == 2) bad.clear();
        if (damage == 3) bad += "more";
        std::ofstream(entry, std::ios::binary | std::ios::trunc) << bad;
        EXPECT_EQ(run(), 3.0f) << "damage " << damage;
        std::string again(size, 0);
        EXPECT_EQ(std::filesystem::file_size(entry), size);
        std::ifstream(entry, std::ios::binary).read(again.data(), std::streamsize(size));
        EXPECT_EQ(again, good) << "damage " << damage;
    }
}

TEST_F(ShaderCacheTest, AnotherKernelsEntryIsNotTaken) {
    EXPECT_EQ(run(), 3.0f);
    const auto entry = entries().at(0);
    const size_t bytes = spirv_bytes_;
    EXPECT_NE(run(kernel::EFFECT_LAYERED_COAT), 0.0f);
    ASSERT_NE(spirv_bytes_, bytes);
    for (const auto& other : entries())
        if (other != entry) std::filesystem::copy_file(other, entry, std::filesystem::copy_options::overwrite_existing);
    EXPECT_EQ(run(), 3.0f);
    EXPECT_EQ(spirv_bytes_, bytes);
}

TEST_F(ShaderCacheTest, WhatIsNoFileIsLeftAlone) {
    EXPECT_EQ(run(), 3.0f);
    const auto entry = entries().at(0);
    for (const bool is_pipe : {true, false}) {
        std::filesystem::remove(entry);
        ASSERT_TRUE(is_pipe ? mkfifo(entry.c_str(), 0600) == 0 : std::filesystem::create_directory(entry));
        EXPECT_EQ(run(), 3.0f);
        EXPECT_EQ(entries().size(), 1u);
        EXPECT_EQ(std::filesystem::is_fifo(entry), is_pipe);
    }
}

TEST_F(ShaderCacheTest, EffectsOutsideTheMaskVanish) {
    run();
    const size_t without = spirv_bytes_;
    run(kernel::EFFECT_LAYERED_COAT);
    EXPECT_GT(spirv_bytes_, 2 * without) << "the effect's code is in the kernel that did not ask for it";
    EXPECT_EQ(entries().size(), 2u);
}

}  // namespace
}  // namespace lampyris
