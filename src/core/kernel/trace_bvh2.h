// The tracer of Vulkan without ray queries and of backend cpu-bvh2: traverses the BVH2 of core/bvh.
#ifndef LAMPYRIS_KERNEL_TRACE_BVH2
#define LAMPYRIS_KERNEL_TRACE_BVH2

CONST uint BVH_STACK = HAS(EFFECT_INSTANCES) ? 68u : BVH_DEPTH;  // two trees, a mixed leaf, and the marker between them
// Markers on the stack. They have the leaf's bit, so that the inner loop stops at them as at leaves.
CONST uint BVH_LEAVE_INSTANCE = 0xffffffffu;  // nodes of the world are below it
CONST uint BVH_END = 0xfffffffeu;             // the bottom of the stack

// 1/x, but finite for 0, so that a box plane through the origin gives 0 and not NaN.
FN float bvh_inverse(float x) { return abs(x) > 1e-20f ? 1.0f / x : copy_sign(1e20f, x); }

// Comparisons with NaN are false, and the traversal would visit every node.
FN bool bvh_is_finite(vec3 o, vec3 d) { return is_finite(o.x + o.y + o.z + d.x + d.y + d.z); }

// The distance at which a ray enters a box, or INFINITE_DISTANCE if it does not within [0, t_max]. Boxes are widened by
// the rounding of the slab distances (Ize 2013, "Robust BVH Ray Traversal") and by that of bvh_corner. The direction's signs tell near planes
// from far ones. Distances are compared as integers: bits of floats that are not negative have the floats' order. A
// negative near distance loses against 0, and a negative far distance makes the box a miss. GLSL's min and max of
// floats must handle NaN, which takes three instructions each on a CPU.
FN float bvh_enter(IN(VecPair) box, vec3 o, vec3 inverse, float t_max) {
    bool back_x = inverse.x < 0.0f;
    bool back_y = inverse.y < 0.0f;
    bool back_z = inverse.z < 0.0f;
    float near_x = ((back_x ? box.second.x : box.first.x) - o.x) * inverse.x;
    float near_y = ((back_y ? box.second.y : box.first.y) - o.y) * inverse.y;
    float near_z = ((back_z ? box.second.z : box.first.z) - o.z) * inverse.z;
    float far_x = ((back_x ? box.first.x : box.second.x) - o.x) * inverse.x;
    float far_y = ((back_y ? box.first.y : box.second.y) - o.y) * inverse.y;
    float far_z = ((back_z ? box.first.z : box.second.z) - o.z) * inverse.z;
    int near_bits = max(max(floatBitsToInt(near_x), floatBitsToInt(near_y)), max(floatBitsToInt(near_z), 0));
    int far_bits =
        min(min(floatBitsToInt(far_x), floatBitsToInt(far_y)), min(floatBitsToInt(far_z), floatBitsToInt(t_max)));
    float near = intBitsToFloat(near_bits);
    return near <= intBitsToFloat(far_bits) * 1.000001f ? near : INFINITE_DISTANCE;
}

// Coordinates in which rays that start at the origin run along the third axis (Woop, Benthin and Wald 2013, "Watertight
// Ray/Triangle Intersection"): the axis of the direction's largest component comes third, the first two are sheared along it,
// and the third is in units of the direction's length.
struct BvhShear {
    uint axis;
    vec3 by;
};

FN vec3 bvh_axis_last(vec3 v, uint axis) {
    return axis == 0u ? vec3(v.y, v.z, v.x) : (axis == 1u ? vec3(v.z, v.x, v.y) : v);
}

FN BvhShear bvh_shear(vec3 d) {
    BvhShear shear;
    vec3 size = abs(d);
    shear.axis = size.z > max(size.x, size.y) ? 2u : (size.y > size.x ? 1u : 0u);
    vec3 turned = bvh_axis_last(d, shear.axis);
    float inverse = bvh_inverse(turned.z);
    shear.by = vec3(turned.x * inverse, turned.y * inverse, inverse);
    return shear;
}

// All triangles with a corner at p compute the same numbers for it.
FN vec3 bvh_corner(vec3 p, vec3 o, IN(BvhShear) shear) {
    vec3 from_o = bvh_axis_last(p - o, shear.axis);
    return vec3(from_o.x - shear.by.x * from_o.z, from_o.y - shear.by.y * from_o.z, shear.by.z * from_o.z);
}

// On which side of the edge from a to b the ray passes. The products are rounded before they are subtracted, so that the
// sign is right or 0, and the opposite one for the edge from b to a.
FN float bvh_side(vec3 a, vec3 b) { return a.x * b.y - a.y * b.x; }

// A triangle is seen edge-on if terms of d.n cancel but for this share: t is then not known from the plane.
CONST float BVH_EDGE_ON = 2.44140625e-4f;

