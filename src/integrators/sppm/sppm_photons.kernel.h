// Photon pass: emits a path and keeps a photon wherever an eye path might gather: also where this path's own chance has it pass a
// mask or meet the mirror of a mix, since the eye path takes that chance, too, and it counts once.
// clang-format off
#define KERNEL_CPU_VARIANTS kAllEffects, kTexturedEffects, kGlassEffects
// clang-format on
#include "core/kernel/scene.h"

#include "core/kernel/photon_layout.h"
#include "core/kernel/photon.h"
#include "core/kernel/visible_point.h"
#include "integrators/sppm/sppm.layout.h"
#include "integrators/sppm/sppm.params.h"

BUFFER_RO(0, SppmPass, passes)
BUFFER_RO(1, SppmParams, params)
BUFFER_RW(2, PhotonRecord, photons)
BUFFER_RW(3, uint, counters)

CONST uint PHOTON_VERTEX_DIMENSIONS = 4u;
CONST uint PHOTON_STREAM = 0x5f3759dfu;  // keeps the numbers apart from those of pixels

FN bool in_box(vec3 p, vec4 low, vec4 high) {
    return p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z;
}

FN void keep_photon(vec3 position, vec3 direction, vec3 power, uint key) {
    uint at = ATOMIC_ADD_U32(counters[SPPM_STORED], 1u);
    if (at < passes[0].photons.y) photons[at] = photon_pack(position, direction, power, key);
}

KERNEL(sppm_photons) {
    SppmPass pass = passes[0];
    uint path = pass.photons.x + index;
    // Paths of one pass are a stratified set: the path is the sample, the pass takes the pixel's place.
    Sampler numbers = sampler_begin(pass.photons.z, path, pass.photons.w ^ PHOTON_STREAM, pass.counts.y);
    uint u_choice = 0u;
    if (scene[0].lights.x > 1u) u_choice = sample_bits_1d_at(numbers, 0u);
    uvec2 u_direction = sample_bits_2d_at(numbers, 4u);
    Emission start;
    if (!emit_photon(u_choice, sample_1d_at(numbers, 1u), sample_2d_at(numbers, 2u), u_direction, start)) return;
    vec3 origin = start.origin;
    vec3 direction = start.direction;
    vec3 power = start.power / float(pass.counts.x);
    uint rays = 0u;
    int depth = 0;
    uint kept = 0u;
    uint passed = 0u;  // interfaces and masks
    uint medium = start.medium;
    uint vertices = uint(params[0].maxdepth) + MAX_PASSED_SURFACES + 1u;  // more than a path has
    uint vertex = 0u;
    while (vertex < vertices) {
        vertex = vertices;
        Surface s;
        uint fate;
        if (!intersect_next(origin, direction, s, fate, rays)) break;
        if (HAS(EFFECT_MEDIUM)) power *= medium_transmittance(medium, s.distance);
        if (HAS(EFFECT_MEDIUM) && is_black(power)) break;
        if (fate != SURFACE_ABSENT && material_may_gather(s.material, params[0].glossy) &&
            (depth > 0 || pass.keep.x == SPPM_KEEP_ALL) && in_box(s.position, pass.low, pass.high)) {
            keep_photon(s.position, direction, power, photon_key(index, kept, pass.counts.w));
            kept += 1u;
        }
        bool crosses = HAS(EFFECT_INTERFACE) && fate == SURFACE_STOPS && is_interface(s);
        if (crosses || fate != SURFACE_STOPS) {
            origin = origin_beyond(s.position, s.way, direction);
            if (crosses) medium = medium_behind(s, direction, medium);
            if (++passed > MAX_PASSED_SURFACES) {
                REPORT_UNFINISHED();
                break;
            }
            vertex = uint(depth) + passed;
            continue;
        }
        vec3 ng = s.ng;
        Frame frame;
        Bsdf bsdf = material_bsdf(s, -direction, frame);
        uint action = visible_action(bsdf, params[0].glossy);
        // What is reflected here is no caustic, but for the smooth coat over it: that is known once a lobe is chosen.
        if (depth >= params[0].maxdepth || (pass.keep.x == SPPM_KEEP_CAUSTIC && action == VISIBLE_GATHER)) break;
        uint dimension = EMISSION_DIMENSIONS + uint(depth) * PHOTON_VERTEX_DIMENSIONS;
        depth += 1;

        // wo is where the light comes from: importance flows as a camera's path does.
        vec3 wo = to_local(frame, -direction);
        BsdfSample next;
        float u_lobe = 0.0f;
        if (bsdf_chooses_lobe(bsdf)) u_lobe = sample_1d_at(numbers, dimension);
        if (!bsdf_sample(bsdf, wo, u_lobe, sample_2d_at(numbers, dimension + 1u), TRANSPORT_IMPORTANCE, next)) break;
        if (pass.keep.x == SPPM_KEEP_CAUSTIC && action == VISIBLE_SPLIT && (next.lobe & LOBE_SPECULAR) == 0u) break;
        vec3 onward = unit(to_world(frame, next.wi));
        // Shading normals are not symmetric (Veach 1997, equation 5.19): |wi.Ns wo.Ng| / (|wi.Ng| |wo.Ns|), of which |wo.Ns|
        // cancels the cosine of the weight. wi is towards the light, wo onward.
        float towards = abs_dot(direction, ng);
        if (!(towards > 0.0f)) break;
        vec3 weight = next.f * (abs(wo.z) * abs_dot(onward, ng) / (towards * next.pdf));
        float before = max_component(power);
        power *= weight;
        float after = max_component(power);
        if (!(after > 0.0f) || !is_finite(after)) break;
        // Photons keep about the power that they had: few, bright ones would be noise.
        float survival = after / before;
        if (survival < 1.0f) {
            survival = exact_chance(survival);
            if (sample_1d_at(numbers, dimension + 3u) >= survival) break;
            power = power / survival;
        }
        direction = onward;
        origin = offset_origin(s.position, s.error, ng, direction);
        medium = medium_behind(s, direction, medium);
        vertex = uint(depth) + passed;
    }
    if (vertex != vertices) REPORT_UNFINISHED();  // the driver ended the loop
    if (HAS(EFFECT_ALPHA) && kept > counters[SPPM_MOST_KEPT]) ATOMIC_MAX_U32(counters[SPPM_MOST_KEPT], kept);
    ATOMIC_ADD_U32(counters[SPPM_RAYS], rays);
}
