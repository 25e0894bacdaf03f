// --device: a number is an index, whatever digits the names contain.
#include "core/device/device_choice.h"

#include "core/base/error.h"

#include <gtest/gtest.h>

#include <vector>

namespace lampyris {
namespace {

std::string refused(const std::vector<std::string>& names, const std::string& wish) {
    try {
        choose_device(names, wish, "Vulkan");
    } catch (const MachineError& error) {
        return error.what();
    }
    return "nothing";
}

TEST(DeviceChoice, TakesNumbersAsNumbers) {
    const std::vector<std::string> names{"llvmpipe (LLVM 15.0.6, 256 bits)", "GPU 0", "GPU 2"};
    EXPECT_EQ(choose_device(names, "", "Vulkan"), 0u);
    EXPECT_EQ(choose_device(names, "0", "Vulkan"), 0u);  // not "GPU 0"
    EXPECT_EQ(choose_device(names, "1", "Vulkan"), 1u);  // not "LLVM 15"
    EXPECT_EQ(choose_device(names, "2", "Vulkan"), 2u);
    EXPECT_EQ(choose_device(names, "GPU", "Vulkan"), 1u);
    EXPECT_EQ(choose_device(names, "gpu 2", "Vulkan"), 2u);
    EXPECT_EQ(choose_device(names, "LLVM", "Vulkan"), 0u);
}

TEST(DeviceChoice, ListsTheDevicesWhereNoneIsMeant) {
    const std::vector<std::string> one{"llvmpipe (LLVM 15.0.6, 256 bits)"};
    const std::string is = "Vulkan has no such device; it has 0 llvmpipe (LLVM 15.0.6, 256 bits)";
    EXPECT_EQ(refused(one, "1"), "error: --device 1: " + is);
    EXPECT_EQ(refused(one, "15"), "error: --device 15: " + is);
    EXPECT_EQ(refused(one, "99999999999999999999"), "error: --device 99999999999999999999: " + is);
    EXPECT_EQ(refused(one, "-1"), "error: --device -1: " + is);
    EXPECT_EQ(refused({"a", "b"}, "c"), "error: --device c: Vulkan has no such device; it has 0 a, 1 b");
}

}  // namespace
}  // namespace lampyris
