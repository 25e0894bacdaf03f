// Photons: packing, and the range test of all structures.
#ifndef LAMPYRIS_KERNEL_PHOTON
#define LAMPYRIS_KERNEL_PHOTON

#include "core/kernel/prelude.h"
#include "core/kernel/layout.h"
#include "core/kernel/photon_layout.h"
#include "core/kernel/math.h"
#include "core/kernel/spectrum.h"
#include "core/kernel/random.h"

// Octahedral map (Meyer et al. 2010), 16 bits per coordinate: an unpacked direction is off by less than 7e-5 radians,
// and exact on the axes.
FN uint direction_pack(vec3 d) {
    float l1 = abs(d.x) + abs(d.y) + abs(d.z);
    float x = d.x / l1;
    float y = d.y / l1;
    if (d.z < 0.0f) {
        float fold = copy_sign(1.0f - abs(y), x);
        y = copy_sign(1.0f - abs(x), y);
        x = fold;
    }
    uint a = uint(floor(clamp(x, -1.0f, 1.0f) * 32767.0f + 32768.5f));
    uint b = uint(floor(clamp(y, -1.0f, 1.0f) * 32767.0f + 32768.5f));
    return (b << 16u) | a;
}
FN vec3 direction_unpack(uint bits) {
    float x = (float(bits & 0xffffu) - 32768.0f) / 32767.0f;
    float y = (float(bits >> 16u) - 32768.0f) / 32767.0f;
    float z = 1.0f - abs(x) - abs(y);
    if (z < 0.0f) {
        float fold = copy_sign(1.0f - abs(y), x);
        y = copy_sign(1.0f - abs(x), y);
        x = fold;
    }
    return unit(vec3(x, y, z));
}

FN PhotonRecord photon_pack(vec3 position, vec3 direction, Spectrum power, uint key) {
    PhotonRecord p;
    p.place = uvec4(floatBitsToUint(position.x), floatBitsToUint(position.y), floatBitsToUint(position.z), key);
    p.flux = uvec4(direction_pack(direction), floatBitsToUint(power[0]), floatBitsToUint(power[1]),
                   floatBitsToUint(power[2]));
    return p;
}
// The key of a path's photon `number`: unique if (number + 1) * paths <= 2^32.
FN uint photon_key(uint path, uint number, uint paths) { return number * paths + path; }
FN vec3 place_position(uvec4 place) {
    return vec3(uintBitsToFloat(place.x), uintBitsToFloat(place.y), uintBitsToFloat(place.z));
}
FN vec3 photon_position(IN(PhotonRecord) p) { return place_position(p.place); }
FN vec3 photon_direction(IN(PhotonRecord) p) { return direction_unpack(p.flux.x); }  // of flight, towards the surface
FN Spectrum photon_power(IN(PhotonRecord) p) {
    return Spectrum(uintBitsToFloat(p.flux.y), uintBitsToFloat(p.flux.z), uintBitsToFloat(p.flux.w));
}

// The range test that every structure uses. A radius below 3e-19 counts as 3e-19: smaller squares underflow, and not
// equally on every device.
CONST float SMALLEST_RADIUS_SQUARED = 1e-37f;
FN bool in_range(vec3 position, vec3 query, float radius, OUT(float) distance_squared) {
    vec3 d = position - query;
    distance_squared = d.x * d.x + d.y * d.y + d.z * d.z;
    return distance_squared <= max(radius * radius, SMALLEST_RADIUS_SQUARED);
}
// Bound, per coordinate, of the distance of a photon in range from the query. It includes the rounding of in_range, and
// its smallest radius.
FN float range_reach(float radius) { return max(radius * 1.000001f, 4e-19f); }

#endif
