// Makes the Bsdf at a point that the test describes.
#include "core/kernel/scene.h"

struct MaterialProbe {
    uvec4 what;  // material, geometry
    vec4 position;
    vec4 ng;
    vec4 ns;
    vec4 dpdu;
    vec4 dpdv;
    vec4 dndu;
    vec4 dndv;
    vec4 uv;
    vec4 wo;
};

struct MaterialAnswer {
    uvec4 what;  // kind, material, flags, max_depth
    vec4 color0;
    vec4 color1;
    vec4 albedo;
    vec4 alpha;  // of the interface, of the base
    vec4 coat;   // eta, thickness, g, opacity of the geometry here
    vec4 frame_x;
    vec4 frame_z;
};

BUFFER_RO(0, MaterialProbe, probes)
BUFFER_RW(1, MaterialAnswer, answers)

KERNEL(material_probe) {
    MaterialProbe p = probes[index];
    Surface s;
    s.position = vec3(p.position.x, p.position.y, p.position.z);
    s.error = vec3(0.0f);
    s.ng = vec3(p.ng.x, p.ng.y, p.ng.z);
    s.ns = vec3(p.ns.x, p.ns.y, p.ns.z);
    s.dpdu = vec3(p.dpdu.x, p.dpdu.y, p.dpdu.z);
    s.dpdv = vec3(p.dpdv.x, p.dpdv.y, p.dpdv.z);
    s.dndu = vec3(p.dndu.x, p.dndu.y, p.dndu.z);
    s.dndv = vec3(p.dndv.x, p.dndv.y, p.dndv.z);
    s.uv = vec2(p.uv.x, p.uv.y);
    s.distance = 1.0f;
    s.instance = 0u;
    s.geometry = p.what.y;
    s.primitive = 0u;
    s.material = p.what.x;
    s.light = NONE;
    Frame frame;
    float opacity = surface_alpha(s.geometry, surface_texture_context(s));
    Bsdf b = material_bsdf(s, vec3(p.wo.x, p.wo.y, p.wo.z), frame);
    MaterialAnswer a;
    a.what = uvec4(b.kind, s.material, b.flags, b.max_depth);
    a.color0 = slot_of(b.color0, 0.0f);
    a.color1 = slot_of(b.color1, 0.0f);
    a.albedo = slot_of(b.albedo, 0.0f);
    a.alpha = vec4(b.alpha.x, b.alpha.y, b.alpha_base.x, b.alpha_base.y);
    a.coat = vec4(b.eta, b.thickness, b.g, opacity);
    a.frame_x = vec4(frame.x.x, frame.x.y, frame.x.z, 0.0f);
    a.frame_z = vec4(frame.z.x, frame.z.y, frame.z.z, 0.0f);
    answers[index] = a;
}
