// Data that the kernels of progressive photon mapping share: hit points, gathered flux, and the description of a pass.
#ifndef LAMPYRIS_LAYOUT
#define LAMPYRIS_LAYOUT

// Where an eye path ended: its last ray and the primitive that it hit, from which the surface is recomputed, so that a
// record is short and the gather kernel traces no rays. Its position and radius are in `queries`.
struct HitPointRecord {  // hit_record.h has functions that unpack it
    uvec4 origin;        // of the last ray (bits of floats); w: instance
    uvec4 direction;     // bits of floats; w: geometry
    vec4 throughput;     // rgb; w: weight of the pixel filter
    vec4 radiance;       // rgb: emission before the hit point, and direct light there; w: radius of the first pass
    uvec4 more;  // primitive, minimum radius (bits), medium of the last ray, vertex number on the eye path (from 1)
};

// What the kernels need of an integrator's parameters, which document them.
struct PhotonPathParams {
    int maxdepth;
    int rrdepth;
    float radius;
    float footprint;
    float minradius;
    float alpha;
    uint schedule;  // SCHEDULE_*
    uint direct;    // DIRECT_*
    float glossy;
};

struct PhotonPass {
    uint first_path;  // first path of this part of the pass
    uint capacity;    // photons that fit into the store
    uint number;      // of the pass
    uint seed;
    uint paths;         // number of paths emitted in the pass
    uint sampler_kind;  // SAMPLER_*
    uint points;        // hit points per pixel
    uint part_paths;    // number of paths in a build of the map (for keys)
    vec4 low;           // photons are kept only within this box
    vec4 high;
    float squared_scale;  // memoryless: squared radius over that of the first pass, for all hit points
    uint keep;            // which photons: SPPM_KEEP_*
    uint branches;        // hit points per eye path
    uint unused;
};

// Words of `counters`.
CONST uint PHOTONS_STORED = 0u;  // number of photons, including those that did not fit
CONST uint PHOTON_RAYS = 1u;
// Maximum number of photons of a path. Counted only with masks, where it may exceed the number of vertices.
CONST uint PHOTONS_MOST_KEPT =
    2u;  // photons of one path; counted where masks let a path leave more than it has vertices
// The box of the hit points, padded by their radii: of the lower corner the complement, so that zero is less than anything.
CONST uint HIT_BOX_LOW = 3u;
CONST uint HIT_BOX_HIGH = 6u;
CONST uint HIT_LARGEST_RADIUS = 9u;  // the largest radius (bits)
CONST uint PHOTON_COUNTERS = 12u;

// Smaller cosines of arriving photons count as this one, because |wi.Ns| / |wi.Ng| is not bounded.
CONST float GRAZING_COSINE = 1e-2f;

CONST uint SCHEDULE_SHARED = 0u;
CONST uint SCHEDULE_MEMORYLESS = 1u;
CONST uint DIRECT_NEE = 0u;
CONST uint DIRECT_PHOTONS = 1u;

CONST uint KEEP_ALL = 0u;
CONST uint KEEP_BOUNCED = 1u;  // not those that come directly from a light
CONST uint KEEP_CAUSTIC = 2u;  // only those that come from a light over one or more specular (followed) surfaces

#endif
