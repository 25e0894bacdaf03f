// The scene's records as kernels read them: shared by the host, the C++ kernels and GLSL.
//
// Members come in fours: vec4, uvec4, four scalars, or a vec3 or Spectrum and a scalar. Whatever pads does so differently in GLSL and C++, and a
// shifted read gives NaN.
// Indices that may be absent hold NONE. Directions and positions are world space unless said; colours are linear Rec.709.
#ifndef LAMPYRIS_KERNEL_LAYOUT
#define LAMPYRIS_KERNEL_LAYOUT

#include "materials/list.h"

CONST uint NONE = 0xffffffffu;

// ---- Geometry --------------------------------------------------------------------------------------------------------

CONST uint GEOMETRY_TRIANGLES = 0u;
CONST uint GEOMETRY_BILINEAR = 1u;  // patches p00, p10, p01, p11
CONST uint GEOMETRY_SPHERE = 2u;
CONST uint GEOMETRY_DISK = 3u;
CONST uint GEOMETRY_CYLINDER = 4u;

CONST uint GEOMETRY_HAS_NORMALS = 1u;
CONST uint GEOMETRY_HAS_UVS = 2u;
CONST uint GEOMETRY_FLIP =
    4u;  // ReverseOrientation xor a handedness-swapping transform: the geometric normal turns round
CONST uint GEOMETRY_REVERSED =
    8u;  // ReverseOrientation alone: vertex normals are negated on loading, this tells quadrics

// A quadric in its own space, about the z axis.
struct Quadric {
    float radius;
    float z_min;  // sphere, cylinder
    float z_max;
    float phi_max;       // radians
    float height;        // disk
    float inner_radius;  // disk
};

// One record per shape. Triangles and patches are in world space (in object-definition space inside an instanced object);
// quadrics are in their own space, with a transform.
struct GeometryRecord {
    uint kind;
    uint flags;
    uint first_index;   // of `indices`, 3 a triangle, 4 a patch; indices are relative to first_vertex
    uint first_vertex;  // of `positions`, in vertices
    uint material;
    uint first_light;    // light of primitive i is first_light + i; or NONE
    uint alpha_texture;  // or NONE: `alpha` then
    uint transform;      // quadrics
    uint first_normal;   // of `normals` and `uvs`, in vertices
    uint first_uv;
    uint primitive_count;
    uint media;  // interior << 16 | exterior: a transition between media where they differ
    Quadric quadric;
    float alpha;  // below 1 only where EFFECT_ALPHA
    float unused;
};

// Rows of an affine transform and of its inverse.
struct TransformRecord {
    vec4 to0;  // to world (or to the object's definition space)
    vec4 to1;
    vec4 to2;
    vec4 from0;
    vec4 from1;
    vec4 from2;
};

// Instance 0 is the world itself, with the identity.
struct InstanceRecord {
    TransformRecord transform;
    uint first_geometry;
    uint geometry_count;
    uint root_node;         // of its BVH
    uint swaps_handedness;  // 1 if the transform does
};

// Binary BVH node that holds both children's boxes (64 bytes; kernels read it as two pairs). A child is an inner node (its index), or has the sign bit: a
// leaf, count << 24 | first primitive, or with a count of 0 an instance (its index).
CONST uint BVH_LEAF = 0x80000000u;
CONST uint BVH_DEPTH = 40u;  // of a tree, at most, in a scene without instances; and what the stack must hold
CONST uint BVH_DEPTH_INSTANCES =
    31u;  // of each tree in a scene with instances (a mixed leaf adds up to 3 to the world's)
// A primitive is three vec4: v0 | geometry, v1 | primitive, v2 | one of these kinds.
CONST uint BVH_TRIANGLE = 0u;
CONST uint BVH_QUADRIC = 1u;
CONST uint BVH_BILINEAR = 2u;

struct BvhNode {
    vec4 left_min;  // w: left child's bits
    vec4 left_max;  // w: right child's bits
    vec4 right_min;
    vec4 right_max;
};

// ---- Materials -------------------------------------------------------------------------------------------------------

