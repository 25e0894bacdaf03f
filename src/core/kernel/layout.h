// The scene's records, shared by the host, the C++ kernels and GLSL.
//
// Members come in fours: vec4, uvec4, four scalars, or a Spectrum and a scalar. GLSL and C++ pad everything else
// differently, and shifted reads give NaN.
// Optional indices are NONE if they are absent. Directions and positions are in world space unless stated otherwise;
// colours are linear Rec. 709.
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
// ReverseOrientation xor a transform that swaps handedness: the geometric normal is negated.
CONST uint GEOMETRY_FLIP = 4u;
// ReverseOrientation alone, for quadrics: vertex normals are negated on loading.
CONST uint GEOMETRY_REVERSED = 8u;

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
    uint first_index;   // in `indices`, 3 per triangle, 4 per patch; indices are relative to first_vertex
    uint first_vertex;  // in `positions`, counted in vertices
    uint material;
    uint first_light;    // light of primitive i is first_light + i; or NONE
    uint alpha_texture;  // or NONE: then `alpha`
    uint transform;      // quadrics
    uint first_normal;   // in `normals`, counted in vertices
    uint first_uv;       // in `uvs`, counted in vertices
    uint primitive_count;
    uint media;  // interior << 16 | exterior: a boundary between media if they differ
    Quadric quadric;
    float alpha;  // below 1 only with EFFECT_ALPHA
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

// Instance 0 is the world itself, with the identity transform.
struct InstanceRecord {
    TransformRecord transform;
    uint first_geometry;
    uint geometry_count;
    uint root_node;         // of its BVH
    uint swaps_handedness;  // 1 if the transform does
};

// BVH2 node with the boxes of both children (64 bytes, which kernels read as two pairs). A child is the index of an
// inner node, or has the sign bit set: a leaf, count << 24 | first primitive, or, if the count is 0, the index of an
// instance.
CONST uint BVH_LEAF = 0x80000000u;
CONST uint BVH_DEPTH = 40u;  // maximum depth of the tree of a scene without instances, and the size of its stack
// Maximum depth of each tree of a scene with instances (a mixed leaf adds up to 3 to the world's).
CONST uint BVH_DEPTH_INSTANCES = 31u;
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

CONST uint LOBE_REFLECTION = 1u;
CONST uint LOBE_TRANSMISSION = 2u;
CONST uint LOBE_DIFFUSE = 4u;
CONST uint LOBE_GLOSSY = 8u;
CONST uint LOBE_SPECULAR = 16u;
CONST uint LOBE_BOTH_SIDES = 3u;  // reflection and transmission: the choice is unrestricted

CONST uint MATERIAL_REMAP = 1u;  // roughness is remapped (alpha = sqrt(roughness)) in the kernel, after textures
CONST uint MATERIAL_USES_REFLECTANCE = 2u;  // conductor: color0 is `reflectance`, from which eta = 1 and k follow
CONST uint MATERIAL_REMAP_COAT = 4u;        // as MATERIAL_REMAP, for the interface's roughness
CONST uint MATERIAL_ENERGY_COMPENSATION = 8u;
CONST uint MATERIAL_EXACT_COAT = 16u;  // coats: unbiased weights where pbrt's are biased (layered.h)

// A slot's value is its texture, or, if that is NONE, its constant.
struct MaterialRecord {
    uint kind;  // MATERIAL_NAME
    uint flags;
    uint bump_texture;    // displacement, or NONE
    uint normal_map;      // image, or NONE
    uint color0_texture;  // textures of the slots below, or NONE
    uint color1_texture;
    uint color2_texture;
    uint roughness_u_texture;
    uint roughness_v_texture;
    uint thickness_texture;
    uint coat_roughness_u_texture;
    uint coat_roughness_v_texture;
    Spectrum color0;  // reflectance; conductor: eta or reflectance
    float scale;      // diffusetransmission: scales both colours
    Spectrum color1;  // conductor: k; diffusetransmission: transmittance
    float amount;     // mix: weight of second_material
    Spectrum color2;  // coats: albedo of the medium between the layers
    uint amount_texture;
    float roughness_u;  // of the base for coatedconductor, of the coat for coateddiffuse
    float roughness_v;
    float eta;               // dielectrics, coats
    float g;                 // coats: asymmetry of the medium's phase function
    float thickness;         // coats
    float coat_roughness_u;  // coatedconductor
    float coat_roughness_v;
    float roughest_alpha;  // largest GGX alpha of any lobe at any point (1e30: diffuse)
    uint max_depth;        // coats: maximum number of events of a random walk
    uint samples;          // coats: random walks per evaluation
    uint first_material;   // mix
    uint second_material;
};