// True if the ray hits the triangle with 0 < t < t_max. Watertight: a ray that meets an edge or a corner exactly, as far as
// floats tell, hits all triangles there, so that none passes between neighbours. (The paper computes such sides again, in
// double precision.)
//
// t is that of the plane: a ray that starts on a plane along two axes must not hit it. Of a triangle that is seen edge-on, t is
// a mean of its corners'.
FN bool bvh_triangle(vec3 v0, vec3 v1, vec3 v2, vec3 o, vec3 d, IN(BvhShear) shear, float t_max, OUT(float) t) {
    vec3 a = bvh_corner(v0, o, shear);
    vec3 b = bvh_corner(v1, o, shear);
    vec3 c = bvh_corner(v2, o, shear);
    float u = bvh_side(b, c);
    float v = bvh_side(c, a);
    float w = bvh_side(a, b);
    float sum = u + v + w;
    t = 0.0f;
    if ((min(min(u, v), w) < 0.0f && max(max(u, v), w) > 0.0f) || sum == 0.0f) return false;
    vec3 n = cross3(v1 - v0, v2 - v0);
    float det = dot3(d, n);
    float terms = dot3(abs(d), abs(n));
    if (!(terms > 0.0f)) return false;  // no area, but for rounding
    if (abs(det) > BVH_EDGE_ON * terms) {
        t = dot3(v0 - o, n) / det;
    } else {
        float scale = 1.0f / sum;
        t = u * scale * a.z + v * scale * b.z + w * scale * c.z;
    }
    return t > 0.0f && t < t_max;
}

// The closest hit (or, with `any_hit`, some hit) with 0 < t < t_max. A ray that is not finite hits nothing.
//
// Two nested loops: lanes of a GPU (or of a CPU's vectors) that have reached a leaf wait for the others, and then all
// test their leaves together (Aila and Laine 2009, "Understanding the Efficiency of Ray Traversal on GPUs").
FN bool bvh_walk(vec3 origin, vec3 direction, float t_max, bool any_hit, OUT(Hit) hit) {
    uint stack[BVH_STACK + 2u];  // BVH_END at the bottom, and one entry that is written before it is counted
    stack[0] = BVH_END;
    uint depth = 1u;
    vec3 o = origin;
    vec3 d = direction;
    vec3 inverse = vec3(bvh_inverse(d.x), bvh_inverse(d.y), bvh_inverse(d.z));
    BvhShear shear = bvh_shear(d);
    float t_best = t_max;
    uint best = NONE;
    uint best_instance = 0u;
    uint instance = 0u;
    uint node = bvh_is_finite(o, d) ? scene[0].root_node : BVH_END;
    bool finished = false;
    while (!finished) {
        while ((node & BVH_LEAF) == 0u) {
            VecPair left = READ_PAIR(bvh_nodes, 2u * node);
            VecPair right = READ_PAIR(bvh_nodes, 2u * node + 1u);
            float enter_left = bvh_enter(left, o, inverse, t_best);
            float enter_right = bvh_enter(right, o, inverse, t_best);
            uint left_child = floatBitsToUint(left.first.w);
            uint right_child = floatBitsToUint(left.second.w);
            bool left_first = enter_left <= enter_right;
            node = left_first ? left_child : right_child;
            // Stored even if the ray misses it: on a CPU, lanes that skip a store cost more than the store.
            stack[depth] = left_first ? right_child : left_child;
            if ((left_first ? enter_right : enter_left) < INFINITE_DISTANCE) depth += 1u;
            if ((left_first ? enter_left : enter_right) >= INFINITE_DISTANCE) {
                depth -= 1u;
                node = stack[depth];
            }
            if (depth > BVH_STACK + 1u) {
                node = 0u;
                break;
            }
        }
        if ((node & BVH_LEAF) == 0u) break;  // the stack is full, or the driver ended the loop
        if (node == BVH_END) {
            finished = true;
        } else if (HAS(EFFECT_INSTANCES) && node == BVH_LEAVE_INSTANCE) {
            instance = 0u;
            o = origin;
            d = direction;
            inverse = vec3(bvh_inverse(d.x), bvh_inverse(d.y), bvh_inverse(d.z));
            shear = bvh_shear(d);
            depth -= 1u;
            node = stack[depth];
        } else if (HAS(EFFECT_INSTANCES) && (node & 0x7f000000u) == 0u) {
            stack[depth] = BVH_LEAVE_INSTANCE;
            depth += 1u;
            if (depth > BVH_STACK + 1u) break;
            instance = node & 0x00ffffffu;
            o = transform_point(instances[instance].transform.from0, instances[instance].transform.from1,
                                instances[instance].transform.from2, origin);
            d = transform_vector(instances[instance].transform.from0, instances[instance].transform.from1,
                                 instances[instance].transform.from2, direction);
            inverse = vec3(bvh_inverse(d.x), bvh_inverse(d.y), bvh_inverse(d.z));
            shear = bvh_shear(d);
            node = bvh_is_finite(o, d) ? instances[instance].root_node : BVH_LEAVE_INSTANCE;
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
                    found = bvh_triangle(vec3(v0), vec3(v1), vec3(v2), o, d, shear, t_best, t);
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
            } else {
                depth -= 1u;
                node = stack[depth];
            }
        }
    }
    if (!finished) REPORT_UNFINISHED();
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
