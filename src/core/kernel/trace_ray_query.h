// Ray tracing by the device: VK_KHR_ray_query. GLSL only; backends/vulkan/ray_query.cpp builds the acceleration
// structures.
#ifndef LAMPYRIS_KERNEL_TRACE_RAY_QUERY
#define LAMPYRIS_KERNEL_TRACE_RAY_QUERY

layout(set = 0, binding = 16) uniform accelerationStructureEXT top_level;

// The closest hit (or, with `any_hit`, some hit) with 0 < t < t_max.
bool ray_query_walk(vec3 origin, vec3 direction, float t_max, bool any_hit, OUT(Hit) hit) {
    rayQueryEXT query;
    rayQueryInitializeEXT(query, top_level, any_hit ? gl_RayFlagsTerminateOnFirstHitEXT : gl_RayFlagsNoneEXT, 0xffu,
                          origin, 0.0f, direction, t_max);
    bool finished = false;
    while (!finished) {
        if (!rayQueryProceedEXT(query)) {
            finished = true;
        } else if (HAS(EFFECT_QUADRICS) || HAS(EFFECT_BILINEAR)) {
            // Triangles are opaque, so this is the box of a quadric or a patch.
            vec3 o = rayQueryGetIntersectionObjectRayOriginEXT(query, false);
            vec3 d = rayQueryGetIntersectionObjectRayDirectionEXT(query, false);
            uint geometry = uint(rayQueryGetIntersectionInstanceCustomIndexEXT(query, false));
            uint primitive = uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, false));
            bool committed = rayQueryGetIntersectionTypeEXT(query, true) != gl_RayQueryCommittedIntersectionNoneEXT;
            float t_best = committed ? rayQueryGetIntersectionTEXT(query, true) : t_max;
            float t = 0.0f;
            bool found = false;
            if (HAS(EFFECT_BILINEAR) && geometries[geometry].kind == GEOMETRY_BILINEAR) {
                vec2 uv;
                found = bilinear_hit(geometry, primitive, o, d, t_best, t, uv);
            } else if (HAS(EFFECT_QUADRICS)) {
                found = quadric_hit(geometry, o, d, t_best, t);
            }
            if (found) rayQueryGenerateIntersectionEXT(query, t);
        }
    }
    if (!finished) REPORT_UNFINISHED();  // the driver ended the loop
    hit.instance = 0u;
    hit.geometry = NONE;
    hit.primitive = NONE;
    if (rayQueryGetIntersectionTypeEXT(query, true) == gl_RayQueryCommittedIntersectionNoneEXT) return false;
    hit.instance = rayQueryGetIntersectionInstanceShaderBindingTableRecordOffsetEXT(query, true);
    hit.geometry = uint(rayQueryGetIntersectionInstanceCustomIndexEXT(query, true));
    hit.primitive = uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, true));
    return true;
}

bool trace_closest(vec3 origin, vec3 direction, float t_max, OUT(Hit) hit) {
    return ray_query_walk(origin, direction, t_max, false, hit);
}
bool trace_occluded(vec3 origin, vec3 direction, float t_max) {
    Hit hit;
    return ray_query_walk(origin, direction, t_max, true, hit);
}

#endif
