// Material "mix": each point has one of two materials, by random choice.
#ifndef LAMPYRIS_MATERIALS_MIX
#define LAMPYRIS_MATERIALS_MIX

// Maximum number of steps through nested mixes; the host rejects deeper nesting.
CONST uint MIX_DEPTH = 64u;

// In [0, 1): a hash of position and direction, so that the choice needs no random number and is the same at every
// evaluation (pbrt, 4th edition, section 10.5.1). The mix is hashed, too, so that nested mixes choose independently.
FN float mix_choice(vec3 position, vec3 wo, uint material) {
    uint h = hash32(material);
    h = hash_combine(h, floatBitsToUint(position.x));
    h = hash_combine(h, floatBitsToUint(position.y));
    h = hash_combine(h, floatBitsToUint(position.z));
    h = hash_combine(h, floatBitsToUint(wo.x));
    h = hash_combine(h, floatBitsToUint(wo.y));
    h = hash_combine(h, floatBitsToUint(wo.z));
    return unit_float(h);
}

// Replaces a mix in s.material by the material that it chooses at this point. wo is in world space.
RARE_FN void mix_resolve(INOUT(Surface) s, vec3 wo) {
    for (uint i = 0u; i < MIX_DEPTH; ++i) {
        if (materials[s.material].kind != MATERIAL_MIX) return;
        MaterialRecord m = materials[s.material];
        float amount = m.amount;
        if (m.amount_texture != NONE) amount = texture_float(m.amount_texture, surface_texture_context(s));
        s.material = mix_choice(s.position, wo, s.material) < amount ? m.second_material : m.first_material;
    }
    REPORT_UNFINISHED();
}

#endif
