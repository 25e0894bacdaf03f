// Types of the scattering functions. All directions are unit vectors in the local shading frame (z = shading normal)
// that point away from the surface.
#ifndef LAMPYRIS_KERNEL_BSDF_TYPES
#define LAMPYRIS_KERNEL_BSDF_TYPES

// What an eye path of photon mapping does at a surface.
CONST uint VISIBLE_FOLLOW = 0u;  // sample a direction and continue: (nearly) specular
CONST uint VISIBLE_GATHER = 1u;  // estimate the reflected radiance from photons here
CONST uint VISIBLE_SPLIT = 2u;   // a smooth coat over a rough base: one of the two by random choice, or both

// A material at a point, with all parameters evaluated; created by bsdf_of_record. Each material decides what the
// members mean; those in this source tree use them as follows.
struct Bsdf {
    uint kind;        // MATERIAL_*, never MATERIAL_MIX
    uint flags;       // MATERIAL_ENERGY_COMPENSATION, MATERIAL_EXACT_COAT
    Spectrum color0;  // diffuse, diffuse transmission, coated diffuse: reflectance; conductors: n of n + ik
    Spectrum color1;  // diffuse transmission: transmittance; conductors: k
    Spectrum albedo;  // coats: single-scattering albedo of the medium between the layers
    vec2 alpha;       // roughness (coats: of the interface) from ggx_alpha: zero if smooth
    vec2 alpha_base;  // coated conductor: roughness of the metal
    float eta;        // dielectrics and coats: refractive index on the -z side over that on the +z side
    float thickness;  // coats, in mean free paths of the medium (its extinction is 1, as in pbrt)
    float g;          // coats: asymmetry of the medium's phase function
    uint max_depth;   // coats: maximum number of events of a random walk
    uint samples;     // coats: random walks per evaluation
    uint walk;        // coats: seed of the walks; not 0 if the same two directions are evaluated repeatedly
    float inner;      // smooth clear coats over diffuse bases: inner reflectance (clear_coat.h); else negative
};

// A Bsdf that scatters nothing.
FN Bsdf no_bsdf() {
    Bsdf b;
    b.kind = MATERIAL_INTERFACE;
    b.flags = 0u;
    b.color0 = Spectrum(0.0f);
    b.color1 = Spectrum(0.0f);
    b.albedo = Spectrum(0.0f);
    b.alpha = vec2(0.0f, 0.0f);
    b.alpha_base = vec2(0.0f, 0.0f);
    b.eta = 1.0f;
    b.thickness = 0.0f;
    b.g = 0.0f;
    b.max_depth = 0u;
    b.samples = 1u;
    b.walk = 0u;
    b.inner = -1.0f;
    return b;
}

// ---- Parameters from a record ----------------------------------------------------------------------------------------
// These clamp every parameter to the range in which the models' functions are finite, because scenes may contain any
// value.

FN Spectrum bounded_share(Spectrum s) { return clamp_each(s, 0.0f, 1.0f); }
FN Spectrum bounded_index(Spectrum s) { return clamp_each(s, 0.0f, 1e4f); }
// A relative refractive index; 0 means 1, as in pbrt.
FN float bounded_eta(float eta) { return eta > 0.0f ? clamp(eta, 0.01f, 100.0f) : 1.0f; }

FN vec2 roughness_alpha(float u, float v, bool remap) { return remap ? vec2(safe_sqrt(u), safe_sqrt(v)) : vec2(u, v); }
// A record's roughness, remapped to alpha if its flags say so. record_alpha also bounds it as the GGX functions need
// it.
FN vec2 record_roughness(IN(MaterialRecord) m) {
    return roughness_alpha(m.roughness_u, m.roughness_v, (m.flags & MATERIAL_REMAP) != 0u);
}
FN vec2 record_alpha(IN(MaterialRecord) m) {
    vec2 alpha = record_roughness(m);
    return ggx_alpha(alpha.x, alpha.y);
}

// ---- Samples ---------------------------------------------------------------------------------------------------------

struct BsdfSample {
    vec3 wi;
    Spectrum f;                // without the cosine; for a specular lobe f |cos| / pdf is the weight
    float pdf;                 // 1/sr; for a specular lobe the probability of choosing it
    float eta;                 // relative index along a refraction (transmitted over incident side), else 1
    uint lobe;                 // LOBE_REFLECTION or LOBE_TRANSMISSION, and LOBE_DIFFUSE, LOBE_GLOSSY or LOBE_SPECULAR
    uint pdf_is_proportional;  // 1: f and pdf share an unknown factor (layered); for MIS see bsdf_sample_density
};

FN BsdfSample no_bsdf_sample() {
    BsdfSample s;
    s.wi = vec3(0.0f, 0.0f, 1.0f);
    s.f = Spectrum(0.0f);
    s.pdf = 0.0f;
    s.eta = 1.0f;
    s.lobe = 0u;
    s.pdf_is_proportional = 0u;
    return s;
}

// Nothing is scattered from or into directions with a smaller cosine: the rounding of a unit vector is larger, and
// quotients by fourth powers of a cosine cannot overflow.
CONST float MIN_COSINE = 1e-8f;

FN bool is_grazing(vec3 w) { return !(abs(w.z) >= MIN_COSINE); }
FN bool same_hemisphere(vec3 a, vec3 b) { return a.z * b.z > 0.0f; }

#endif
