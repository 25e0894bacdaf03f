// Textures: images looked up in packed texels, and programs of operations over a stack of colours (layout.h).
//
// There are no ray differentials. Where pbrt filters over a pixel's footprint, textures are evaluated at the point
// here, and the pixel's samples average them. Bump maps use finite differences with a fixed step (material.h).
#ifndef LAMPYRIS_KERNEL_TEXTURE
#define LAMPYRIS_KERNEL_TEXTURE

// What a texture may depend on.
struct TextureContext {
    vec3 position;  // world space
    vec3 normal;    // unit geometric normal
    vec2 uv;
};

// ---- Images ----------------------------------------------------------------------------------------------------------

// Converts a half float to a float by integer arithmetic. Half denormals are multiplied, because shifting them would
// give float denormals, which devices flush to zero. Infinities do not occur: the host clamps them when it packs
// texels.
FN float half_to_float(uint h) {
    uint magnitude = h & 0x7fffu;
    float value = magnitude < 0x0400u ? float(magnitude) * 5.9604644775390625e-8f
                                      : uintBitsToFloat((magnitude << 13u) + 0x38000000u);
    return (h & 0x8000u) != 0u ? -value : value;
}

// The linear value of one texel; x and y must be inside the image.
FN vec3 image_texel(IN(ImageRecord) record, int x, int y) {
    uint kind = record.format & 0xffu;
    uint first = record.first_texel;
    uint index = uint(y) * record.width + uint(x);
    if (kind == TEXEL_RGBA8) {
        uint bytes = texels[first + index];
        uint table = record.decoding;
        return vec3(uintBitsToFloat(texels[table + (bytes & 0xffu)]),
                    uintBitsToFloat(texels[table + ((bytes >> 8u) & 0xffu)]),
                    uintBitsToFloat(texels[table + ((bytes >> 16u) & 0xffu)]));
    }
    if (kind == TEXEL_R8) {
        uint code = (texels[first + (index >> 2u)] >> ((index & 3u) * 8u)) & 0xffu;
        return vec3(uintBitsToFloat(texels[record.decoding + code]));
    }
    if (kind == TEXEL_RGBA16F) {
        uint rg = texels[first + 2u * index];
        return vec3(half_to_float(rg & 0xffffu), half_to_float(rg >> 16u),
                    half_to_float(texels[first + 2u * index + 1u] & 0xffffu));
    }
    if (kind == TEXEL_RGB32F) {
        uint at = first + 3u * index;
        return vec3(uintBitsToFloat(texels[at]), uintBitsToFloat(texels[at + 1u]), uintBitsToFloat(texels[at + 2u]));
    }
    return vec3(uintBitsToFloat(texels[first + index]));
}

// x clamped to [-1, size], and -1 for NaN, so that it can be converted to an integer on every backend.
FN float image_cut(float x, float size) {
    float low = x >= -1.0f ? x : -1.0f;
    return low <= size ? low : size;
}

// One texel. x and y may be up to two texels outside of the image, where the wrap mode applies.
FN vec3 image_wrapped_texel(IN(ImageRecord) record, int x, int y) {
    int width = int(record.width);
    int height = int(record.height);
    int px = x;
    int py = y;
    if (x < 0 || y < 0 || x >= width || y >= height) {
        uint wrap = (record.format >> 8u) & 0xffu;
        if (wrap == WRAP_BLACK) return vec3(0.0f);
        if (wrap == WRAP_REPEAT) {
            px = x < 0 ? x + width : (x >= width ? x - width : x);
            py = y < 0 ? y + height : (y >= height ? y - height : y);
        } else if (wrap == WRAP_OCTAHEDRAL) {
            // The square's edge is folded at its middle: beyond it, the same edge continues in the opposite direction.
            if (x < 0 || x >= width) {
                px = x < 0 ? -1 - x : 2 * width - 1 - x;
                py = height - 1 - py;
            }
            if (y < 0 || y >= height) {
                py = py < 0 ? -1 - py : (py >= height ? 2 * height - 1 - py : py);
                px = width - 1 - px;
            }
        }
        px = clamp(px, 0, width - 1);
        py = clamp(py, 0, height - 1);
    }
    return image_texel(record, px, py);
}