// ---- Media -----------------------------------------------------------------------------------------------------------

// Entry 0 of `media` is empty space. So 0 means no medium wherever a medium's index is stored.
CONST uint MEDIUM_VACUUM = 0u;
CONST uint MEDIUM_COUNT = 0x10000u;  // maximum, including vacuum: two indices fit into a uint

struct MediumRecord {
    Spectrum sigma_a;  // absorption coefficient (1 / scene unit)
    float unused0;
};

// ---- Textures --------------------------------------------------------------------------------------------------------

// A texture is a program in postfix order over a stack of colours, so that nested textures need no recursion. (Floats
// are colours with three equal channels, of which the first is read.) The last operation of a program has flags & 1.
// Operations below TEXTURE_CHECKERBOARD push a value; the others pop their operands and push their result.
CONST uint TEXTURE_CONSTANT = 0u;  // a
CONST uint TEXTURE_IMAGE = 1u;     // image at the mapped uv; a: scale; option & 1: invert
CONST uint TEXTURE_FBM = 2u;       // a.x: roughness; option: octaves; image: offset of Perlin's permutation in `texels`
CONST uint TEXTURE_WRINKLED = 3u;  // the same
CONST uint TEXTURE_WINDY = 4u;     // the same, without a roughness
CONST uint TEXTURE_MARBLE = 5u;    // the same, with a: roughness, scale, variation
CONST uint TEXTURE_CHECKERBOARD = 8u;    // operands tex1, tex2
CONST uint TEXTURE_SCALE = 9u;           // operands tex, scale
CONST uint TEXTURE_MIX = 10u;            // operands tex1, tex2, amount
CONST uint TEXTURE_DIRECTION_MIX = 11u;  // operands tex1, tex2; a: unit direction in world space
CONST uint TEXTURE_DOTS = 12u;           // operands inside, outside; image: offset of the permutation
CONST uint TEXTURE_BILERP = 13u;         // operands v00, v01, v10, v11
CONST uint TEXTURE_STACK = 16u;          // maximum depth of the stack, and
CONST uint TEXTURE_LENGTH = 1024u;       // maximum number of operations; the host checks both

CONST uint MAPPING_NONE = 0u;         // operations that use no coordinates
CONST uint MAPPING_UV = 1u;           // m0: su, sv, du, dv
CONST uint MAPPING_SPHERICAL = 2u;    // m0..m2: rows of texture-from-world
CONST uint MAPPING_CYLINDRICAL = 3u;  // rows
CONST uint MAPPING_PLANAR = 4u;       // m0: vs, ds; m1: vt, dt; both include the texture's transform
CONST uint MAPPING_SPACE = 5u;        // rows; not (s, t) but the point in the texture's space

