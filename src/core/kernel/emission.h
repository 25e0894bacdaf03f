// Emission of photons: chooses a light in proportion to its power, then samples a ray that leaves it.
//
// The power is that of a single photon: radiance times cosine, or intensity, over the density of the choice (W per
// channel). Divide it by the number of photons emitted.
#ifndef LAMPYRIS_KERNEL_EMISSION
#define LAMPYRIS_KERNEL_EMISSION

struct Emission {
    vec3 origin;  // outside of the rounding error of the light's surface
    vec3 direction;
    Spectrum power;
    uint light;
    uint medium;  // in which the photon starts
    // For methods that weigh paths from both ends:
    vec3 position;  // on the light; undefined for lights at infinity
    vec3 ng;        // unit normal of an area light there
    // Of the light and the point: per area. At infinity, of the light and the direction: per solid angle. Lights at a
    // point and distant lights: of the light alone.
    float place_pdf;
    float direction_pdf;  // of the direction: per solid angle; at infinity, of the point of the disk: per area
};

// Random numbers that a photon's start uses: one for the light, one for the side that emits, two for the position, two
// for the direction.
CONST uint EMISSION_DIMENSIONS = 6u;

RARE_FN void log_emits(Emission e) {
    PathLogRecord r = log_record(LOG_START);
    r.light = e.light;
    r.position = e.origin;
    r.normal = e.ng;
    r.direction = e.direction;
    r.pdf = e.place_pdf;
    r.extra = e.direction_pdf;
    r.throughput = rgb_of(e.power);
    r.medium = e.medium;
    log_write(r);
}

// A point on the disk through which light from infinity enters the scene. As in pbrt, the disk has the radius of the
// scene's bounding sphere, and touches it.
FN vec3 distant_origin(vec3 to_light, vec2 u) {
    vec2 disk = sample_concentric_disk(u);
    Frame frame = frame_from_z(to_light);
    vec4 bounds = scene[0].bounds;
    return vec3(bounds) + bounds.w * (frame.x * disk.x + frame.y * disk.y + to_light);
}
FN float distant_area() { return PI * sqr(scene[0].bounds.w); }

FN bool emit_from_area(uint index, float u_side, vec2 u_place, vec2 u_direction, INOUT(Emission) e) {
    LightRecord light = lights[index];
    AreaSample place;
    if (!sample_light_area(light, u_place, place)) return false;
    vec3 local = sample_cosine_hemisphere(u_direction);
    float sides = light_sides(light);
    if (sides == 2.0f && u_side < 0.5f) local.z = -local.z;
    e.direction = unit(to_world(frame_from_z(area_emission_side(index, place.ng)), local));
    Spectrum radiance = area_emission(index, place.position, place.ng, place.uv, e.direction);
    if (HAS(EFFECT_ALPHA)) radiance = radiance * light_alpha(light, place.position, place.ng, place.uv);
    e.power = radiance * (PI * sides / (place.pdf * light.choice_probability));
    e.origin = offset_origin(place.position, place.error, place.ng, e.direction);
    e.medium = light_medium(index, place.ng, e.direction);
    e.position = place.position;
    e.ng = place.ng;
    e.place_pdf = place.pdf * light.choice_probability;
    e.direction_pdf = abs(local.z) * (INV_PI / sides);
    return true;
}

// Density (1/sr) of a direction that is sampled uniformly over a projection light's image at z = 1, of which an area dA has
// the solid angle cos^3 dA; d2: squared length of the direction with z = 1 in light space.
FN float projection_pdf(IN(LightRecord) light, float d2, vec3 direction) {
    vec4 window = projection_window(light);
    return d2 * sqrt(d2) / ((window.z - window.x) * (window.w - window.y)) *
           solid_angle_stretch(transforms[light.transform], direction);
}

// Density (1/sr) with which photons of a light at a point leave in a direction into which it shines.
FN float point_emission_pdf(IN(LightRecord) light, vec3 direction) {
    if (light.kind == LIGHT_SPOT) return pdf_uniform_cone(spot_end(light));
    if (!HAS(EFFECT_PROJECTION_LIGHTS) || light.kind != LIGHT_PROJECTION) return pdf_uniform_sphere();
    TransformRecord m = transforms[light.transform];
    vec3 local = transform_vector(m.from0, m.from1, m.from2, direction);
    return projection_pdf(light, length_squared(local) / sqr(local.z), direction);
}