// The image's value at st, in linear Rec. 709, with w = 1. (0, 0) is the upper left corner of the image,
// (1, 1) its lower right corner. Texel centres are at half-integers; filter and wrap mode are the image's.
FN vec4 image_lookup(uint image, vec2 st) {
    ImageRecord record = images[image];
    float width = float(record.width);
    float height = float(record.height);
    vec2 p = st;
    if (((record.format >> 8u) & 0xffu) == WRAP_REPEAT) p = vec2(st.x - floor(st.x), st.y - floor(st.y));
    bool interpolated = (record.format >> 16u) != FILTER_POINT;
    float shift = interpolated ? 0.5f : 0.0f;
    float x = image_cut(p.x * width - shift, width);
    float y = image_cut(p.y * height - shift, height);
    float x_floor = floor(x);
    float y_floor = floor(y);
    float fx = interpolated ? x - x_floor : 0.0f;
    float fy = interpolated ? y - y_floor : 0.0f;
    int ix = int(x_floor);
    int iy = int(y_floor);
    // One loop with a trip count that a GLSL compiler does not know: it would copy the body for each iteration.
    int taps = interpolated ? 4 : 1;
    vec3 value = vec3(0.0f);
    for (int tap = 0; tap < taps; ++tap) {
        int dx = tap & 1;
        int dy = tap >> 1;
        float weight = (dx == 0 ? 1.0f - fx : fx) * (dy == 0 ? 1.0f - fy : fy);
        value = value + weight * image_wrapped_texel(record, ix + dx, iy + dy);
    }
    return vec4(value.x, value.y, value.z, 1.0f);
}

// ---- Mappings (pbrt, 4th edition, section 10.2) ----------------------------------------------------------------------

// The coordinates of an operation: (s, t, 0), or, for MAPPING_SPACE, the point in the texture's space.
FN vec3 texture_mapped(uint op, uint mapping, IN(TextureContext) c) {
    vec4 m0 = texture_ops[op].m0;
    if (mapping == MAPPING_UV) return vec3(m0.x * c.uv.x + m0.z, m0.y * c.uv.y + m0.w, 0.0f);
    vec4 m1 = texture_ops[op].m1;
    vec3 p = transform_point(m0, m1, texture_ops[op].m2, c.position);
    if (mapping == MAPPING_PLANAR) return vec3(p.x, p.y, 0.0f);
    if (mapping == MAPPING_SPACE) return p;
    float phi = atan2_of(p.y, p.x);
    if (mapping == MAPPING_CYLINDRICAL) return vec3((PI + phi) * INV_TWO_PI, p.z, 0.0f);
    float theta = atan2_of(sqrt(p.x * p.x + p.y * p.y), p.z);
    return vec3(theta * INV_PI, (phi < 0.0f ? phi + TWO_PI : phi) * INV_TWO_PI, 0.0f);
}

// ---- Gradient noise (Perlin 2002, "Improving Noise") -------------------------------------------------------------------

// `table`: offset of Perlin's permutation of 0..255 in `texels`.
FN uint noise_permute(uint table, uint i) { return texels[table + (i & 0xffu)]; }

// The corner's gradient, one of twelve edge directions, dotted with the offset from the corner.
FN float noise_corner(uint table, int x, int y, int z, vec3 d) {
    uint h = noise_permute(table, noise_permute(table, noise_permute(table, uint(x)) + uint(y)) + uint(z)) & 15u;
    float u = (h < 8u || h == 12u || h == 13u) ? d.x : d.y;
    float v = (h < 4u || h == 12u || h == 13u) ? d.y : d.z;
    return ((h & 1u) != 0u ? -u : u) + ((h & 2u) != 0u ? -v : v);
}

FN float noise_weight(float t) { return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f); }

