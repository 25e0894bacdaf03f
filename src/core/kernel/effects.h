// All effects that a scene may need. Kernels test HAS(EFFECT_X); the host computes the set from the scene description
// (core/device/effects.h). Code for other effects is not compiled (Vulkan), or not in the chosen variant (CPU).
#ifndef LAMPYRIS_KERNEL_EFFECTS
#define LAMPYRIS_KERNEL_EFFECTS

#include "materials/list.h"

// E(constant, bit, name, its cost). Materials declare theirs in their folders, with bits from 32 on.
#define LAMPYRIS_EFFECTS(E)                                                                                           \
    E(EFFECT_SMOOTH_NORMALS, 0, "smooth-normals", "interpolates vertex normals at every hit")                         \
    E(EFFECT_QUADRICS, 1, "quadrics", "intersects spheres, disks and cylinders exactly")                              \
    E(EFFECT_BILINEAR, 2, "bilinear-patches", "intersects bilinear patches")                                          \
    E(EFFECT_INSTANCES, 3, "instancing", "a second level in the ray tracer, a transform per instance crossed")        \
    E(EFFECT_ALPHA, 4, "alpha", "a texture look-up and perhaps another ray per hit on a masked surface")              \
    E(EFFECT_TEXTURES, 5, "textures", "evaluates texture programs at every hit")                                      \
    E(EFFECT_IMAGES, 6, "image-textures", "four texel reads per image look-up")                                       \
    E(EFFECT_BUMP, 7, "bump-or-normal-map", "two more texture look-ups per hit for a bump map, one for a normal map") \
    LAMPYRIS_MATERIAL_EFFECTS(E)                                                                                      \
    E(EFFECT_ROUGH, 10, "rough-specular", "microfacet distributions (GGX, visible normals)")                          \
    E(EFFECT_AREA_LIGHTS, 16, "area-lights", "samples emissive shapes, and weights emission found by chance (MIS)")   \
    E(EFFECT_QUADRIC_LIGHTS, 17, "quadric-area-lights", "samples emissive spheres, disks, cylinders and patches")     \
    E(EFFECT_LIGHT_TEXTURES, 18, "textured-area-lights", "a texture look-up per emission")                            \
    E(EFFECT_POINT_LIGHTS, 19, "point-and-spot-lights", "a shadow ray to a point")                                    \
    E(EFFECT_DISTANT_LIGHTS, 20, "distant-lights", "a shadow ray that leaves the scene")                              \
    E(EFFECT_ENVIRONMENT, 21, "environment", "radiance for escaping rays, shadow rays that leave the scene")          \
    E(EFFECT_ENVIRONMENT_IMAGE, 22, "environment-image", "importance sampling of an image of directions")             \
    E(EFFECT_PROJECTION_LIGHTS, 23, "projection-and-goniometric-lights", "an image look-up per shadow ray")           \
    E(EFFECT_DEPTH_OF_FIELD, 24, "depth-of-field", "a lens sample per camera ray")                                    \
    E(EFFECT_NOISE, 25, "noise-textures", "gradient noise, eight hashed corners an octave")                           \
    E(EFFECT_ANISOTROPIC, 26, "anisotropic-roughness", "a tangent from the texture coordinates at every hit")         \
    E(EFFECT_MEDIUM, 27, "medium-absorption", "three exponentials per ray and shadow ray in a medium that absorbs")   \
    E(EFFECT_LIGHT_TREE, 28, "light-tree",                                                                            \
      "a walk down a tree of lights per light sample, and per emission found by chance")

// An EffectSet has 64 bits: one integer in C++, two in GLSL, where 64-bit integers are an extension.
#define LAMPYRIS_EFFECT_CONSTANT(constant, bit, name, cost) CONST EffectSet constant = EFFECT_BIT(bit);
LAMPYRIS_EFFECTS(LAMPYRIS_EFFECT_CONSTANT)
#undef LAMPYRIS_EFFECT_CONSTANT
#define LAMPYRIS_OR_EFFECT(constant, bit, name, cost) | constant
CONST EffectSet kAllEffects = EffectSet(0u) LAMPYRIS_EFFECTS(LAMPYRIS_OR_EFFECT);
#undef LAMPYRIS_OR_EFFECT
// No scene needs this one: a replay asks for it, and paths are then logged (path_log.h).
CONST EffectSet EFFECT_PATH_LOG = EFFECT_BIT(31);
// Sets for which C++ kernels are built (CPU_EFFECTS of lampyris_kernel): a scene runs on the smallest one that has all of its
// effects.
CONST EffectSet kDiffuseEffects = EFFECT_SMOOTH_NORMALS | EFFECT_AREA_LIGHTS;
CONST EffectSet kGlassEffects = kDiffuseEffects | EFFECT_QUADRICS | EFFECT_QUADRIC_LIGHTS | EFFECT_LIGHT_TREE |
                                EFFECT_CONDUCTOR | EFFECT_DIELECTRIC | EFFECT_ROUGH;
// Opaque, untextured surfaces, lit by points, distant lights and environments.
CONST EffectSet kSkyEffects = EFFECT_SMOOTH_NORMALS | EFFECT_QUADRICS | EFFECT_CONDUCTOR | EFFECT_ROUGH |
                              EFFECT_IMAGES | EFFECT_POINT_LIGHTS | EFFECT_DISTANT_LIGHTS | EFFECT_ENVIRONMENT |
                              EFFECT_ENVIRONMENT_IMAGE;
CONST EffectSet kTexturedEffects = kGlassEffects | EFFECT_TEXTURES | EFFECT_IMAGES | EFFECT_POINT_LIGHTS |
                                   EFFECT_DISTANT_LIGHTS | EFFECT_ENVIRONMENT | EFFECT_ENVIRONMENT_IMAGE |
                                   EFFECT_DEPTH_OF_FIELD;

#endif
