// Shapes other than triangles: spheres, disks and cylinders (quadric.h), bilinear patches (bilinear.h).
//
// The ray tracers of all backends call quadric_hit and bilinear_hit; surface_at evaluates the same expressions again,
// so that a hit is the same everywhere. Rays and results are in the space of the geometry's set (the world, or the
// definition space of an instanced object). Directions need not have unit length; t is in units of the direction's
// length.
#ifndef LAMPYRIS_KERNEL_SHAPES
#define LAMPYRIS_KERNEL_SHAPES

// Vertex data by the vertex's absolute index.
FN vec3 vertex_position(uint i) { return vec3(positions[3u * i], positions[3u * i + 1u], positions[3u * i + 2u]); }
FN vec3 vertex_normal(uint i) { return vec3(normals[3u * i], normals[3u * i + 1u], normals[3u * i + 2u]); }
FN vec2 vertex_uv(uint i) { return vec2(uvs[2u * i], uvs[2u * i + 1u]); }

// Only textures, masks, bump maps and anisotropic roughness need texture coordinates and derivatives.
FN bool surface_needs_uv() {
    return CALLED_FOR(EFFECT_TEXTURES | EFFECT_ALPHA | EFFECT_BUMP | EFFECT_ANISOTROPIC | EFFECT_LIGHT_TEXTURES);
}

// The length of way_out (math.h).
FN float way_out_length(vec3 p, vec3 error, vec3 ng) {
    return dot3(abs(ng), error + (4.0f * MACHINE_EPSILON) * abs(p));
}

// Squared lengths between these bounds have not lost precision by over- or underflow. Those of edges and distances
// always are (the host ensures it), those of cross products of edges may not be.
CONST float LEAST_SQUARE = 1e-30f;
CONST float LARGEST_SQUARE = 1e30f;
FN bool square_fits(float x) { return x > LEAST_SQUARE && x < LARGEST_SQUARE; }

// The power of two that scales x > 0 into [1, 2); at most 2^60, so that other values scaled by it stay finite.
FN float scale_to_one(float x) {
    return uintBitsToFloat(min(0x7f000000u - (floatBitsToUint(x) & 0x7f800000u), 0x5d800000u));
}

// The length of a cross product, of any magnitude.
FN float length_of_area(vec3 v) {
    float square = length_squared(v);
    if (!RARELY(!square_fits(square))) return sqrt(square);
    float scale = scale_to_one(max_component(abs(v)));
    return length_of(scale * v) / scale;
}

// Bound of the distance from a triangle's plane at which a tracer may find the point p0 + b1 e1 + b2 e2; n is e1 x e2.
// Tracers define the plane by p0 and a normal whose components are differences of products. Its rounding moves the
// plane, far from p0, by more than the rounding of the point's own coordinates. Planes perpendicular to an axis are
// exact. The plane of a sliver is hardly defined, so the bound is limited to a small fraction of the sliver's length.
FN float triangle_plane_error(vec3 e1, vec3 e2, float b1, float b2, float n_inverse) {
    vec3 products = abs(vec3(e1.y * e2.z, e1.z * e2.x, e1.x * e2.y)) + abs(vec3(e1.z * e2.y, e1.x * e2.z, e1.y * e2.x));
    vec3 from_p0 = b1 * abs(e1) + b2 * abs(e2);
    float most = 16.0f * (from_p0.x + from_p0.y + from_p0.z);
    return gamma_bound(6.0f) * min(dot3(from_p0, products) * n_inverse, most);
}

// The derivative of a unit vector n = v / l, given that of v.
FN vec3 unit_derivative(vec3 n, float l, vec3 dv) { return (dv - n * dot3(n, dv)) / l; }

#include "core/kernel/quadric.h"
#include "core/kernel/bilinear.h"

#endif
