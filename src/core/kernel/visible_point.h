// What an eye path of photon mapping does at a surface, and where photons are kept for it.
#ifndef LAMPYRIS_KERNEL_VISIBLE_POINT
#define LAMPYRIS_KERNEL_VISIBLE_POINT

CONST uint VISIBLE_FOLLOW = 0u;  // sample a direction and go on: (nearly) specular
CONST uint VISIBLE_GATHER = 1u;  // estimate the reflected radiance from photons here
CONST uint VISIBLE_SPLIT = 2u;   // a smooth coat over something rough: one or the other, by chance

// `roughness`: GGX alpha below which a lobe counts as nearly specular: too narrow for a handful of photons to fall into.
FN uint visible_action(IN(Bsdf) b, float roughness) {
    if (b.kind == MATERIAL_DIFFUSE || b.kind == MATERIAL_DIFFUSE_TRANSMISSION) return VISIBLE_GATHER;
    if (HAS(EFFECT_COAT) && bsdf_is_layered(b)) {
        if (bsdf_is_specular(b)) return VISIBLE_FOLLOW;
        bool smooth_coat = dielectric_is_specular(b.alpha, b.eta);
        bool narrow_base = b.kind == MATERIAL_COATED_CONDUCTOR && max(b.alpha_base.x, b.alpha_base.y) < roughness;
        if (narrow_base && (smooth_coat || max(b.alpha.x, b.alpha.y) < roughness)) return VISIBLE_FOLLOW;
        return smooth_coat ? VISIBLE_SPLIT : VISIBLE_GATHER;
    }
    if (bsdf_is_specular(b)) return VISIBLE_FOLLOW;
    if (HAS(EFFECT_DIELECTRIC) && b.kind == MATERIAL_DIELECTRIC)
        return max(b.alpha.x, b.alpha.y) < roughness ? VISIBLE_FOLLOW : VISIBLE_GATHER;
    if (HAS(EFFECT_CONDUCTOR) && b.kind == MATERIAL_CONDUCTOR)
        return max(b.alpha.x, b.alpha.y) < roughness ? VISIBLE_FOLLOW : VISIBLE_GATHER;
    return VISIBLE_FOLLOW;
}

// Whether an eye path may gather somewhere on a material. Photons are kept by this, not by what the photon's own visit shows of it:
// which of a mix it met, or how rough a texture is a radius farther, is drawn again, or differs, where the eye path arrives.
FN bool material_may_gather(uint material, float roughness) {
    return materials[material].floats2.w >= max(roughness, GGX_SMOOTH);
}

// Whether light that arrives on one side leaves on the other.
FN bool bsdf_transmits(IN(Bsdf) b) {
    return (HAS(EFFECT_DIFFUSE_TRANSMISSION) && b.kind == MATERIAL_DIFFUSE_TRANSMISSION) ||
           (HAS(EFFECT_DIELECTRIC) && b.kind == MATERIAL_DIELECTRIC);
}

#endif
