// Follows a path from a light: connects each vertex to the camera (strategies t = 1), stores it for the camera paths that connect to
// it, and keeps a photon wherever one may merge with it.
#include "core/kernel/scene.h"

#include "core/kernel/film.h"
#include "core/kernel/photon.h"
#include "core/kernel/visible_point.h"
#include "integrators/bidirectional/bidirectional_layout.h"

BUFFER_RO(0, FilmWindow, window)
BUFFER_RO(1, BidirectionalPass, passes)
BUFFER_RW(2, uint, splats)
BUFFER_RW(3, uint, counters)
BUFFER_RW(4, PathVertexRecord, vertices)
BUFFER_RW(5, uint, last_vertices)  // of each path of this part: slot of the last vertex, or NONE
BUFFER_RW(6, PhotonRecord, photons)
BUFFER_RW(7, vec4, photon_sums)  // by the photons' keys: MisSums, and the number of the scattering vertex

#include "integrators/bidirectional/lens_connection.h"
#include "integrators/bidirectional/path_vertex.h"
#include "integrators/bidirectional/connect.h"

// Adds to the picture what the light path shows at the vertex. True if the camera sees it.
FN bool splat_vertex(IN(Subpath) path, IN(Surface) s, IN(Vertex) v, IN(Sampler) numbers, uint dimension) {
    LensConnection c;
    if (!lens_connect(s, numbers, dimension, c)) return false;
    Spectrum value = connect_to_lens(path, s, v, c.camera);
    if (is_black(value)) return false;
    BidirectionalPass pass = passes[0];
    lens_splat(c, value, float(pass.paths), pass.brightness, pass.quantum, numbers, dimension);
    return true;
}

// Keeps a photon. Any leaf of a mix may gather it, whatever leaf this path goes on with: the camera path makes that choice.
FN void keep_photon(IN(Subpath) path, IN(Surface) s, uint index, uint number) {
    BidirectionalPass pass = passes[0];
    uint slot = ATOMIC_ADD_U32(counters[PHOTONS_KEPT], 1u);
    uint key = photon_key(index - pass.first_path, number, pass.part_paths);
    if (slot < pass.photon_capacity)
        photons[slot] = photon_pack(s.position, path.walk.ray.direction, path.walk.throughput / float(pass.paths), key);
    if (number < pass.sums_capacity / pass.part_paths)
        photon_sums[key] = vec4(path.mis.a, path.mis.d, float(path.walk.depth + 1), 0.0f);
}

KERNEL(light_subpaths) {
    BidirectionalPass pass = passes[0];
    uint slot = NONE;
    uint rank = 0u;
    uint splatted = 0u;
    uint kept = 0u;
    uint deepest = 0u;
    Sampler numbers = light_path_numbers(index, pass.number, pass.seed, pass.sampler_kind);
    Emission start;
    PATH_LOG(log_path(LOG_LIGHT_PATH, index, 0u));
    if (light_path_emits(numbers, start)) {
        Subpath path = light_path_begin(start, pass.maxdepth);
        Surface s;
        while (walk_next(path.walk, s)) {
            if (HAS(EFFECT_MEDIUM) && is_black(path.walk.throughput)) break;
            if (walk_crosses(path.walk, s)) continue;
            if (path.walk.depth >= path.walk.maxdepth) break;
            if (path.walk.depth == 0) light_path_meets_first(path, start, s);
            subpath_arrives(path, s);
            if (pass.eta > 0.0f && material_may_gather(s.material, 0.0f)) {
                keep_photon(path, s, index, kept);
                kept += 1u;
            }
            Vertex v = walk_vertex(path.walk, s);
            uint dimension = light_vertex_dimension(path.walk);
            int depth = path.walk.depth + 1;
            if (pass.strategies == STRATEGIES_ALL && !bsdf_is_specular(v.bsdf)) {
                if (pass.splats != 0u && strategy_wanted(depth + 1, 1) && splat_vertex(path, s, v, numbers, dimension))
                    splatted += 1u;
                if (depth < pass.maxdepth && pass.connections != 0) {
                    uint place = ATOMIC_ADD_U32(counters[LIGHT_VERTICES], 1u);
                    rank += 1u;
                    deepest = uint(depth);
                    if (place < pass.capacity)
                        vertices[place] = path_vertex_record(path.walk.ray, s, path.walk.throughput, path.mis,
                                                             uint(depth), rank, slot);
                    slot = place;
                }
            }
            BsdfSample next;
            float density;
            float u_lobe = light_path_u_lobe(v, numbers, dimension);
            vec2 u_direction = sample_2d_at(numbers, dimension + LIGHT_DIRECTION);
            if (!bsdf_sample_density(v.bsdf, v.wo, u_lobe, u_direction, TRANSPORT_IMPORTANCE, next, density)) break;
            if (!subpath_leaves(path, s, v, next, density, pass.rrdepth, numbers, dimension + LIGHT_ROULETTE)) break;
        }
    }
    last_vertices[index - pass.first_path] = slot;
    ATOMIC_ADD_U32(counters[LIGHT_RAYS], traced_rays[0]);
    if (kept > counters[MOST_PHOTONS]) ATOMIC_MAX_U32(counters[MOST_PHOTONS], kept);
    if (deepest > counters[DEEPEST_VERTEX]) ATOMIC_MAX_U32(counters[DEEPEST_VERTEX], deepest);
    if (splatted != 0u) ATOMIC_ADD_U32(counters[LIGHT_SPLATS], splatted);
}
