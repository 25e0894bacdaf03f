#include "accel/rays/embree_scene.h"

#include "core/base/error.h"
#include "core/scene/scene.h"
#include "accel/rays/primitive_kernel.h"

#include <fmt/format.h>
#include <emmintrin.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace lampyris {
namespace {

void check(RTCDevice device, const char* doing) {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_NONE) return;
    if (error == RTC_ERROR_OUT_OF_MEMORY)
        throw MachineError(fmt::format("error: no memory left while {} (Embree)", doing));
    throw MachineError(fmt::format("error: Embree failed while {} (error {})", doing, int(error)));
}

bool count_memory(void* total, ssize_t bytes, bool) {
    std::atomic_ref<size_t>(*static_cast<size_t*>(total)).fetch_add(size_t(bytes));
    return true;
}

// Embree terminates the process (by an assertion in Debian's libraries) for a ray that is not finite or reaches this far.
constexpr float kLargestRay = 1.8e18f;

__m128 load3(const float v[3]) {
    return _mm_movelh_ps(_mm_castpd_ps(_mm_load_sd(reinterpret_cast<const double*>(v))), _mm_load_ss(v + 2));
}

RTCRay ray_of(const RTCRay8& rays, uint32_t l) {
    RTCRay ray;
    ray.org_x = rays.org_x[l], ray.org_y = rays.org_y[l], ray.org_z = rays.org_z[l], ray.tnear = rays.tnear[l];
    ray.dir_x = rays.dir_x[l], ray.dir_y = rays.dir_y[l], ray.dir_z = rays.dir_z[l], ray.time = rays.time[l];
    ray.tfar = rays.tfar[l], ray.mask = rays.mask[l], ray.id = 0, ray.flags = rays.flags[l];
    return ray;
}

}  // namespace

EmbreeScene::EmbreeScene(const Scene& scene, void* const* scene_buffers, bool watertight)
    : scene_(scene),
      scene_buffers_(scene_buffers),
      largest_ray_(kLargestRay),
      device_(rtcNewDevice("start_threads=0")) {
    if (!device_.get()) throw MachineError("error: Embree cannot start on this processor");
    rtcSetDeviceMemoryMonitorFunction(device_.get(), count_memory, &memory_);

    set_scenes_.resize(scene.sets.size());
    for (uint32_t set = 1; set < scene.sets.size(); ++set) {
        set_scenes_[set] = new_scene(watertight);
        attach_geometries(set_scenes_[set].get(), set);
        rtcCommitScene(set_scenes_[set].get());
        check(device_.get(), "building an object's acceleration structure");
    }
    top_ = new_scene(watertight);
    attach_geometries(top_.get(), 0);
    const uint32_t first_instance = uint32_t(scene.geometries.size());
    for (uint32_t i = 1; i < scene.instances.size(); ++i) {
        const EmbreeGeometry instance(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE));
        rtcSetGeometryInstancedScene(instance.get(), set_scenes_[scene.instance_sets[i]].get());
        rtcSetGeometryTransform(instance.get(), 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, &scene.instances[i].transform.to0);
        rtcCommitGeometry(instance.get());
        rtcAttachGeometryByID(top_.get(), instance.get(), first_instance + i);
        // Within the instance the ray is transformed, and must be in range there, too.
        const kernel::TransformRecord& t = scene.instances[i].transform;
        for (const kernel::vec4& row : {t.from0, t.from1, t.from2}) {
            const float stretch = std::abs(row.x) + std::abs(row.y) + std::abs(row.z);
            largest_ray_ = std::min(largest_ray_,
                                    (kLargestRay - std::min(std::abs(row.w), kLargestRay)) / std::max(stretch, 1.0f));
        }
    }
    rtcCommitScene(top_.get());
    check(device_.get(), "building the acceleration structure");
}

EmbreeSceneHandle EmbreeScene::new_scene(bool watertight) const {
    EmbreeSceneHandle scene(rtcNewScene(device_.get()));
    rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
    if (watertight) rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    return scene;
}

