// The tracer of Vulkan and of backend cpu-bvh2: walks the BVH2 that core/bvh built.
#ifndef LAMPYRIS_KERNEL_TRACE_BVH2
#define LAMPYRIS_KERNEL_TRACE_BVH2

CONST uint BVH_STACK = HAS(EFFECT_INSTANCES) ? 68u : BVH_DEPTH;  // two trees, a mixed leaf, and the mark between them
CONST uint BVH_LEAVE_INSTANCE = 0xffffffffu;                     // on the stack: below it lies the world

// 1/x, but finite for 0, so that a box plane through the origin gives 0 and not NaN.
FN float bvh_inverse(float x) { return abs(x) > 1e-20f ? 1.0f / x : copy_sign(1e20f, x); }

// Where a ray enters a box, or 4e38-like infinity where it does not within [0, t_max]. Widened by the rounding of the slab
// distances (Ize 2013, "Robust BVH Ray Traversal").
FN float bvh_enter(vec3 low, vec3 high, vec3 o, vec3 inverse, float t_max) {
    float ax = (low.x - o.x) * inverse.x;
    float bx = (high.x - o.x) * inverse.x;
    float ay = (low.y - o.y) * inverse.y;
    float by = (high.y - o.y) * inverse.y;
    float az = (low.z - o.z) * inverse.z;
    float bz = (high.z - o.z) * inverse.z;
    float near = max(max(min(ax, bx), min(ay, by)), max(min(az, bz), 0.0f));
    float far = min(min(max(ax, bx), max(ay, by)), min(max(az, bz), t_max));
    return near <= far * 1.0000004f ? near : INFINITE_DISTANCE;
}

// Moeller and Trumbore 1997 by way of the unnormalised normal, from which shared code recomputes the distance. True where
// 0 < t < t_max.
FN bool bvh_triangle(vec3 v0, vec3 v1, vec3 v2, vec3 o, vec3 d, float t_max, OUT(float) t) {
    vec3 e1 = v1 - v0;
    vec3 e2 = v2 - v0;
    vec3 n = cross3(e1, e2);
    vec3 c = v0 - o;
    vec3 r = cross3(c, d);
    float det = dot3(d, n);
    float s = det < 0.0f ? -1.0f : 1.0f;
    float u = dot3(e2, r) * s;
    float v = -dot3(e1, r) * s;
    t = 0.0f;
    if (u < 0.0f || v < 0.0f || u + v > abs(det) || det == 0.0f) return false;
    t = dot3(c, n) / det;
    return t > 0.0f && t < t_max;
}