CONST uint MATERIAL_REMAP = 1u;  // roughness is remapped (alpha = sqrt(roughness)) in the kernel, after textures
CONST uint MATERIAL_USES_REFLECTANCE = 2u;  // conductor: color0 is `reflectance`, from which eta = 1 and k follow
CONST uint MATERIAL_REMAP_COAT = 4u;        // as MATERIAL_REMAP, for the interface's roughness
CONST uint MATERIAL_ENERGY_COMPENSATION = 8u;
CONST uint MATERIAL_EXACT_COAT = 16u;  // coats: unbiased weights where pbrt's are not (layered.h)

// A slot's value is its constant, or where its texture is not NONE, the texture.
struct MaterialRecord {
    uint kind;  // MATERIAL_NAME
    uint flags;
    uint bump_texture;    // displacement, or NONE
    uint normal_map;      // image, or NONE
    uint color0_texture;  // textures, or NONE, of the slots below
    uint color1_texture;
    uint color2_texture;
    uint roughness_u_texture;
    uint roughness_v_texture;
    uint thickness_texture;
    uint coat_roughness_u_texture;
    uint coat_roughness_v_texture;
    Spectrum color0;  // reflectance; conductor: eta or reflectance
    float scale;      // diffusetransmission: of both
    Spectrum color1;  // conductor: k; diffusetransmission: transmittance
    float amount;     // mix: of second_material
    Spectrum color2;  // coats: albedo of the medium between the layers
    uint amount_texture;
    float roughness_u;  // of the base for coatedconductor, of the coat for coateddiffuse
    float roughness_v;
    float eta;               // dielectrics, coats
    float g;                 // coats: asymmetry of the medium's phase function
    float thickness;         // coats
    float coat_roughness_u;  // coatedconductor
    float coat_roughness_v;
    float roughest_alpha;  // GGX alpha of its roughest lobe anywhere (1e30: diffuse)
    uint max_depth;        // coats: most events of a random walk
    uint samples;          // coats: random walks per evaluation
    uint first_material;   // mix
    uint second_material;
};

// ---- Media -----------------------------------------------------------------------------------------------------------

// Entry of `media` that every scene may name and none needs: empty space. So 0 wherever a medium may stand is no medium.
CONST uint MEDIUM_VACUUM = 0u;
CONST uint MEDIUM_COUNT = 0x10000u;  // at most, this one included: two fit into an uint

struct MediumRecord {
    Spectrum sigma_a;  // absorbed share per distance (1 / scene unit)
    float unused0;
};

// ---- Textures --------------------------------------------------------------------------------------------------------

// A texture is a program in postfix order over a stack of colours (floats use all three channels alike, and read the first), so
// that a texture of textures needs no recursion: the last operation of a program has flags & 1.
// Operations below TEXTURE_CHECKERBOARD push a value, the others replace the values that they pop by one.
CONST uint TEXTURE_CONSTANT = 0u;  // a
CONST uint TEXTURE_IMAGE = 1u;     // image at the mapped uv; a: scale; option & 1: invert
CONST uint TEXTURE_FBM = 2u;       // a.x: roughness; option: octaves; image: first of Perlin's permutation in `texels`
CONST uint TEXTURE_WRINKLED = 3u;  // the same
CONST uint TEXTURE_WINDY = 4u;     // the same, without a roughness
CONST uint TEXTURE_MARBLE = 5u;    // the same, with a: roughness, scale, variation
CONST uint TEXTURE_CHECKERBOARD = 8u;    // of tex1, tex2
CONST uint TEXTURE_SCALE = 9u;           // of tex, scale
CONST uint TEXTURE_MIX = 10u;            // of tex1, tex2, amount
CONST uint TEXTURE_DIRECTION_MIX = 11u;  // of tex1, tex2; a: unit direction in world space
CONST uint TEXTURE_DOTS = 12u;           // of inside, outside; image: the permutation
CONST uint TEXTURE_BILERP = 13u;         // of v00, v01, v10, v11
CONST uint TEXTURE_STACK = 16u;          // the depth and
CONST uint TEXTURE_LENGTH = 1024u;       // the number of operations that the host guarantees not to exceed

