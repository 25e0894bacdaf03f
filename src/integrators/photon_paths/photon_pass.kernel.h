// Photon pass: emits a path, and keeps a photon wherever an eye path might gather. It does so even if this path's
// random choice passes a mask, or finds a mirror in a mix: the eye path makes that choice, too, and it must count only
// once.
#include "core/kernel/scene.h"

#include "core/kernel/photon_layout.h"
#include "core/kernel/photon.h"
#include "core/kernel/visible_point.h"
#include "integrators/photon_paths/photon_paths_layout.h"

BUFFER_RO(0, PhotonPass, passes)
BUFFER_RO(1, PhotonPathParams, params)
BUFFER_RW(2, PhotonRecord, photons)
BUFFER_RW(3, uint, counters)

CONST uint PHOTON_STREAM = 0x5f3759dfu;  // makes the random numbers independent of those of pixels
// The random numbers of a vertex.
CONST uint PHOTON_LOBE = 0u;
CONST uint PHOTON_DIRECTION = 1u;
CONST uint PHOTON_ROULETTE = 3u;
CONST uint PHOTON_VERTEX_DIMENSIONS = 4u;

FN bool in_box(vec3 p, vec4 low, vec4 high) {
    return p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z;
}

FN void keep_photon(vec3 position, vec3 direction, Spectrum power, uint key) {
    uint at = ATOMIC_ADD_U32(counters[PHOTONS_STORED], 1u);
    if (at < passes[0].capacity) photons[at] = photon_pack(position, direction, power, key);
}

KERNEL(photon_pass) {
    PhotonPass pass = passes[0];
    uint path = pass.first_path + index;
    PATH_LOG(log_path(LOG_LIGHT_PATH, path, 0u));
    // The paths of a pass are a stratified set: the path is the sampler's sample, and the pass its pixel.
    Sampler numbers = sampler_begin(pass.number, path, pass.seed ^ PHOTON_STREAM, pass.sampler_kind);
    uint u_choice = 0u;
    if (scene[0].light_count > 1u) u_choice = sample_bits_1d_at(numbers, 0u);
    uvec2 u_direction = sample_bits_2d_at(numbers, 4u);
    Emission start;
    if (!emit_photon(u_choice, sample_1d_at(numbers, 1u), sample_2d_at(numbers, 2u), u_direction, start)) return;
    Walk walk =
        walk_begin(ray_of(start.origin, start.direction), start.medium, TRANSPORT_IMPORTANCE, params[0].maxdepth);
    walk.throughput = start.power / float(pass.paths);
    uint kept = 0u;
    Surface s;
    uint fate;
    while (walk_next_or_mask(walk, s, fate)) {
        if (HAS(EFFECT_MEDIUM) && is_black(walk.throughput)) break;
        if (fate != SURFACE_ABSENT && material_may_gather(s.material, params[0].glossy) &&
            (walk.depth > 0 || pass.keep == KEEP_ALL) && in_box(s.position, pass.low, pass.high)) {
            keep_photon(s.position, walk.ray.direction, walk.throughput, photon_key(index, kept, pass.part_paths));
            kept += 1u;
        }
        if (walk_crosses_or_passes(walk, s, fate)) continue;
        Vertex v = walk_vertex(walk, s);
        uint action = bsdf_visible_action(v.bsdf, params[0].glossy);
        // Light that is reflected here is no caustic, except by a smooth coat, which is known only once a lobe is
        // chosen.
        bool ends = pass.keep == KEEP_CAUSTIC && action == VISIBLE_GATHER;
        if (walk.depth >= walk.maxdepth || ends) break;

        // v.wo points to where the light comes from: photons sample the BSDF as a camera path does, but for importance.
        uint dimension = EMISSION_DIMENSIONS + uint(walk.depth) * PHOTON_VERTEX_DIMENSIONS;
        BsdfSample next;
        float u_lobe = 0.0f;
        if (bsdf_chooses_lobe(v.bsdf)) u_lobe = sample_1d_at(numbers, dimension + PHOTON_LOBE);
        vec2 u_direction = sample_2d_at(numbers, dimension + PHOTON_DIRECTION);
        if (!bsdf_sample(v.bsdf, v.wo, u_lobe, u_direction, TRANSPORT_IMPORTANCE, next)) break;
        if (pass.keep == KEEP_CAUSTIC && action == VISIBLE_SPLIT && (next.lobe & LOBE_SPECULAR) == 0u) break;
        if (!walk_leave(walk, s, v, next, 0, numbers, dimension + PHOTON_ROULETTE)) break;
    }
    if (HAS(EFFECT_ALPHA) && kept > counters[PHOTONS_MOST_KEPT]) ATOMIC_MAX_U32(counters[PHOTONS_MOST_KEPT], kept);
    ATOMIC_ADD_U32(counters[PHOTON_RAYS], traced_rays[0]);
}
