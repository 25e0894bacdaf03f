// Rays, hits and surface points, as kernel functions exchange them.
#ifndef LAMPYRIS_KERNEL_SURFACE
#define LAMPYRIS_KERNEL_SURFACE

CONST float INFINITE_DISTANCE = 3.0e38f;

struct Ray {
    vec3 origin;
    vec3 direction;  // unit length, except inside instances and quadrics
};

FN Ray ray_of(vec3 origin, vec3 direction) {
    Ray ray;
    ray.origin = origin;
    ray.direction = direction;
    return ray;
}

// A tracer's result, reduced to the primitive.
struct Hit {
    uint instance;
    uint geometry;
    uint primitive;
};

// A point on a surface, in world space.
struct Surface {
    vec3 position;
    vec3 error;  // bound of the absolute rounding error of `position`, per coordinate: rays start outside of it
    vec3 way;    // offset along ng that leads out of the error (way_out, math.h); set if a ray hit the surface
    vec3 ng;     // unit geometric normal, on the side that is outside in pbrt
    vec3 ns;     // unit shading normal
    vec3 dpdu;   // derivatives of the position; the shading tangent is dpdu's part orthogonal to ns
    vec3 dpdv;
    vec3 dndu;  // derivatives of the shading normal, for bump mapping
    vec3 dndv;
    vec2 uv;
    float distance;  // along the ray that hit it
    uint instance;
    uint geometry;
    uint primitive;
    uint material;
    uint light;  // the area light that this primitive is, or NONE
};

// No surface, with all members initialised.
FN Surface no_surface() {
    Surface s;
    s.position = vec3(0.0f);
    s.error = vec3(0.0f);
    s.way = vec3(0.0f);
    s.ng = vec3(0.0f);
    s.ns = vec3(0.0f);
    s.dpdu = vec3(0.0f);
    s.dpdv = vec3(0.0f);
    s.dndu = vec3(0.0f);
    s.dndv = vec3(0.0f);
    s.uv = vec2(0.0f);
    s.distance = 0.0f;
    s.instance = 0u;
    s.geometry = 0u;
    s.primitive = 0u;
    s.material = 0u;
    s.light = NONE;
    return s;
}

// Radiance flows against the path (from the camera), importance along it (photons): refraction scales only the former.
CONST uint TRANSPORT_RADIANCE = 0u;
CONST uint TRANSPORT_IMPORTANCE = 1u;

#endif
