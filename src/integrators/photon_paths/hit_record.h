// The contents of an HitPointRecord, by name. It is packed so that kernels read four numbers at a time.
#ifndef LAMPYRIS_HIT_RECORD
#define LAMPYRIS_HIT_RECORD

#include "integrators/photon_paths/photon_paths_layout.h"

FN vec3 hit_direction(IN(HitPointRecord) h) {
    return vec3(uintBitsToFloat(h.direction.x), uintBitsToFloat(h.direction.y), uintBitsToFloat(h.direction.z));
}
FN vec3 hit_origin(IN(HitPointRecord) h) {
    return vec3(uintBitsToFloat(h.origin.x), uintBitsToFloat(h.origin.y), uintBitsToFloat(h.origin.z));
}
FN uint hit_instance(IN(HitPointRecord) h) { return h.origin.w; }
FN uint hit_geometry(IN(HitPointRecord) h) { return h.direction.w; }
FN uint hit_primitive(IN(HitPointRecord) h) { return h.more.x; }
// For smaller disks, the rounding error of the hit point would matter.
FN float hit_least_radius(IN(HitPointRecord) h) { return uintBitsToFloat(h.more.y); }
FN uint hit_medium(IN(HitPointRecord) h) { return h.more.z; }  // through which it was reached
FN uint hit_number(IN(HitPointRecord) h) { return h.more.w; }  // number of the vertex on the eye path, from 1
FN float hit_first_radius(IN(HitPointRecord) h) { return h.radiance.w; }
FN float hit_filter_weight(IN(HitPointRecord) h) { return h.throughput.w; }

FN HitPointRecord no_hit() {
    HitPointRecord h;
    h.origin = uvec4(0u);
    h.direction = uvec4(0u);
    h.throughput = vec4(0.0f);
    h.radiance = vec4(0.0f);
    h.more = uvec4(0u);
    return h;
}

#endif
