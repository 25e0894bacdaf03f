// Homogeneous absorbing media: their transmittance, and which one a ray is in.
//
// A path or photon needs three lines: the medium where it starts (camera_medium, light_medium), `medium_transmittance`
// over each segment, before the surface at its end is evaluated, and `medium_behind` whenever it leaves a surface, also
// an interface. For shadow rays, see scene_transmittance (intersect.h).
#ifndef LAMPYRIS_KERNEL_MEDIUM
#define LAMPYRIS_KERNEL_MEDIUM

// The fraction of light that is left after `distance` (Beer-Lambert law). Over INFINITE_DISTANCE it is 0 for every
// channel that the medium absorbs.
FN Spectrum medium_transmittance(uint medium, float distance) {
    if (!HAS(EFFECT_MEDIUM) || medium == MEDIUM_VACUUM) return Spectrum(1.0f);
    return exp_of_minus(media[medium].sigma_a * distance);
}

// A geometry's medium on the side of its normal ng to which the direction points.
FN uint medium_on_side(uint geometry, vec3 ng, vec3 direction) {
    uint sides = geometries[geometry].media;
    return dot3(direction, ng) > 0.0f ? sides & 0xffffu : sides >> 16u;
}

// The medium of a ray that leaves s in a direction (reflected, refracted or straight on), and that reached s through
// `current`. As in pbrt-v4, it is the surface's own medium on that side, or `current` if the surface is not a boundary
// between media.
FN uint medium_behind(IN(Surface) s, vec3 direction, uint current) {
    if (!HAS(EFFECT_MEDIUM)) return MEDIUM_VACUUM;
    uint sides = geometries[s.geometry].media;
    if ((sides & 0xffffu) == sides >> 16u) return current;
    return medium_on_side(s.geometry, s.ng, direction);
}

FN uint camera_medium() { return HAS(EFFECT_MEDIUM) ? scene[0].camera_medium : MEDIUM_VACUUM; }

// The medium into which a light emits in a direction. `ng` is an area light's normal at the point; other lights ignore
// it. As in pbrt-v4, an area light's medium is that of its shape.
FN uint light_medium(uint light, vec3 ng, vec3 direction) {
    if (!HAS(EFFECT_MEDIUM)) return MEDIUM_VACUUM;
    if (lights[light].kind <= LIGHT_GEOMETRY) return medium_on_side(lights[light].geometry, ng, direction);
    return lights[light].flags >> 16u;
}

#endif
