// The Bsdf at a surface point: chooses the material of a mix, and evaluates textures, bump or normal map.
#ifndef LAMPYRIS_KERNEL_MATERIAL
#define LAMPYRIS_KERNEL_MATERIAL

// Step of a bump map's finite differences, in units of u and v (that of pbrt if it has no footprint).
CONST float BUMP_STEP = 5e-4f;

FN TextureContext surface_texture_context(IN(Surface) s) {
    TextureContext c;
    c.position = s.position;
    c.normal = s.ng;
    c.uv = s.uv;
    return c;
}

// Opacity of a geometry at a point: the probability that a hit counts.
FN float surface_alpha(uint geometry, IN(TextureContext) c) {
    uint program = geometries[geometry].alpha_texture;
    if (program == NONE) return geometries[geometry].alpha;
    return texture_float(program, c);
}

// A mix does not scatter: it only chooses one of its materials.
#include "materials/mix/mix_bsdf.h"

// The texture of a slot, in the record's order: color0..2, roughness u and v, thickness, the coat's roughness u and v.
CONST uint MATERIAL_SLOTS = 8u;
FN uint material_slot(IN(MaterialRecord) m, uint slot) {
    if (slot == 0u) return m.color0_texture;
    if (slot == 1u) return m.color1_texture;
    if (slot == 2u) return m.color2_texture;
    if (slot == 3u) return m.roughness_u_texture;
    if (slot == 4u) return m.roughness_v_texture;
    if (slot == 5u) return m.thickness_texture;
    if (slot == 6u) return m.coat_roughness_u_texture;
    return m.coat_roughness_v_texture;
}

// Replaces the shading normal and tangent by those of the surface displaced along its normal. `displaced` has the
// displacement after a step in u, after a step in v, and at the point itself (Blinn 1978; pbrt, 4th edition, equations
// 10.11 and 10.12).
FN void apply_bump(INOUT(Surface) s, vec3 displaced) {
    // Tangents of the smooth surface that the shading normals imply: the true tangents, projected onto its tangent
    // plane.
    vec3 dpdu = s.dpdu - s.ns * dot3(s.ns, s.dpdu);
    vec3 dpdv = s.dpdv - s.ns * dot3(s.ns, s.dpdv);
    dpdu = dpdu + ((displaced.x - displaced.z) / BUMP_STEP) * s.ns + displaced.z * s.dndu;
    dpdv = dpdv + ((displaced.y - displaced.z) / BUMP_STEP) * s.ns + displaced.z * s.dndv;
    vec3 normal = cross3(dpdu, dpdv);
    float l2 = length_squared(normal);
    if (!(l2 > 1e-30f && l2 < 1e30f)) return;
    s.ns = face_forward(normal / sqrt(l2), s.ng);
    s.dpdu = dpdu;
}

// Replaces the shading normal by that of a tangent-space normal map, which contains (n + 1) / 2 (pbrt, 4th edition,
// section 10.5.3).
FN void apply_normal_map(INOUT(Surface) s, uint image) {
    vec4 found = image_lookup(image, vec2(s.uv.x, 1.0f - s.uv.y));
    vec3 n = vec3(2.0f * found.x - 1.0f, 2.0f * found.y - 1.0f, 2.0f * found.z - 1.0f);
    if (!(length_squared(n) > 1e-12f)) return;
    s.ns = face_forward(unit(to_world(frame_from_xz(s.dpdu, s.ns), n)), s.ng);
}

FN bool material_is_textured(IN(MaterialRecord) m) {
    return (m.color0_texture & m.color1_texture & m.color2_texture & m.roughness_u_texture & m.roughness_v_texture &
            m.thickness_texture & m.coat_roughness_u_texture & m.coat_roughness_v_texture) != NONE;
}

// Evaluates the textures of the record's slots, and applies the bump map, if any. One loop with one call, because a
// GLSL compiler inlines every call of texture_color.
FN void material_textures(INOUT(MaterialRecord) m, INOUT(Surface) s) {
    bool bumped = HAS(EFFECT_BUMP) && m.bump_texture != NONE;
    bool textured = HAS(EFFECT_TEXTURES) && material_is_textured(m);
    TextureContext here = surface_texture_context(s);
    vec3 displaced = vec3(0.0f);
    uint end = textured ? 3u + MATERIAL_SLOTS : 3u;
    for (uint job = bumped ? 0u : 3u; job < end; ++job) {
        uint program = job < 3u ? m.bump_texture : material_slot(m, job - 3u);
        if (program == NONE) continue;
        TextureContext c = here;
        if (job == 0u) {
            c.position = here.position + BUMP_STEP * s.dpdu;
            c.uv = vec2(here.uv.x + BUMP_STEP, here.uv.y);
        } else if (job == 1u) {
            c.position = here.position + BUMP_STEP * s.dpdv;
            c.uv = vec2(here.uv.x, here.uv.y + BUMP_STEP);
        }
        vec3 value = texture_color(program, c);
        if (job == 0u)
            displaced.x = value.x;
        else if (job == 1u)
            displaced.y = value.x;
        else if (job == 2u)
            displaced.z = value.x;
        else if (job == 3u)
            m.color0 = spectrum_of_rgb(value);
        else if (job == 4u)
            m.color1 = spectrum_of_rgb(value);
        else if (job == 5u)
            m.color2 = spectrum_of_rgb(value);
        else if (job == 6u)
            m.roughness_u = value.x;
        else if (job == 7u)
            m.roughness_v = value.x;
        else if (job == 8u)
            m.thickness = value.x;
        else if (job == 9u)
            m.coat_roughness_u = value.x;
        else
            m.coat_roughness_v = value.x;
    }
    if (bumped) apply_bump(s, displaced);
}

// The Bsdf at s, and its local frame, whose z is the shading normal. wo, the direction in which light leaves, and the
// frame's axes are in world space. Afterwards s.ns and s.dpdu include the bump or normal map, and s.material is not a
// mix.
FN Bsdf material_bsdf(INOUT(Surface) s, vec3 wo, OUT(Frame) frame) {
    if (HAS(EFFECT_MATERIAL_MIX) && RARELY(materials[s.material].kind == MATERIAL_MIX)) {
        Surface mixed = s;
        mix_resolve(mixed, wo);
        s.material = mixed.material;
    }
    MaterialRecord m = materials[s.material];
    if ((HAS(EFFECT_BUMP) && RARELY(m.bump_texture != NONE)) ||
        (HAS(EFFECT_TEXTURES) && RARELY(material_is_textured(m))))
        material_textures(m, s);
    if (HAS(EFFECT_BUMP) && m.normal_map != NONE) apply_normal_map(s, m.normal_map);

    Bsdf b = bsdf_of_record(m);
    // Only anisotropic roughness depends on the tangent.
    bool oriented = CALLED_FOR(EFFECT_ANISOTROPIC) && (b.alpha.x != b.alpha.y || b.alpha_base.x != b.alpha_base.y);
    if (oriented)
        frame = frame_from_xz(s.dpdu, s.ns);
    else
        frame = frame_from_z(s.ns);
    return b;
}

#endif
