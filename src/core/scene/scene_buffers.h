// A scene's buffers as backends hand them to kernels, from the one list in core/kernel/scene_buffers.h.
#pragma once

#include "core/scene/scene.h"

#include <cstddef>
#include <vector>

namespace lampyris {

struct SceneBuffer {
    uint32_t binding = 0;  // of set 0
    const void* data = nullptr;
    size_t bytes = 0;
    const char* name = "";  // for messages
};

template <typename T>
SceneBuffer scene_buffer(uint32_t binding, const std::vector<T>& array, const char* name) {
    return {binding, array.data(), array.size() * sizeof(T), name};
}

// All buffers but those of a BVH. They point into the scene.
std::vector<SceneBuffer> scene_buffers(const Scene& scene);

}  // namespace lampyris
