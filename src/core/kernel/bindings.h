// Declares the scene's buffers for all kernels, under the names of scene_buffers.h.
#ifndef LAMPYRIS_KERNEL_BINDINGS
#define LAMPYRIS_KERNEL_BINDINGS

SCENE_RO(BINDING_RECORD, SceneRecord, scene)
// HAS says what this build of a kernel supports, CALLED_FOR what the scene needs: use it for decisions that change how
// much work is done at every hit. On Vulkan both are the same; on the CPU a build may support more effects than its
// scene needs.
#define CALLED_FOR(effect) \
    (HAS(effect) &&        \
     ((scene[0].effects_low & EFFECTS_LOW(effect)) | (scene[0].effects_high & EFFECTS_HIGH(effect))) != 0u)

#define LAMPYRIS_BIND_ARRAY(binding_, T, name, what) SCENE_RO(binding_, T, name)
LAMPYRIS_SCENE_ARRAYS(LAMPYRIS_BIND_ARRAY)
#undef LAMPYRIS_BIND_ARRAY
SCENE_RO_PAIRS(BINDING_BVH_NODES, bvh_nodes)  // two per node: the left child's box, the right one's (BvhNode)
SCENE_RO(BINDING_BVH_TRIANGLES, vec4, bvh_triangles)

#endif
