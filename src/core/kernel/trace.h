// Ray tracing: the tracer is chosen when a kernel is built.
#ifndef LAMPYRIS_KERNEL_TRACE
#define LAMPYRIS_KERNEL_TRACE

#ifdef KERNEL_TRACER_calls
// C++: the device hands the tracer over. Hits with 0 < t < t_max. The direction need not be unit length.
FN bool trace_closest(vec3 origin, vec3 direction, float t_max, OUT(Hit) hit) {
    TraceHit found;
    if (!tracer_->closest(tracer_->scene, &origin.x, &direction.x, t_max, found)) return false;
    hit.instance = found.instance;
    hit.geometry = found.geometry;
    hit.primitive = found.primitive;
    return true;
}
FN bool trace_occluded(vec3 origin, vec3 direction, float t_max) {
    return tracer_->occluded(tracer_->scene, &origin.x, &direction.x, t_max);
}
#elif defined(KERNEL_TRACER_ray_query)
#include "core/kernel/trace_ray_query.h"
#else
#include "core/kernel/trace_bvh2.h"
#endif

#endif
