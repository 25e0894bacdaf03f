// Embree's acceleration structures over a scene, and the tracer that C++ kernels call.
#pragma once

#include "core/device/kernel_registry.h"

#include <embree3/rtcore.h>

#include <memory>
#include <utility>
#include <vector>

namespace lampyris {

struct Scene;

// Owns one reference to an Embree object.
template <typename Handle, void (*release)(Handle)>
class EmbreeObject {
 public:
    EmbreeObject() = default;
    explicit EmbreeObject(Handle handle) : handle_(handle) {}
    EmbreeObject(EmbreeObject&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
    EmbreeObject& operator=(EmbreeObject&& other) noexcept {
        std::swap(handle_, other.handle_);
        return *this;
    }
    ~EmbreeObject() {
        if (handle_) release(handle_);
    }
    Handle get() const { return handle_; }

 private:
    Handle handle_ = nullptr;
};
using EmbreeDevice = EmbreeObject<RTCDevice, rtcReleaseDevice>;
using EmbreeSceneHandle = EmbreeObject<RTCScene, rtcReleaseScene>;
using EmbreeGeometry = EmbreeObject<RTCGeometry, rtcReleaseGeometry>;

// Shares the scene's vertex and index arrays (nothing is copied): the scene must outlive this. `watertight` makes Embree find
// triangles whose edge a ray meets (RTC_SCENE_FLAG_ROBUST). Throws MachineError where Embree has no memory.
class EmbreeScene {
 public:
    EmbreeScene(const Scene& scene, void* const* scene_buffers, bool watertight);
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;
    CpuTracer tracer();
    size_t memory_bytes() const { return memory_; }
    RTCScene top_scene() const { return top_.get(); }
    // Packets of eight rays, for vector kernels. `valid`: -1 for a ray, 0 where there is none.
    static const EmbreeScene* of(const CpuTracer& tracer);  // null if the tracer is another one
    float largest_ray() const { return largest_ray_; }
    // A hit's instance and geometry are those of the scene.
    void closest8(const int32_t* valid, RTCRayHit8& rays) const;
    void occluded8(const int32_t* valid, RTCRay8& rays) const;  // an occluded ray gets a negative tfar

 private:
    EmbreeSceneHandle new_scene(bool watertight) const;
    struct UserGeometry {
        const EmbreeScene* owner;
        uint32_t geometry;
    };
    bool packets_find_the_same() const;
    bool scene_hit(const RTCHit& found, TraceHit& hit) const;
    bool make_ray(const float origin[3], const float direction[3], float t_max, RTCRay& ray) const;
    void attach_geometries(RTCScene target, uint32_t set);
    EmbreeGeometry make_geometry(uint32_t index);
    static bool closest(void* self, const float origin[3], const float direction[3], float t_max, TraceHit& hit);
    static bool occluded(void* self, const float origin[3], const float direction[3], float t_max);
    static void user_bounds(const RTCBoundsFunctionArguments* arguments);
    static void user_intersect(const RTCIntersectFunctionNArguments* arguments);
    static void user_occluded(const RTCOccludedFunctionNArguments* arguments);

    const Scene& scene_;
    void* const* scene_buffers_;
    float largest_ray_;  // larger coordinates of origins and directions are never passed to Embree
    size_t memory_ = 0;
    EmbreeDevice device_;
    std::vector<std::unique_ptr<UserGeometry>> user_geometries_;
    std::vector<EmbreeSceneHandle> set_scenes_;  // of objects; [0] unused
    EmbreeSceneHandle top_;
};

}  // namespace lampyris
