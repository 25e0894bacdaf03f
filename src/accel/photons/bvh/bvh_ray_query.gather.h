// The device's ray tracer finds the photons whose boxes contain the query point: a ray of almost no length hits the
// boxes in which it starts. The boxes only select the photons to test; in_range decides.
#include "core/kernel/gather.h"
#include "accel/photons/bvh/bvh_layout.h"

BUFFER_RO(1, TreeRecord, tree)
layout(set = 1, binding = 2) uniform accelerationStructureEXT boxes;
BUFFER_RO(3, uvec4, places)
BUFFER_RO(4, uvec4, fluxes)

KERNEL(bvh_ray_query) {
    vec4 q = queries[index];
    if (q.w < 0.0f) return;
    Gathered gathered = gather_begin(index);
    uint count = tree[0].count;
    // If the boxes are too small for this query, every photon is tested.
    bool large = q.w > tree[0].radius.x;
    // No component of the direction is 0, because drivers multiply by its inverse. In floats, the ray ends where it
    // starts.
    rayQueryEXT ray;
    rayQueryInitializeEXT(ray, boxes, gl_RayFlagsNoneEXT, 0xffu, vec3(q), 0.0f, vec3(1.0f), 1e-30f);
    bool finished = false;
    uint next = 0u;
    uint end = 0u;
    for (; !finished; ++next) {
        finished = large ? next == count : !rayQueryProceedEXT(ray);
        if (finished) {
            end = next + 1u;
            continue;
        }
        uint i = large ? next : uint(rayQueryGetIntersectionPrimitiveIndexEXT(ray, false));
        uvec4 place = places[i];
        float d2;
        if (!in_range(place_position(place), vec3(q), q.w, d2)) continue;
        PhotonRecord photon;
        photon.place = place;
        photon.flux = fluxes[i];
        gather_add(gathered, index, photon, d2, 1.0f);
    }
    if (next != end) REPORT_UNFINISHED();  // the driver ended the loop
    gather_end(gathered, index);
}
