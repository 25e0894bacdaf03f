// Material "mix": each point shows one of two materials, by chance.
#ifndef LAMPYRIS_MATERIALS_MIX
#define LAMPYRIS_MATERIALS_MIX

// The deepest nesting of mix materials; the host refuses more.
CONST uint MIX_DEPTH = 64u;

// In [0, 1): a hash of where a surface is seen from where, so that the choice needs no random number and is the same for all
// who ask (pbrt, 4th edition, section 10.5.1); of the mix, too, so that nested mixes choose independently.
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

// Replaces a mix in s.material by the material that it shows here. wo: world space.
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
