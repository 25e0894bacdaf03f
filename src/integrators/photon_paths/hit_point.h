// A hit point for consumers of photons: the surface, recomputed from its record, and the contribution of a photon
// there.
#ifndef LAMPYRIS_HIT_POINT
#define LAMPYRIS_HIT_POINT

#include "core/kernel/visible_point.h"
#include "integrators/photon_paths/hit_record.h"

struct HitPoint {
    Vertex vertex;
    vec3 ng;  // on the eye's side
    uint both_sides;
};

FN HitPoint no_hit_point() {
    HitPoint p;
    p.vertex.bsdf = no_bsdf();
    p.vertex.frame = frame_from_z(vec3(0.0f, 0.0f, 1.0f));
    p.vertex.wo = vec3(0.0f);
    p.ng = vec3(0.0f);
    p.both_sides = 0u;
    return p;
}

FN Surface hit_surface(IN(HitPointRecord) h) {
    Hit hit;
    hit.instance = hit_instance(h);
    hit.geometry = hit_geometry(h);
    hit.primitive = hit_primitive(h);
    Surface s = no_surface();
    surface_at(hit, hit_origin(h), hit_direction(h), s);
    return s;
}

FN Vertex hit_vertex(IN(HitPointRecord) h, OUT(Surface) s) {
    s = hit_surface(h);
    return vertex_at(s, hit_direction(h));
}

FN HitPoint hit_point(IN(HitPointRecord) h) {
    vec3 direction = hit_direction(h);
    Surface s = hit_surface(h);
    HitPoint p;
    p.ng = dot3(s.ng, direction) > 0.0f ? -s.ng : s.ng;
    p.vertex = vertex_at(s, direction);
    p.both_sides = bsdf_transmits(p.vertex.bsdf) ? 1u : 0u;
    return p;
}

// Photons on the back of a thin wall do not count on this side. `cosine`: between the direction they come from and
// p.ng.
FN bool hit_point_sees(IN(HitPoint) p, float cosine) { return p.both_sides != 0u || cosine > 0.0f; }

// The BSDF times the photon's power; w: the number of photons that it represents. Zero if the photon is on the other
// side.
FN vec4 hit_point_reflects(IN(HitPoint) p, IN(PhotonRecord) photon, float weight) {
    vec3 incident = -photon_direction(photon);
    float cosine = dot3(incident, p.ng);
    if (!hit_point_sees(p, cosine)) return vec4(0.0f);
    vec3 wi = to_local(p.vertex.frame, incident);
    Spectrum f = bsdf_eval(p.vertex.bsdf, p.vertex.wo, wi, TRANSPORT_RADIANCE);
    // Photons are counted on the geometric surface, but the BSDF needs the shading normal's cosine (clamped if
    // grazing).
    Spectrum value = f * photon_power(photon) * (weight * abs(wi.z) / max(abs(cosine), GRAZING_COSINE));
    return slot_of(value, weight);
}

#endif