CONST uint MAPPING_NONE = 0u;         // of operations that are the same everywhere
CONST uint MAPPING_UV = 1u;           // m0: su, sv, du, dv
CONST uint MAPPING_SPHERICAL = 2u;    // m0..m2: rows of texture-from-world
CONST uint MAPPING_CYLINDRICAL = 3u;  // rows
CONST uint MAPPING_PLANAR = 4u;       // m0: vs, ds; m1: vt, dt, with the texture's transform in them
CONST uint MAPPING_SPACE = 5u;        // rows; not (s, t) but the point in the texture's space

struct TextureOp {
    uint operation;
    uint flags;  // 1: last | mapping << 8
    uint image;  // or table
    uint option;
    vec4 a;
    vec4 m0;
    vec4 m1;
    vec4 m2;
};

CONST uint WRAP_REPEAT = 0u;
CONST uint WRAP_BLACK = 1u;
CONST uint WRAP_CLAMP = 2u;
CONST uint WRAP_OCTAHEDRAL = 3u;
CONST uint FILTER_POINT = 0u;
CONST uint FILTER_BILINEAR = 1u;
CONST uint TEXEL_RGBA8 = 0u;    // one uint a texel, R lowest; decoded by a table
CONST uint TEXEL_R8 = 1u;       // four texels a uint, lowest first; decoded by a table
CONST uint TEXEL_RGBA16F = 2u;  // two uints
CONST uint TEXEL_RGB32F = 3u;   // three uints
CONST uint TEXEL_R32F = 4u;     // one uint

// Texels lie row by row from the top.
struct ImageRecord {
    uint first_texel;  // in `texels`
    uint width;
    uint height;
    uint format;    // texel format | wrap << 8 | filter << 16
    uint decoding;  // first of 256 floats (as bits) in `texels`: what a byte of an 8-bit format means, in linear light
    uint unused0;
    uint unused1;
    uint unused2;
};

// ---- Lights ----------------------------------------------------------------------------------------------------------

CONST uint LIGHT_TRIANGLE = 0u;
CONST uint LIGHT_GEOMETRY = 1u;  // a quadric or a bilinear patch: ids say which
CONST uint LIGHT_POINT = 2u;
CONST uint LIGHT_SPOT = 3u;
CONST uint LIGHT_DISTANT = 4u;
CONST uint LIGHT_INFINITE = 5u;  // constant
CONST uint LIGHT_INFINITE_IMAGE = 6u;
CONST uint LIGHT_PROJECTION = 7u;
CONST uint LIGHT_GONIOMETRIC = 8u;

CONST uint LIGHT_TWO_SIDED = 1u;
CONST uint LIGHT_PASSED = 2u;  // a light of constant alpha 0: it emits, and all rays pass it

CONST uint CDF_TOTAL = 0x80000000u;  // where a CDF in `distributions` ends

// Lights are ordered: the infinite ones first (SceneRecord says how many), so that an escaping ray visits only those.
//
// `distributions` holds, at offsets that records give: the CDF by which lights are chosen (number of lights + 1 integers, from 0
// to CDF_TOTAL); for each infinite image of w x h texels a CDF of its rows (h + 1 integers), then for each row a CDF of its texels
// (w + 1); and the tables of a smooth pixel filter (CameraRecord; floats' bits). The probability of an interval is the difference of
// its two numbers over CDF_TOTAL, which is exact, and not 0 for any positive weight (distribution.h).
// Images of light are looked up at points of the equal-area octahedral square (infinite, goniometric) or of the picture
// (projection), (0, 0) being the upper left corner; they are FILTER_POINT, as pbrt's, and infinite ones WRAP_OCTAHEDRAL.
// Transforms of lights are the directive's own: that a goniometric image's pole is the light's y axis, and that images have
// their first row on top, is the kernels' business.
struct LightRecord {
    uint kind;
    uint flags;         // | medium << 16
    uint image;         // or emission texture, or NONE
    uint transform;     // of light space, or NONE
    uint geometry;      // area lights
    uint primitive;     // area lights
    float shadow_end;   // triangle: how far outside of it shadow rays end
    uint distribution;  // infinite images: offset in `distributions`
    Spectrum emission;  // radiance, intensity or irradiance, or the scale of the texture or image
    float choice_probability;
    // Triangle lights. Other kinds keep their numbers in these, too: light_record.h names them.
    vec3 p0;  // corners, in the order of the indices
    float area;
    vec3 p1;
    float extent;  // distance of the farthest corner from the centroid
    vec3 p2;
    float inverse_area;
    vec3 normal;           // unit, turned as the geometry's flags say
    float smooth_normals;  // 1 where vertex normals turn it (point by point)
};

