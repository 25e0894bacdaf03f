#include "core/scene/scene_buffers.h"

#include <type_traits>

namespace lampyris {

std::vector<SceneBuffer> scene_buffers(const Scene& scene) {
    using namespace kernel;
    std::vector<SceneBuffer> buffers{{BINDING_RECORD, &scene.record, sizeof scene.record, "record"}};
#define LAMPYRIS_ADD_ARRAY(binding, T, name, what)                                                                    \
    static_assert(std::is_same_v<decltype(scene.name), std::vector<T>>, "the scene's array and the kernels' differ"); \
    buffers.push_back(scene_buffer(binding, scene.name, what));
    LAMPYRIS_SCENE_ARRAYS(LAMPYRIS_ADD_ARRAY)
#undef LAMPYRIS_ADD_ARRAY
    return buffers;
}

}  // namespace lampyris