// Noise in about [-1, 1]; 0 at every point of the integer lattice, and if coordinates are too large to have a fraction.
FN float noise_at(uint table, vec3 p) {
    if (!(abs(p.x) < 1.0e9f && abs(p.y) < 1.0e9f && abs(p.z) < 1.0e9f)) return 0.0f;
    vec3 low = vec3(floor(p.x), floor(p.y), floor(p.z));
    vec3 d = p - low;
    float wx = noise_weight(d.x);
    float wy = noise_weight(d.y);
    float wz = noise_weight(d.z);
    float sum = 0.0f;
    for (int corner = 0; corner < 8; ++corner) {
        int dx = corner & 1;
        int dy = (corner >> 1) & 1;
        int dz = corner >> 2;
        float weight = (dx == 0 ? 1.0f - wx : wx) * (dy == 0 ? 1.0f - wy : wy) * (dz == 0 ? 1.0f - wz : wz);
        sum = sum + weight * noise_corner(table, int(low.x) + dx, int(low.y) + dy, int(low.z) + dz,
                                          vec3(d.x - float(dx), d.y - float(dy), d.z - float(dz)));
    }
    return sum;
}

// Marble's colours are a spline of cubic Bezier segments with pbrt's control points; `at` is in [0, 1].
CONST uint MARBLE_SEGMENTS = 6u;
FN vec3 marble_color(uint i) {
    if (i == 3u) return vec3(0.5f, 0.5f, 0.5f);
    if (i == 4u) return vec3(0.6f, 0.59f, 0.58f);
    if (i == 7u) return vec3(0.2f, 0.2f, 0.33f);
    return vec3(0.58f, 0.58f, 0.6f);
}
FN vec3 marble_spline(float at) {
    float scaled = clamp(at, 0.0f, 1.0f) * float(MARBLE_SEGMENTS);
    uint first = min(uint(scaled), MARBLE_SEGMENTS - 1u);
    float t = scaled - float(first);
    float u = 1.0f - t;
    vec3 value = (u * u * u) * marble_color(first) + (3.0f * u * u * t) * marble_color(first + 1u) +
                 (3.0f * u * t * t) * marble_color(first + 2u) + (t * t * t) * marble_color(first + 3u);
    return 1.5f * value;
}

// The value of a noise operation at a point in its texture's space, or at (s, t, 0).
// TEXTURE_FBM and TEXTURE_WRINKLED: octaves, each with 1.99 times the frequency and `roughness` times the amplitude of
// the one before. Wrinkled sums absolute values, and adds the mean (0.2) of the first octave that is left out (pbrt,
// 4th edition, section 10.6.4 online, without a footprint).
// TEXTURE_WINDY: waves times the strength of slow gusts.
// TEXTURE_DOTS: 1 in a dot, else 0. Cells with positive noise have a dot of radius 0.35 at a random offset.
// All are sums in one loop, because a GLSL compiler copies noise_at for each call.
FN vec3 texture_noise(uint op, vec3 mapped) {
    vec4 a = texture_ops[op].a;
    uint kind = texture_ops[op].operation;
    bool dots = kind == TEXTURE_DOTS;
    bool windy = kind == TEXTURE_WINDY;
    vec3 p = kind == TEXTURE_MARBLE ? a.y * mapped : mapped;
    float roughness = windy ? 0.5f : a.x;
    vec3 cell = vec3(floor(p.x + 0.5f), floor(p.y + 0.5f), 0.5f);
    uint gusts = windy ? 3u : 0u;
    uint count = dots ? 3u : texture_ops[op].option + gusts;
    vec3 found = vec3(0.0f);  // dots: noise at three points
    float gust = 0.0f;
    float sum = 0.0f;
    float frequency = windy ? 0.1f : 1.0f;
    float strength = 1.0f;
    for (uint i = 0u; i < count; ++i) {
        if (windy && i == gusts) {
            gust = sum;
            sum = 0.0f;
            frequency = 1.0f;
            strength = 1.0f;
        }
        vec3 at = frequency * p;
        if (dots)
            at =
                cell + (i == 0u ? vec3(0.5f, 0.5f, 0.0f) : (i == 1u ? vec3(1.5f, 2.8f, 0.0f) : vec3(4.5f, 9.8f, 0.0f)));
        float value = noise_at(texture_ops[op].image, at);
        if (i == 0u)
            found.x = value;
        else if (i == 1u)
            found.y = value;
        else if (i == 2u)
            found.z = value;
        sum = sum + strength * (kind == TEXTURE_WRINKLED ? abs(value) : value);
        frequency = frequency * 1.99f;
        strength = strength * roughness;
    }
    if (dots) {
        float x = p.x - (cell.x + 0.15f * found.y);
        float y = p.y - (cell.y + 0.15f * found.z);
        return vec3(found.x > 0.0f && x * x + y * y < 0.35f * 0.35f ? 1.0f : 0.0f);
    }
    if (kind == TEXTURE_WRINKLED) sum = sum + strength * 0.2f;
    if (windy) sum = abs(gust) * sum;
    if (kind == TEXTURE_MARBLE) return marble_spline(0.5f + 0.5f * sin_of(p.y + a.z * sum));
    return vec3(sum);
}

