// The surfaces on which photons are kept for the eye paths of photon mapping. bsdf_visible_action decides what eye
// paths do there.
#ifndef LAMPYRIS_KERNEL_VISIBLE_POINT
#define LAMPYRIS_KERNEL_VISIBLE_POINT

// Whether an eye path may gather anywhere on a material. Photons are kept if it may, even if the photon itself finds a
// smooth surface: for the eye path, another leaf of a mix may be chosen, and a texture may have another roughness a
// radius away.
FN bool material_may_gather(uint material, float roughness) {
    return materials[material].roughest_alpha >= max(roughness, GGX_SMOOTH);
}

#endif
