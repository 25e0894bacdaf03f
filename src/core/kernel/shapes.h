// Shapes other than triangles: spheres, disks and cylinders (quadric.h), bilinear patches (bilinear.h).
//
// The ray tracers of all backends call quadric_hit and bilinear_hit; ray -> Surface evaluates the same expressions again,
// so that a hit is the same hit everywhere. Rays and results are in the space of the geometry's set (the world, or the
// definition space of an instanced object); directions need not have unit length, t counts in lengths of the direction.
#ifndef LAMPYRIS_KERNEL_SHAPES
#define LAMPYRIS_KERNEL_SHAPES

// Vertex data by absolute index of the vertex.
FN vec3 vertex_position(uint i) { return vec3(positions[3u * i], positions[3u * i + 1u], positions[3u * i + 2u]); }
FN vec3 vertex_normal(uint i) { return vec3(normals[3u * i], normals[3u * i + 1u], normals[3u * i + 2u]); }
FN vec2 vertex_uv(uint i) { return vec2(uvs[2u * i], uvs[2u * i + 1u]); }

// Texture coordinates and derivatives are for textures, masks, bump maps and anisotropic roughness only.
FN bool surface_needs_uv() {
    return CALLED_FOR(EFFECT_TEXTURES | EFFECT_ALPHA | EFFECT_BUMP | EFFECT_ANISOTROPIC | EFFECT_LIGHT_TEXTURES);
}

// The derivative of a unit vector n = v / l, given that of v.
FN vec3 unit_derivative(vec3 n, float l, vec3 dv) { return (dv - n * dot3(n, dv)) / l; }

#include "core/kernel/quadric.h"
#include "core/kernel/bilinear.h"

#endif