// ---- Programs ----------------------------------------------------------------------------------------------------------

FN vec3 texture_image(uint op, vec2 st) {
    vec4 a = texture_ops[op].a;
    // Texture coordinates have (0, 0) in the lower left corner, images in the upper left one.
    vec4 found = image_lookup(texture_ops[op].image, vec2(st.x, 1.0f - st.y));
    vec3 value = vec3(found.x * a.x, found.y * a.y, found.z * a.z);
    if ((texture_ops[op].option & 1u) != 0u) value = max(vec3(1.0f) - value, vec3(0.0f));
    return value;
}

// The value of a texture. All operands are evaluated, even those that a checkerboard does not show, so that the loop
// over operations branches equally for all points of a program.
RARE_FN vec3 texture_color(uint program, IN(TextureContext) c) {
    // The top of the stack is a variable, so that a program of one operation, the common case, uses no array.
    vec3 stack[TEXTURE_STACK];
    vec3 top = vec3(0.0f);
    uint depth = 0u;  // size of `stack`, which excludes the top
    for (uint i = 0u; i < TEXTURE_LENGTH; ++i) {
        uint op = program + i;
        uint kind = texture_ops[op].operation;
        uint flags = texture_ops[op].flags;
        uint mapping = flags >> 8u;
        vec3 mapped = vec3(0.0f);
        if (mapping != MAPPING_NONE) mapped = texture_mapped(op, mapping, c);
        vec3 noise = vec3(0.0f);
        if (HAS(EFFECT_NOISE) && ((kind >= TEXTURE_FBM && kind <= TEXTURE_MARBLE) || kind == TEXTURE_DOTS)) {
            noise = texture_noise(op, mapped);
        }
        if (kind < TEXTURE_CHECKERBOARD) {
            if (i > 0u) {
                stack[depth] = top;
                depth = depth + 1u;
            }
            vec4 a = texture_ops[op].a;
            top = kind >= TEXTURE_FBM ? noise : vec3(a.x, a.y, a.z);
            if (HAS(EFFECT_IMAGES) && kind == TEXTURE_IMAGE) top = texture_image(op, vec2(mapped.x, mapped.y));
        } else {
            depth = depth - 1u;
            vec3 first = stack[depth];
            if (kind == TEXTURE_SCALE) {
                top = first * top;
            } else if (kind == TEXTURE_MIX) {
                depth = depth - 1u;
                top = lerp3_of(top.x, stack[depth], first);
            } else if (kind == TEXTURE_CHECKERBOARD) {
                // The third coordinate of (s, t, 0) adds nothing.
                float sum = floor(mapped.x) + floor(mapped.y) + floor(mapped.z);
                top = sum - 2.0f * floor(0.5f * sum) == 1.0f ? top : first;
            } else if (kind == TEXTURE_DIRECTION_MIX) {
                vec4 a = texture_ops[op].a;
                top = lerp3_of(abs_dot(c.normal, vec3(a.x, a.y, a.z)), top, first);
            } else if (kind == TEXTURE_DOTS) {
                top = noise.x != 0.0f ? first : top;
            } else {
                depth = depth - 2u;
                top = (1.0f - mapped.x) * ((1.0f - mapped.y) * stack[depth] + mapped.y * stack[depth + 1u]) +
                      mapped.x * ((1.0f - mapped.y) * first + mapped.y * top);
            }
        }
        if ((flags & 1u) != 0u) return top;
    }
    REPORT_UNFINISHED();
    return top;
}

FN float texture_float(uint program, IN(TextureContext) c) { return texture_color(program, c).x; }

#endif
