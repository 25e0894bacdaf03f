// What the kernels of progressive photon mapping share: hit points, what they gather, and what a pass is.
#ifndef LAMPYRIS_LAYOUT
#define LAMPYRIS_LAYOUT

// Where an eye path stopped: the ray and the primitive that it met, from which the surface is found again, so that a record is
// short and the gather kernel traces nothing. Its place and radius are in `queries`.
struct HitPointRecord {  // hit_record.h names what is packed
    uvec4 origin;        // of the last ray (floats' bits); w: instance
    uvec4 direction;     // floats' bits; w: geometry
    vec4 throughput;     // rgb; w: weight of the pixel filter
    vec4 radiance;       // rgb: found on the way, and direct light at the hit point; w: radius of the first pass
    uvec4 more;  // primitive, least radius (bits), medium it was reached through, its number on the eye path (from 1)
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
    uint first_path;  // of this part
    uint capacity;    // photons that fit
    uint number;      // of the pass
    uint seed;
    uint paths;         // emitted in the pass
    uint sampler_kind;  // SAMPLER_*
    uint points;        // hit points a pixel; FilmWindow counts passes where there is one, these where there are more
    uint part_paths;    // in a build of the map (keys)
    vec4 low;           // photons are kept within this box
    vec4 high;
    float squared_scale;  // squared radius over that of the first pass, where passes have the same one (memoryless)
    uint keep;            // which photons: SPPM_KEEP_*
    uint branches;        // hit points of one eye path
    uint unused;
};

// Words of `counters`.
CONST uint PHOTONS_STORED = 0u;  // photons, also those that did not fit
CONST uint PHOTON_RAYS = 1u;
CONST uint PHOTONS_MOST_KEPT =
    2u;  // photons of one path; counted where masks let a path leave more than it has vertices
// The box of the hit points, padded by their radii: of the lower corner the complement, so that zero is less than anything.
CONST uint HIT_BOX_LOW = 3u;
CONST uint HIT_BOX_HIGH = 6u;
CONST uint HIT_LARGEST_RADIUS = 9u;  // the largest (bits)
CONST uint PHOTON_COUNTERS = 12u;

// Photons that arrive flatter than this count as if they did not: |wi.Ns| / |wi.Ng| has no bound.
CONST float GRAZING_COSINE = 1e-2f;

CONST uint SCHEDULE_SHARED = 0u;
CONST uint SCHEDULE_MEMORYLESS = 1u;
CONST uint DIRECT_NEE = 0u;
CONST uint DIRECT_PHOTONS = 1u;

CONST uint KEEP_ALL = 0u;
CONST uint KEEP_BOUNCED = 1u;  // not those that come straight from a light
CONST uint KEEP_CAUSTIC = 2u;  // those that come from a light over specular (followed) surfaces only, one or more

#endif
