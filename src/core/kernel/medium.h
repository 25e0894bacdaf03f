// Homogeneous media that absorb: what they leave of light on its way, and which one a ray is in.
//
// A path or photon needs three lines: the medium where it starts (camera_medium, light_medium), `medium_transmittance` over
// each segment, ahead of what lies at its end, and `medium_behind` wherever it leaves a surface, interfaces included. Shadow
// rays: scene_transmittance (intersect.h).
#ifndef LAMPYRIS_KERNEL_MEDIUM
#define LAMPYRIS_KERNEL_MEDIUM

// The share of light that is left after `distance` (Beer and Lambert); over INFINITE_DISTANCE, nothing of what is absorbed at
// all.
FN Spectrum medium_transmittance(uint medium, float distance) {
    if (!HAS(EFFECT_MEDIUM) || medium == MEDIUM_VACUUM) return Spectrum(1.0f);
    return exp_of_minus(media[medium].sigma_a * distance);
}

// The medium that a geometry has on the side of its normal ng that the direction points to.
FN uint medium_on_side(uint geometry, vec3 ng, vec3 direction) {
    uint sides = geometries[geometry].media;
    return dot3(direction, ng) > 0.0f ? sides & 0xffffu : sides >> 16u;
}

// The medium of a ray that leaves s in a direction, reflected, refracted or straight on, and that came through `current`: as
// in pbrt-v4, the surface's own on that side, and the same as before where the surface is no transition between media.
FN uint medium_behind(IN(Surface) s, vec3 direction, uint current) {
    if (!HAS(EFFECT_MEDIUM)) return MEDIUM_VACUUM;
    uint sides = geometries[s.geometry].media;
    if ((sides & 0xffffu) == sides >> 16u) return current;
    return medium_on_side(s.geometry, s.ng, direction);
}

FN uint camera_medium() { return HAS(EFFECT_MEDIUM) ? scene[0].camera_medium : MEDIUM_VACUUM; }

// The medium into which a light sends in a direction. `ng` is the normal of an area light at the point, and of no account for
// other lights; as in pbrt-v4 an area light's medium is its shape's.
FN uint light_medium(uint light, vec3 ng, vec3 direction) {
    if (!HAS(EFFECT_MEDIUM)) return MEDIUM_VACUUM;
    if (lights[light].kind <= LIGHT_GEOMETRY) return medium_on_side(lights[light].geometry, ng, direction);
    return lights[light].flags >> 16u;
}

#endif