// ---- Camera, film, scene ---------------------------------------------------------------------------------------------

CONST uint SAMPLER_SOBOL = 0u;  // padded two-dimensional Owen-scrambled Sobol
CONST uint SAMPLER_INDEPENDENT = 1u;
CONST uint CAMERA_PERSPECTIVE = 0u;
CONST uint CAMERA_ORTHOGRAPHIC = 1u;
CONST uint PIXEL_FILTER_BOX = 0u;
CONST uint PIXEL_FILTER_TRIANGLE = 1u;
CONST uint PIXEL_FILTER_GAUSSIAN = 2u;  // and the other smooth ones: sampled from a table in `distributions`

// A smooth filter has one table of n intervals from the centre to the radius for x and then one for y: the filter's value at
// the n + 1 nodes (no interval changes its sign), the n + 1 numbers of the CDF of its absolute value, linear between nodes,
// the integral of the absolute value over the filter's, and a guide to the CDF (Chen and Asau 1974): entry i is an interval at
// or just before the one that a number from i/n on falls into.
struct CameraRecord {
    uint kind;
    uint filter_kind;
    uint filter_tables;     // offset in `distributions`
    uint filter_intervals;  // of a table: n
    uint resolution_x;      // of the full film
    uint resolution_y;
    uint crop_x;  // origin of the crop window
    uint crop_y;
    vec4 to0;  // rows of world-from-camera (camera space: +x right, +y up, +z forward, as pbrt's)
    vec4 to1;
    vec4 to2;
    vec4 screen;  // raster to camera space at z = 1: x = screen.x + px * screen.z, y = screen.y + py * screen.w
    float lens_radius;
    float focal_distance;
    float max_component;  // clamp of a sample's largest one; 0: none
    float imaging_ratio;
    float filter_radius_x;
    float filter_radius_y;
    float unused0;
    float unused1;
};

struct SceneRecord {
    CameraRecord camera;
    uint light_count;
    uint infinite_lights;  // the first so many of the lights
    uint light_cdf;        // offset of the CDF by which lights are chosen in `distributions` (light_count + 1 integers)
    float light_power;     // luminous power of all lights (W)
    uint geometry_count;
    uint instance_count;
    uint root_node;      // of the top-level BVH
    uint effects_low;    // effects that the scene calls for: the lower 32 bits of the EffectSet
    uint camera_medium;  // in which the camera is
    uint effects_high;   // the upper 32 bits
    uint unused0;
    uint unused1;
    vec4 bounds;  // the world's bounding sphere: centre, radius
};

// ---- Film ------------------------------------------------------------------------------------------------------------

// Sums are compensated (Neumaier 1974), sample by sample, so that they do not depend on how passes are cut into dispatches,
// and a million samples lose nothing.
struct FilmPixel {
    vec3 sum;  // filter-weighted radiance
    float weight;
    vec3 low;  // what rounding dropped from `sum` and `weight`
    float weight_low;
    vec3 squares;  // of the weighted radiance, for the variance
    float depth;   // sum over samples, of the first hit's distance
    vec3 albedo;   // sum over samples
    float hits;    // number of samples that hit something
    vec3 normal;   // sum over samples
    float unused;
    uint samples;
    uint rays;
    uint left_out;        // samples that are not finite, or beyond what the sums hold
    uint first_left_out;  // pass of the first of those
};

// What an integrator knows of its bias: sums over samples, as FilmPixel's.
struct FilmBias {
    vec4 sum;
    vec4 squares;
};

// The part of the image that is rendered, in pixels of the full film, and which samples.
struct FilmWindow {
    uint x;  // of its upper left pixel
    uint y;
    uint width;
    uint height;
    uint first_sample;
    uint samples;
    uint seed;
    uint sampler_kind;  // SAMPLER_*
};

#endif
