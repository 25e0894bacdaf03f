// Records of the path log, which the host reads after a replay (core/render/path_log.h).
#ifndef LAMPYRIS_KERNEL_PATH_LOG_LAYOUT
#define LAMPYRIS_KERNEL_PATH_LOG_LAYOUT

// What happened to a path. Colours are linear Rec. 709.
struct PathLogRecord {
    uint event;  // LOG_*
    uint kind;   // LOG_CAMERA_PATH, ...
    uint path;   // its number among those of its kind
    uint order;  // of the event on its path
    uint depth;  // scattering vertices before it
    uint s;      // strategy: vertices from the light and from the camera; or NONE
    uint t;
    uint light;     // or NONE
    uint partner;   // light path that is connected or merged, or NONE
    uint detail;    // depends on the event
    uint material;  // MATERIAL_*, or NONE
    uint medium;
    vec3 position;
    float distance;
    vec3 normal;
    float pdf;
    vec3 direction;
    float weight;  // of multiple importance sampling
    vec3 throughput;
    float factor;  // contribution to the pixel over value times weight; LOG_SAMPLE: further factor of a path's
    vec3 value;    // radiance, unweighted
    float extra;
};

// The first record is a header with other meanings: `event` counts the records, those that did not fit included; `kind` is their
// largest number; `path` is one of LOG_MODE_*; the photons' keys are those of the `depth` light paths from number `order` on.

CONST uint LOG_MODE_OFF = 0u;
CONST uint LOG_MODE_PIXEL = 1u;        // what belongs to the pixel
CONST uint LOG_MODE_LIGHT_PATHS = 2u;  // the walks of light paths, which the host runs again one by one

CONST uint LOG_CAMERA_PATH = 0u;
CONST uint LOG_LIGHT_PATH = 1u;
CONST uint LOG_CHAIN = 2u;  // of Metropolis light transport

CONST uint LOG_START = 0u;     // a ray leaves the camera, or the light (pdf: of the place; extra: of the direction)
CONST uint LOG_VERTEX = 1u;    // a surface is reached, by a ray in `direction` with `throughput`
CONST uint LOG_SCATTER = 2u;   // in `direction`; pdf: of it; detail: LOBE_*; extra: relative refractive index
CONST uint LOG_ROULETTE = 3u;  // extra: chance to go on; detail: 1 if the path ends
CONST uint LOG_PASS = 4u;      // straight on; detail: LOG_PASS_*
CONST uint LOG_ESCAPE = 5u;    // the ray leaves the scene
CONST uint LOG_EMISSION = 6u;  // a path finds light; light NONE: the environment
CONST uint LOG_LIGHT = 7u;  // next-event estimation; pdf: of the light sample; extra: of the BSDF; detail: LOG_SEEN_*
CONST uint LOG_CONNECTION = 8u;  // to a vertex of a light path; detail: LOG_SEEN_*
CONST uint LOG_SPLAT = 9u;   // to the lens; of chains: pdf: luminance of the path, extra: times that the path counts
CONST uint LOG_MERGE = 10u;  // with a photon; throughput: its power; extra: photons that it stands for; detail: its key
CONST uint LOG_DISCARD = 11u;  // what the path has found so far is counted elsewhere
CONST uint LOG_SAMPLE = 12u;   // the path's contributions become a sample of the pixel
CONST uint LOG_MUTATION =
    13u;  // a chain's proposal; detail: 1 if large; extra: chance of acceptance; weight: 1 if accepted

CONST uint LOG_PASS_MASK = 0u;
CONST uint LOG_PASS_INTERFACE = 1u;

CONST uint LOG_SEEN_CLEARLY = 0u;
CONST uint LOG_SEEN_OCCLUDED = 1u;
CONST uint LOG_SEEN_UNSCATTERED = 2u;  // a BSDF is 0

// First numbers of events that are written after a path's walk, in other kernels.
CONST uint LOG_ORDER_LATER = 0x40000000u;
CONST uint LOG_ORDER_MERGE = 0x80000000u;
CONST uint LOG_ORDER_SAMPLE = 0xc0000000u;

#endif
