// The numbers of lights that are no triangles, by name: they are where a LightRecord has a triangle's.
#ifndef LAMPYRIS_KERNEL_LIGHT_RECORD
#define LAMPYRIS_KERNEL_LIGHT_RECORD

// Point, spot, projection and goniometric lights.
FN vec3 light_position(IN(LightRecord) light) { return light.p0; }
// Distant lights: unit direction towards the light.
FN vec3 light_direction(IN(LightRecord) light) { return light.p0; }
// Spot lights: unit axis, away from the light, and the angles to it where the falloff begins and ends, as 1 - cos: a cosine has
// no digits for narrow beams.
FN vec3 spot_axis(IN(LightRecord) light) { return light.p1; }
FN float spot_begin(IN(LightRecord) light) { return light.extent; }
FN float spot_end(IN(LightRecord) light) { return light.inverse_area; }
// Projection lights: xmin, ymin, xmax, ymax of the picture at z = 1 in light space.
FN vec4 projection_window(IN(LightRecord) light) {
    return vec4(light.p2.x, light.p2.y, light.p2.z, light.inverse_area);
}

#endif