struct TextureOp {
    uint operation;
    uint flags;  // 1 if last | mapping << 8
    uint image;  // or the offset of a table
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
CONST uint TEXEL_RGBA8 = 0u;    // one uint per texel, R in the lowest byte; decoded by a table
CONST uint TEXEL_R8 = 1u;       // four texels per uint, lowest byte first; decoded by a table
CONST uint TEXEL_RGBA16F = 2u;  // two uints per texel
CONST uint TEXEL_RGB32F = 3u;   // three uints per texel
CONST uint TEXEL_R32F = 4u;     // one uint per texel

// Texels are stored row by row, from the top.
struct ImageRecord {
    uint first_texel;  // in `texels`
    uint width;
    uint height;
    uint format;    // texel format | wrap << 8 | filter << 16
    uint decoding;  // 8-bit formats: offset in `texels` of 256 floats (as bits), each byte's linear value
    uint unused0;
    uint unused1;
    uint unused2;
};

// ---- Lights ----------------------------------------------------------------------------------------------------------

CONST uint LIGHT_TRIANGLE = 0u;
CONST uint LIGHT_GEOMETRY = 1u;  // the quadric or bilinear patch of `geometry` and `primitive`
CONST uint LIGHT_POINT = 2u;
CONST uint LIGHT_SPOT = 3u;
CONST uint LIGHT_DISTANT = 4u;
CONST uint LIGHT_INFINITE = 5u;  // constant
CONST uint LIGHT_INFINITE_IMAGE = 6u;
CONST uint LIGHT_PROJECTION = 7u;
CONST uint LIGHT_GONIOMETRIC = 8u;

CONST uint LIGHT_TWO_SIDED = 1u;
CONST uint LIGHT_PASSED = 2u;  // a light of constant alpha 0: it emits, and all rays pass it

CONST uint CDF_TOTAL = 0x80000000u;  // the last value of every CDF in `distributions`

// Infinite lights come first (SceneRecord has their number), so that an escaping ray visits only those.
//
// `distributions` contains, at offsets that are stored in records:
// - the CDF for choosing a light (number of lights + 1 integers, from 0 to CDF_TOTAL);
// - for each infinite image of w x h texels, a CDF of its rows (h + 1 integers), then a CDF of each row's texels (w + 1); and
//   the same for what is above the image's mean (environment.h);
// - the tables of a smooth pixel filter (CameraRecord; bits of floats).
// The probability of an interval is the difference of its two numbers over CDF_TOTAL. It is exact, and positive for every
// positive weight (distribution.h).
//
// Images of lights are looked up at points of the equal-area octahedral square (infinite, goniometric) or of the
// projected picture (projection); (0, 0) is the upper left corner. As in pbrt, they are FILTER_POINT, and infinite ones
// WRAP_OCTAHEDRAL. A light's transform is that of its directive. Kernels handle that a goniometric image's pole is the
// light's y axis, and that an image's first row is its top.
//
// Contents of v0 to v2 and `normal`; the last number of each is w:
// - triangle. v0: p0, area. v1: p1 (in the order of the indices), distance of the farthest corner from the centroid.
//   v2: p2, 1 / area. normal: unit normal, negated if the geometry's flags say so; 1 if vertex normals determine its side
//   at each point instead, else 0.
// - point, goniometric. v0: position.
// - spot. v0: position. v1: unit axis (away from the light), 1 - cos of the angle at which the falloff begins. v2.w: of that at
//   which it ends.
// - distant. v0: unit direction towards the light.
// - projection. v0: position. v2: xmin, ymin, xmax, ymax of the picture at z = 1 in light space.
struct LightRecord {
    uint kind;
    uint flags;         // LIGHT_TWO_SIDED, LIGHT_PASSED; | medium << 16
    uint image;         // or the texture of an area light's emission, or NONE
    uint transform;     // light space to world, or NONE
    uint geometry;      // area lights
    uint primitive;     // area lights
    float shadow_end;   // triangle: distance from it at which shadow rays end
    uint distribution;  // infinite images: offset in `distributions`; others: see LightNode
    Spectrum emission;  // radiance, intensity or irradiance, or the scale of the texture or image
    float choice_probability;
    // Triangle lights. Other kinds keep their numbers in these, too: light_record.h names them.
    vec3 p0;  // corners, in the order of the indices
    float area;
    vec3 p1;
    float extent;  // distance of the farthest corner from the centroid
    vec3 p2;
    float inverse_area;
    vec3 normal;           // unit, flipped as the geometry's flags say
    float smooth_normals;  // 1 if vertex normals may flip it (point by point)
};

// Bounds of the lights below a node of the tree by which kernels choose one (light_tree.h): n leaves in 2 n - 1 nodes, a left child
// after its parent. Leaves are numbered from left to right: LightRecord.distribution has a light's number. `distributions` has the
// CDF of the leaves' intensities (SceneRecord.tree_cdf; n + 1 integers), and then the light of each leaf.
struct LightNode {
    vec3 middle;
    float radius2;       // squared radius of the sphere around it
    vec3 axis;           // unit
    float cos_normals;   // of the cone around the axis that has all normals
    float intensity;     // sum of the lights' (W/sr), over that of all
    float cos_emission;  // of the largest angle to a normal at which any of them emits
    uint right;          // the right child; a leaf: NONE
    uint two_sided;      // 1: they emit around the negated axis as well
};

// ---- Camera, film, scene ---------------------------------------------------------------------------------------------

CONST uint SAMPLER_SOBOL = 0u;  // padded two-dimensional Owen-scrambled Sobol
CONST uint SAMPLER_INDEPENDENT = 1u;
CONST uint CAMERA_PERSPECTIVE = 0u;
CONST uint CAMERA_ORTHOGRAPHIC = 1u;
CONST uint PIXEL_FILTER_BOX = 0u;
CONST uint PIXEL_FILTER_TRIANGLE = 1u;
CONST uint PIXEL_FILTER_GAUSSIAN = 2u;  // and the other smooth filters: sampled with tables in `distributions`

// A smooth filter has two tables, for x and then for y, each of n intervals from the centre to the radius. A table has
// the filter's values at the n + 1 nodes (no interval contains a change of sign), the n + 1 numbers of the CDF of the
// absolute value (linear between nodes), the integral of the absolute value over that of the filter, and a guide to the
// CDF (Chen and Asau 1974): entry i is the interval at which to start the search for numbers from i/n on, at or just
// before the right one.
struct CameraRecord {
    uint kind;
    uint filter_kind;
    uint filter_tables;     // offset in `distributions`
    uint filter_intervals;  // per table: n
    uint resolution_x;      // of the full film
    uint resolution_y;
    uint crop_x;  // origin of the crop window
    uint crop_y;
    vec4 to0;  // rows of world-from-camera (camera space: +x right, +y up, +z forward, as pbrt's)
    vec4 to1;
    vec4 to2;
    vec4 from0;  // rows of camera-from-world
    vec4 from1;
    vec4 from2;
    vec4 screen;  // raster to camera space at z = 1: x = screen.x + px * screen.z, y = screen.y + py * screen.w
    float lens_radius;
    float focal_distance;
    float max_component;  // limit of a sample's largest component; 0: none
    float imaging_ratio;
    float filter_radius_x;
    float filter_radius_y;
    float volume;  // |det| of world-from-camera
    float unused;
};

struct SceneRecord {
    CameraRecord camera;
    uint light_count;
    uint infinite_lights;  // number of infinite lights, which come first
    uint light_cdf;        // offset in `distributions` of the CDF for choosing a light (light_count + 1 integers)
    float light_power;     // luminous power of all lights (W)
    uint geometry_count;
    uint instance_count;
    uint root_node;         // of the top-level BVH
    uint effects_low;       // effects that the scene needs: the lower 32 bits of the EffectSet
    uint camera_medium;     // medium in which the camera is
    uint effects_high;      // the upper 32 bits
    uint placeless_lights;  // infinite and distant lights, which come first
    uint tree_share;        // of all other lights in choices by power, out of CDF_TOTAL
    uint tree_cdf;          // LightNode
    uint tree_leaves;
    uint unused0;
    uint unused1;
    vec4 bounds;  // the world's bounding sphere: centre, radius
};

// ---- Film ------------------------------------------------------------------------------------------------------------

// Sums of radiance are compensated (Neumaier 1974), sample by sample, so that they do not depend on how passes are
// split into dispatches, and lose nothing over a million samples.
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

// An integrator's estimate of its bias: sums over samples, as in FilmPixel.
struct FilmBias {
    vec4 sum;
    vec4 squares;
};

// The part of the image to be rendered, in pixels of the full film, and the range of samples.
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
