// Running test kernels with typed buffers.
#pragma once

#include "core/device/device.h"
#include "support/backends.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace lampyris::test {

// For tests that require the CPU's bits: by default, a GPU's divisions are less accurate.
inline DeviceOptions exact_options(const std::string& backend) {
    DeviceOptions options;
    if (backend == "vulkan") options.settings["exact"] = "auto";
    return options;
}

template <class T>
BufferHandle upload(Device& device, const std::vector<T>& values, const char* name) {
    BufferHandle buffer = device.create_buffer(std::max<size_t>(values.size(), 1) * sizeof(T), name);
    if (!values.empty()) buffer->upload(values.data(), values.size() * sizeof(T));
    return buffer;
}

template <class T>
std::vector<T> download(const BufferHandle& buffer, size_t count) {
    std::vector<T> values(count);
    buffer->download(values.data(), count * sizeof(T));
    return values;
}

}  // namespace lampyris::test