FN bool emit_from_point(uint index, vec2 u_place, vec2 u_direction, INOUT(Emission) e) {
    LightRecord light = lights[index];
    e.direction_pdf = pdf_uniform_sphere();
    Spectrum intensity = light.emission;
    if (light.kind == LIGHT_SPOT) {
        e.direction = to_world(frame_from_z(spot_axis(light)), sample_uniform_cone(u_direction, spot_end(light)));
        e.direction_pdf = pdf_uniform_cone(spot_end(light));
        // Of the direction before it is rounded, which moves it out of a narrow beam.
        intensity = intensity * spot_falloff(light, u_direction.x * spot_end(light));
    } else if (HAS(EFFECT_PROJECTION_LIGHTS) && light.kind == LIGHT_PROJECTION) {
        TransformRecord m = transforms[light.transform];
        vec4 window = projection_window(light);
        vec2 p = vec2(lerp_of(u_direction.x, window.x, window.z), lerp_of(u_direction.y, window.y, window.w));
        e.direction = unit(transform_vector(m.to0, m.to1, m.to2, vec3(p.x, p.y, 1.0f)));
        e.direction_pdf = projection_pdf(light, p.x * p.x + p.y * p.y + 1.0f, e.direction);
    } else {
        e.direction = sample_uniform_sphere(u_direction);
    }
    e.direction = unit(e.direction);
    e.position = light_position(light);
    e.origin = e.position + point_offset(e.position, e.direction) * e.direction;
    e.place_pdf = light.choice_probability;
    if (light.kind != LIGHT_SPOT) intensity = point_light_intensity(light, e.direction);
    e.power = intensity / (e.direction_pdf * light.choice_probability);
    e.medium = light_medium(index, e.direction, e.direction);
    return true;
}

// Samples the start of a photon with six uniform random numbers (u_choice and u_direction as bits, random.h); false if
// the sample has no power. Power beyond a float's range stays infinite: samples that gather it are not finite either,
// and film_add counts them.
FN bool emit_photon(uint u_choice, float u_side, vec2 u_place, uvec2 u_direction, OUT(Emission) e) {
    e.origin = vec3(0.0f);
    e.direction = vec3(0.0f, 0.0f, 1.0f);
    e.power = Spectrum(0.0f);
    uint count = scene[0].light_count;
    e.light = NONE;
    e.medium = MEDIUM_VACUUM;
    e.position = vec3(0.0f);
    e.ng = vec3(0.0f, 0.0f, 1.0f);
    e.place_pdf = 0.0f;
    e.direction_pdf = 0.0f;
    if (count == 0u) return false;
    e.light = count == 1u ? 0u : find_interval(scene[0].light_cdf, count, cdf_number(u_choice));
    uint kind = lights[e.light].kind;
    bool found = false;
    if (HAS(EFFECT_AREA_LIGHTS) && kind <= LIGHT_GEOMETRY) {
        found = emit_from_area(e.light, u_side, u_place, unit_floats(u_direction), e);
    } else if (HAS(EFFECT_ENVIRONMENT) && (kind == LIGHT_INFINITE || kind == LIGHT_INFINITE_IMAGE)) {
        vec3 to_light;
        Spectrum radiance;
        float pdf;
        found = environment_sample(e.light, u_direction, false, to_light, radiance, pdf);
        if (found) {
            e.direction = -to_light;
            e.origin = distant_origin(to_light, u_place);
            e.power = radiance * (distant_area() / pdf);
            e.place_pdf = pdf;
            e.direction_pdf = 1.0f / distant_area();
        }
    } else if (HAS(EFFECT_DISTANT_LIGHTS) && kind == LIGHT_DISTANT) {
        LightRecord light = lights[e.light];
        e.direction = -light_direction(light);
        e.origin = distant_origin(light_direction(light), u_place);
        e.power = light.emission * (distant_area() / light.choice_probability);
        e.place_pdf = light.choice_probability;
        e.direction_pdf = 1.0f / distant_area();
        found = true;
    } else if (HAS(EFFECT_POINT_LIGHTS) || HAS(EFFECT_PROJECTION_LIGHTS)) {
        found = emit_from_point(e.light, u_place, unit_floats(u_direction), e);
    }
    if (HAS(EFFECT_MEDIUM) && found &&
        (kind == LIGHT_INFINITE || kind == LIGHT_INFINITE_IMAGE || kind == LIGHT_DISTANT)) {
        e.medium = light_medium(e.light, e.direction, e.direction);
        e.power *= medium_transmittance(e.medium, INFINITE_DISTANCE);
    }
    if (!found || is_black(e.power)) return false;
    PATH_LOG(log_emits(e));
    return true;
}

#endif
