// What the kernels of bidirectional methods share.
#ifndef LAMPYRIS_BIDIRECTIONAL_LAYOUT
#define LAMPYRIS_BIDIRECTIONAL_LAYOUT

// A vertex of a path that is kept to be joined with paths from the other end: the last ray and the primitive that it hit, from
// which the surface is computed again, and what the path carries. The vertices of a path are linked from the last to the first.
struct PathVertexRecord {  // path_vertex.h has functions that unpack it
    uvec4 origin;          // of the ray (bits of floats); w: instance
    uvec4 direction;       // bits of floats; w: geometry
    uvec4 more;            // primitive, slot of the previous vertex or NONE, depth << 16 | rank, MisSums::a (bits)
    vec4 throughput;       // w: MisSums::d
};

// One pass, or a part of it: the light paths first_path to first_path + part_paths - 1, and the camera paths that connect to
// them.
struct BidirectionalPass {
    uint number;
    uint seed;
    uint sampler_kind;  // SAMPLER_*
    uint paths;         // from lights, in the pass
    uint first_path;
    uint part_paths;
    uint capacity;  // light vertices that can be stored
    uint splats;    // 1: light paths are connected to the camera; 0: not again
    int maxdepth;
    int rrdepth;
    int connections;  // of a camera vertex with its light path; negative: to all vertices
    uint cache;       // light paths, chosen at random, to which it is connected at each depth; 0: to one, at all
    int deepest;      // scattering vertices of the longest light path of the part
    uint weights;     // WEIGHTS_*
    int only_light;   // strategy to render, as counts of vertices; negative: any
    int only_camera;
    float quantum;       // of splats (splat.h), in units of radiance
    float brightness;    // a splat times this is about the radiance of a pixel: what the sensor's clamp compares
    float film_density;  // density, per pixel, of the film points of its camera rays: above 1 if the filter is narrower
    uint strategies;     // STRATEGIES_*
    float radius;        // within which vertices are merged, in scene units
    float eta;           // of merging, for weights (mis.h); 0: vertices are not merged
    uint photon_capacity;
    uint sums_capacity;  // of photon_sums
    uint query_capacity;
    float samples;  // of each strategy that connects two vertices, for each camera path: `cache`, or 1
    uint features;  // 1: camera paths add the features of their first hits to the film; 0: not again
    uint shares;    // 1: `shares` adds up what each class of strategies contributes
};

CONST uint STRATEGIES_ALL = 0u;
// Nothing is connected: vertices are merged, and light is seen over specular surfaces.
CONST uint STRATEGIES_MERGING = 1u;

CONST uint WEIGHTS_BALANCE = 0u;
CONST uint WEIGHTS_POWER = 1u;
CONST uint WEIGHTS_NONE = 2u;  // each strategy as if it were alone

// Words of `counters`.
CONST uint LIGHT_VERTICES = 0u;  // stored, including those that did not fit
CONST uint LIGHT_RAYS = 1u;
CONST uint LIGHT_SPLATS = 2u;  // connections to the camera that were unoccluded
CONST uint CONNECTIONS_TRIED = 3u;
CONST uint CONNECTIONS_VISIBLE = 4u;
CONST uint PHOTONS_KEPT = 5u;    // including those that did not fit
CONST uint MOST_PHOTONS = 6u;    // of one path
CONST uint MERGE_QUERIES = 7u;   // including those that did not fit
CONST uint DEEPEST_VERTEX = 8u;  // depth of the deepest one that was stored
CONST uint BIDIRECTIONAL_COUNTERS = 9u;

#endif