CpuTracer EmbreeScene::tracer() { return {this, &EmbreeScene::closest, &EmbreeScene::occluded}; }

// False for rays that hit nothing, as in the other tracers. Such a ray comes from values that are not finite, and those are
// reported as a bad sample. Embree's records begin with the origin and tnear, then the direction and time.
bool EmbreeScene::make_ray(const float origin[3], const float direction[3], float t_max, RTCRay& ray) const {
    const __m128 o = load3(origin), d = load3(direction), limit = _mm_set1_ps(largest_ray_);
    // Some of Embree's triangle tests let hits at tnear count, others do not: hits at 0 must not.
    _mm_store_ps(&ray.org_x, _mm_or_ps(o, _mm_setr_ps(0.0f, 0.0f, 0.0f, std::numeric_limits<float>::min())));
    _mm_store_ps(&ray.dir_x, d);
    ray.tfar = t_max, ray.mask = ~0u, ray.id = 0, ray.flags = 0;
    const __m128 sign = _mm_set1_ps(-0.0f);
    const __m128 in_range =
        _mm_and_ps(_mm_cmple_ps(_mm_andnot_ps(sign, o), limit), _mm_cmple_ps(_mm_andnot_ps(sign, d), limit));
    return (_mm_movemask_ps(in_range) == 15) & (t_max >= 0.0f);
}

void EmbreeScene::attach_geometries(RTCScene target, uint32_t set) {
    const GeometrySet& range = scene_.sets[set];
    for (uint32_t i = 0; i < range.geometry_count; ++i) {
        const EmbreeGeometry geometry = make_geometry(range.first_geometry + i);
        rtcCommitGeometry(geometry.get());
        rtcAttachGeometryByID(target, geometry.get(), i);
    }
    check(device_.get(), "handing over the geometry");
}

EmbreeGeometry EmbreeScene::make_geometry(uint32_t index) {
    const kernel::GeometryRecord& record = scene_.geometries[index];
    const uint32_t count = record.primitive_count;
    if (record.kind == kernel::GEOMETRY_TRIANGLES) {
        EmbreeGeometry geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
        const size_t vertices = scene_.positions.size() / 3 - record.first_vertex;
        rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                   scene_.positions.data(), size_t(record.first_vertex) * 12, 12, vertices);
        rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, scene_.indices.data(),
                                   size_t(record.first_index) * 4, 12, count);
        return geometry;
    }
    EmbreeGeometry geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_USER));
    rtcSetGeometryUserPrimitiveCount(geometry.get(), count);
    user_geometries_.push_back(std::make_unique<UserGeometry>(UserGeometry{this, index}));
    rtcSetGeometryUserData(geometry.get(), user_geometries_.back().get());
    rtcSetGeometryBoundsFunction(geometry.get(), &EmbreeScene::user_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry.get(), &EmbreeScene::user_intersect);
    rtcSetGeometryOccludedFunction(geometry.get(), &EmbreeScene::user_occluded);
    return geometry;
}

// Embree's hit as the scene's instance and geometry; false if there is none.
bool EmbreeScene::scene_hit(const RTCHit& found, TraceHit& hit) const {
    if (found.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    hit.primitive = found.primID;
    if (found.instID[0] == RTC_INVALID_GEOMETRY_ID) {
        hit.instance = 0;
        hit.geometry = found.geomID;
    } else {
        hit.instance = found.instID[0] - uint32_t(scene_.geometries.size());
        hit.geometry = scene_.sets[scene_.instance_sets[hit.instance]].first_geometry + found.geomID;
    }
    return true;
}

bool EmbreeScene::closest(void* self, const float origin[3], const float direction[3], float t_max, TraceHit& hit) {
    const EmbreeScene& scene = *static_cast<const EmbreeScene*>(self);
    RTCRayHit ray;
    if (!scene.make_ray(origin, direction, t_max, ray.ray)) return false;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene.top_.get(), &context, &ray);
    return scene.scene_hit(ray.hit, hit);
}

