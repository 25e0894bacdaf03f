// On which surfaces photons are kept for the eye paths of photon mapping. bsdf_visible_action says what they do there.
#ifndef LAMPYRIS_KERNEL_VISIBLE_POINT
#define LAMPYRIS_KERNEL_VISIBLE_POINT

// Whether an eye path may gather somewhere on a material. Photons are kept by this, not by what the photon's own visit shows of it:
// which of a mix it met, or how rough a texture is a radius farther, is drawn again, or differs, where the eye path arrives.
FN bool material_may_gather(uint material, float roughness) {
    return materials[material].roughest_alpha >= max(roughness, GGX_SMOOTH);
}

#endif
