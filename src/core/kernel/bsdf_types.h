// What scattering functions take and give. All directions are unit vectors in the local shading frame (z = shading
// normal) that point away from the surface.
#ifndef LAMPYRIS_KERNEL_BSDF_TYPES
#define LAMPYRIS_KERNEL_BSDF_TYPES

CONST uint LOBE_REFLECTION = 1u;
CONST uint LOBE_TRANSMISSION = 2u;
CONST uint LOBE_DIFFUSE = 4u;
CONST uint LOBE_GLOSSY = 8u;
CONST uint LOBE_SPECULAR = 16u;
CONST uint LOBE_BOTH_SIDES = 3u;  // reflection and transmission: an unrestricted choice

// A material at a point: every parameter is resolved. Make one with the functions in bsdf.h, which bound the parameters.
struct Bsdf {
    uint kind;        // MATERIAL_*, never MATERIAL_MIX
    uint flags;       // MATERIAL_ENERGY_COMPENSATION, MATERIAL_EXACT_COAT
    vec3 color0;      // diffuse, diffuse transmission, coated diffuse: reflectance; conductors: n of n + ik
    vec3 color1;      // diffuse transmission: transmittance; conductors: k
    vec3 albedo;      // coats: single-scattering albedo of the medium between the layers
    vec2 alpha;       // roughness; of coats: of the interface. From ggx_alpha: zero where it is smooth
    vec2 alpha_base;  // coated conductor: roughness of the metal
    float eta;        // dielectrics and coats: index on the side of -z over that of +z
    float thickness;  // coats, in mean free paths of the medium (its extinction is 1, as in pbrt)
    float g;          // coats: asymmetry of the medium's phase function
    uint max_depth;   // coats: most events of a random walk
    uint samples;     // coats: random walks per evaluation
    uint walk;        // coats: which walks; 0 unless the same two directions are asked about again and again
    float inner;      // smooth clear coats over diffuse bases: inner reflectance (bsdf_clear_coat.h); else negative
};

struct BsdfSample {
    vec3 wi;
    vec3 f;                    // without the cosine; for a specular lobe f |cos| / pdf is the weight
    float pdf;                 // 1/sr; for a specular lobe the probability of choosing it
    float eta;                 // relative index along a refraction (transmitted over incident side), else 1
    uint lobe;                 // LOBE_REFLECTION or LOBE_TRANSMISSION, and LOBE_DIFFUSE, LOBE_GLOSSY or LOBE_SPECULAR
    uint pdf_is_proportional;  // 1: f and pdf share an unknown factor (layered); for MIS see bsdf_sample_density
};

FN BsdfSample no_bsdf_sample() {
    BsdfSample s;
    s.wi = vec3(0.0f, 0.0f, 1.0f);
    s.f = vec3(0.0f);
    s.pdf = 0.0f;
    s.eta = 1.0f;
    s.lobe = 0u;
    s.pdf_is_proportional = 0u;
    return s;
}

// Directions flatter than this neither scatter nor are scattered into: a float's direction is not known better, and no
// quotient by a cosine overflows.
CONST float MIN_COSINE = 1e-6f;

FN bool is_grazing(vec3 w) { return !(abs(w.z) >= MIN_COSINE); }
FN bool same_hemisphere(vec3 a, vec3 b) { return a.z * b.z > 0.0f; }

#endif