bool EmbreeScene::occluded(void* self, const float origin[3], const float direction[3], float t_max) {
    const EmbreeScene& scene = *static_cast<const EmbreeScene*>(self);
    RTCRay ray;
    if (!scene.make_ray(origin, direction, t_max, ray)) return false;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene.top_.get(), &context, &ray);
    return ray.tfar < 0.0f;
}

const EmbreeScene* EmbreeScene::of(const CpuTracer& tracer) {
    return tracer.closest == &EmbreeScene::closest ? static_cast<const EmbreeScene*>(tracer.scene) : nullptr;
}

// Of several surfaces at the same distance, a ray finds the one that it meets first or last in the walk of the BVH. Embree walks
// with each ray of an incoherent packet as with a ray alone, if there are triangles only. Among instances and other shapes it
// walks with the whole packet: there, rays are traced one by one.
bool EmbreeScene::packets_find_the_same() const { return user_geometries_.empty() && scene_.instances.size() < 2; }

void EmbreeScene::closest8(const int32_t* valid, RTCRayHit8& rays) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (packets_find_the_same()) {
        rtcIntersect8(valid, top_.get(), &context, &rays);
        return;
    }
    for (uint32_t l = 0; l < 8; ++l) {
        if (!valid[l]) continue;
        RTCRayHit one;
        one.ray = ray_of(rays.ray, l);
        one.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        one.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(top_.get(), &context, &one);
        TraceHit hit;
        if (!scene_hit(one.hit, hit)) continue;
        rays.hit.geomID[l] = hit.geometry;
        rays.hit.primID[l] = hit.primitive;
        rays.hit.instID[0][l] = hit.instance;
    }
}

void EmbreeScene::occluded8(const int32_t* valid, RTCRay8& rays) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (packets_find_the_same()) {
        rtcOccluded8(valid, top_.get(), &context, &rays);
        return;
    }
    for (uint32_t l = 0; l < 8; ++l) {
        if (!valid[l]) continue;
        RTCRay one = ray_of(rays, l);
        rtcOccluded1(top_.get(), &context, &one);
        rays.tfar[l] = one.tfar;
    }
}

void EmbreeScene::user_bounds(const RTCBoundsFunctionArguments* arguments) {
    const UserGeometry& geometry = *static_cast<const UserGeometry*>(arguments->geometryUserPtr);
    const PrimitiveBounds bounds = primitive_bounds(geometry.owner->scene_, geometry.geometry, arguments->primID);
    *arguments->bounds_o = {bounds.low.x,  bounds.low.y,  bounds.low.z,  0.0f,
                            bounds.high.x, bounds.high.y, bounds.high.z, 0.0f};
}

void EmbreeScene::user_intersect(const RTCIntersectFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    const UserGeometry& geometry = *static_cast<const UserGeometry*>(arguments->geometryUserPtr);
    RTCRayHit& ray = *reinterpret_cast<RTCRayHit*>(arguments->rayhit);
    float t = 0.0f;
    if (!primitive_hit(geometry.owner->scene_buffers_, geometry.geometry, arguments->primID, &ray.ray.org_x,
                       &ray.ray.dir_x, ray.ray.tfar, t))
        return;
    ray.ray.tfar = t;
    ray.hit.geomID = arguments->geomID;
    ray.hit.primID = arguments->primID;
    ray.hit.instID[0] = arguments->context->instID[0];
}

void EmbreeScene::user_occluded(const RTCOccludedFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    const UserGeometry& geometry = *static_cast<const UserGeometry*>(arguments->geometryUserPtr);
    RTCRay& ray = *reinterpret_cast<RTCRay*>(arguments->ray);
    float t = 0.0f;
    if (primitive_hit(geometry.owner->scene_buffers_, geometry.geometry, arguments->primID, &ray.org_x, &ray.dir_x,
                      ray.tfar, t))
        ray.tfar = -std::numeric_limits<float>::infinity();
}

}  // namespace lampyris
