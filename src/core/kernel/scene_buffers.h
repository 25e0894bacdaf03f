// The scene's buffers (set 0): kernels bind them (bindings.h), the host fills them (core/scene/scene_buffers.h).
#ifndef LAMPYRIS_KERNEL_SCENE_BUFFERS
#define LAMPYRIS_KERNEL_SCENE_BUFFERS

// ARRAY(binding, type, name, name in messages): kernels read name[i]; the host's array is the member of Scene with that
// name.
#define LAMPYRIS_SCENE_ARRAYS(ARRAY)                    \
    ARRAY(1, GeometryRecord, geometries, "geometries")  \
    ARRAY(2, uint, indices, "indices")                  \
    ARRAY(3, float, positions, "positions")             \
    ARRAY(4, float, normals, "normals")                 \
    ARRAY(5, float, uvs, "texture coordinates")         \
    ARRAY(6, TransformRecord, transforms, "transforms") \
    ARRAY(7, InstanceRecord, instances, "instances")    \
    ARRAY(8, MaterialRecord, materials, "materials")    \
    ARRAY(9, TextureOp, texture_ops, "textures")        \
    ARRAY(10, ImageRecord, images, "images")            \
    ARRAY(11, uint, texels, "texels")                   \
    ARRAY(12, LightRecord, lights, "lights")            \
    ARRAY(13, uint, distributions, "distributions")     \
    ARRAY(18, MediumRecord, media, "media")             \
    ARRAY(20, LightNode, light_nodes, "tree of lights")

// Bindings that need more than an upload of an array of Scene.
CONST uint BINDING_RECORD = 0u;      // SceneRecord
CONST uint BINDING_INSTANCES = 7u;   // an array of Scene, in which a BVH writes its root nodes
CONST uint BINDING_BVH_NODES = 14u;  // of the BVH2, which kernels traverse themselves
CONST uint BINDING_BVH_TRIANGLES = 15u;
CONST uint BINDING_TOP_LEVEL = 16u;   // Vulkan's acceleration structure, for ray queries
CONST uint BINDING_UNFINISHED = 17u;  // Vulkan's flag of REPORT_UNFINISHED
CONST uint BINDING_PATH_LOG = 19u;    // path_log.h; a device binds it (Device::set_path_log)
CONST uint SCENE_BINDINGS = 21u;

#endif
