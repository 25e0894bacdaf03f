// Evaluates textures and looks up images, for tests.
#include "core/kernel/scene.h"

CONST uint PROBE_COLOR = 0u;  // answers[i]: texture_color of program probes[i].what.y, and texture_float of it
CONST uint PROBE_IMAGE = 1u;  // answers[i]: image_lookup of image probes[i].what.y at uv

struct TextureProbe {
    uvec4 what;
    vec4 position;
    vec4 normal;
    vec4 uv;
};

BUFFER_RO(0, TextureProbe, probes)
BUFFER_RW(1, vec4, answers)

KERNEL(texture_probe) {
    TextureProbe p = probes[index];
    if (p.what.x == PROBE_IMAGE) {
        answers[index] = image_lookup(p.what.y, vec2(p.uv.x, p.uv.y));
    } else {
        TextureContext c;
        c.position = vec3(p.position.x, p.position.y, p.position.z);
        c.normal = vec3(p.normal.x, p.normal.y, p.normal.z);
        c.uv = vec2(p.uv.x, p.uv.y);
        vec3 value = texture_color(p.what.y, c);
        answers[index] = vec4(value.x, value.y, value.z, texture_float(p.what.y, c));
    }
}