// The closest hit (or, with `any`, some hit) with 0 < t < t_max.
FN bool bvh_walk(vec3 origin, vec3 direction, float t_max, bool any_hit, OUT(Hit) hit) {
    uint stack[BVH_STACK];
    uint depth = 0u;
    vec3 o = origin;
    vec3 d = direction;
    vec3 inverse = vec3(bvh_inverse(d.x), bvh_inverse(d.y), bvh_inverse(d.z));
    float t_best = t_max;
    uint best = NONE;
    uint best_instance = 0u;
    uint instance = 0u;
    uint node = scene[0].counts.z;
    bool finished = false;
    while (!finished) {
        bool pop = true;
        if ((node & BVH_LEAF) == 0u) {
            float left = bvh_enter(vec3(bvh_nodes[node].left_min), vec3(bvh_nodes[node].left_max), o, inverse, t_best);
            float right =
                bvh_enter(vec3(bvh_nodes[node].right_min), vec3(bvh_nodes[node].right_max), o, inverse, t_best);
            uint left_child = floatBitsToUint(bvh_nodes[node].left_min.w);
            uint right_child = floatBitsToUint(bvh_nodes[node].left_max.w);
            bool hits_left = left < INFINITE_DISTANCE;
            bool hits_right = right < INFINITE_DISTANCE;
            if (hits_left && hits_right) {
                bool left_first = left <= right;
                if (depth >= BVH_STACK) {
                    REPORT_UNFINISHED();
                    break;
                }
                stack[depth] = left_first ? right_child : left_child;
                depth += 1u;
                node = left_first ? left_child : right_child;
                pop = false;
            } else if (hits_left || hits_right) {
                node = hits_left ? left_child : right_child;
                pop = false;
            }
        } else if (HAS(EFFECT_INSTANCES) && (node & 0x7f000000u) == 0u) {
            if (depth >= BVH_STACK) {
                REPORT_UNFINISHED();
                break;
            }
            stack[depth] = BVH_LEAVE_INSTANCE;
            depth += 1u;
            instance = node & 0x00ffffffu;
            o = transform_point(instances[instance].transform.from0, instances[instance].transform.from1,
                                instances[instance].transform.from2, origin);
            d = transform_vector(instances[instance].transform.from0, instances[instance].transform.from1,
                                 instances[instance].transform.from2, direction);
            inverse = vec3(bvh_inverse(d.x), bvh_inverse(d.y), bvh_inverse(d.z));
            node = instances[instance].data.z;
            pop = false;
        } else {
            uint first = node & 0x00ffffffu;
            uint end = first + ((node >> 24u) & 0x7fu);
            for (uint i = first; i < end; ++i) {
                vec4 v0 = bvh_triangles[3u * i];
                vec4 v1 = bvh_triangles[3u * i + 1u];
                vec4 v2 = bvh_triangles[3u * i + 2u];
                uint kind = (HAS(EFFECT_QUADRICS) || HAS(EFFECT_BILINEAR)) ? floatBitsToUint(v2.w) : BVH_TRIANGLE;
                float t = 0.0f;
                bool found = false;
                if (kind == BVH_TRIANGLE) {
                    found = bvh_triangle(vec3(v0), vec3(v1), vec3(v2), o, d, t_best, t);
                } else if (HAS(EFFECT_QUADRICS) && kind == BVH_QUADRIC) {
                    found = quadric_hit(floatBitsToUint(v0.w), o, d, t_best, t);
                } else if (HAS(EFFECT_BILINEAR)) {
                    vec2 uv;
                    found = bilinear_hit(floatBitsToUint(v0.w), floatBitsToUint(v1.w), o, d, t_best, t, uv);
                }
                if (found) {
                    t_best = t;
                    best = i;
                    best_instance = instance;
                }
            }
            if (any_hit && best != NONE) {
                finished = true;
                pop = false;
            }
        }
        if (pop) {
            if (HAS(EFFECT_INSTANCES) && depth > 0u && stack[depth - 1u] == BVH_LEAVE_INSTANCE) {
                depth -= 1u;
                instance = 0u;
                o = origin;
                d = direction;
                inverse = vec3(bvh_inverse(d.x), bvh_inverse(d.y), bvh_inverse(d.z));
            }
            if (depth == 0u) {
                finished = true;
            } else {
                depth -= 1u;
                node = stack[depth];
            }
        }
    }
    if (!finished) REPORT_UNFINISHED();  // the driver ended the loop
    hit.instance = 0u;
    hit.geometry = NONE;
    hit.primitive = NONE;
    if (best == NONE) return false;
    hit.instance = best_instance;
    hit.geometry = floatBitsToUint(bvh_triangles[3u * best].w);
    hit.primitive = floatBitsToUint(bvh_triangles[3u * best + 1u].w);
    return true;
}

// Hits with 0 < t < t_max. The direction need not be unit length.
FN bool trace_closest(vec3 origin, vec3 direction, float t_max, OUT(Hit) hit) {
    return bvh_walk(origin, direction, t_max, false, hit);
}
FN bool trace_occluded(vec3 origin, vec3 direction, float t_max) {
    Hit hit;
    return bvh_walk(origin, direction, t_max, true, hit);
}

#endif
