// The scene's buffers (set 0), bound once for all kernels. The host's list of them is SceneBuffer in core/scene/scene.h.
#ifndef LAMPYRIS_KERNEL_BINDINGS
#define LAMPYRIS_KERNEL_BINDINGS

SCENE_RO(0, SceneRecord, scene)
// HAS says what this build of a kernel can do, CALLED_FOR what the scene asks of it: for decisions that change how much work is
// done at every hit. On Vulkan both are the same; on the CPU a build may know more effects than its scene has.
#define CALLED_FOR(effect) \
    (HAS(effect) &&        \
     ((scene[0].effects_low & EFFECTS_LOW(effect)) | (scene[0].effects_high & EFFECTS_HIGH(effect))) != 0u)

SCENE_RO(1, GeometryRecord, geometries)
SCENE_RO(2, uint, indices)
SCENE_RO(3, float, positions)
SCENE_RO(4, float, normals)
SCENE_RO(5, float, uvs)
SCENE_RO(6, TransformRecord, transforms)
SCENE_RO(7, InstanceRecord, instances)
SCENE_RO(8, MaterialRecord, materials)
SCENE_RO(9, TextureOp, texture_ops)
SCENE_RO(10, ImageRecord, images)
SCENE_RO(11, uint, texels)
SCENE_RO(12, LightRecord, lights)
SCENE_RO(13, uint, distributions)
SCENE_RO_PAIRS(14, bvh_nodes)  // two a node: the left child's box, the right one's (BvhNode)
SCENE_RO(15, vec4, bvh_triangles)
// 16 and 17 are the Vulkan backend's (its acceleration structure, and the flag of REPORT_UNFINISHED).
SCENE_RO(18, MediumRecord, media)

#endif
