// Messages of the Khronos validation layers about our calls (--set backend.validation=on).
#pragma once

#include <mutex>
#include <string>
#include <vector>

namespace lampyris {
class Device;
}

namespace lampyris::vulkan {

// Collects the layers' warnings and errors.
class ValidationLog {
 public:
    void add(std::string message);
    std::vector<std::string> take();  // returns the messages, and forgets them
    bool empty() const;

 private:
    mutable std::mutex mutex_;
    std::vector<std::string> messages_;
};

// Makes a deliberately wrong call on a Vulkan device with validation, and returns the layers' messages about it, as proof that
// the layers are loaded. Empty if they are not.
std::vector<std::string> provoke_validation_message(Device& device);

}  // namespace lampyris::vulkan
