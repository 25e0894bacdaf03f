// Textures: images looked up in packed texels, and programs of operations over a stack of colours (layout.h).
//
// There are no ray differentials: what pbrt filters over a pixel's footprint is sampled at the point here, and the pixel's
// samples average it. Differences are finite, so a bump map shifts by a fixed step (material.h).
#ifndef LAMPYRIS_KERNEL_TEXTURE
#define LAMPYRIS_KERNEL_TEXTURE

// What a texture may depend on.
struct TextureContext {
    vec3 position;  // world space
    vec3 normal;    // unit geometric normal
    vec2 uv;
};

// ---- Images ----------------------------------------------------------------------------------------------------------

// Half float to float by integer arithmetic: the result of a shift may be a denormal, which devices flush to zero.
// Infinities do not occur: the host cuts them when it packs texels.
FN float half_to_float(uint h) {
    uint magnitude = h & 0x7fffu;
    float value = magnitude < 0x0400u ? float(magnitude) * 5.9604644775390625e-8f
                                      : uintBitsToFloat((magnitude << 13u) + 0x38000000u);
    return (h & 0x8000u) != 0u ? -value : value;
}

// The linear value of one texel; x and y must be inside the image.
FN vec3 image_texel(IN(ImageRecord) record, int x, int y) {
    uint kind = record.data.w & 0xffu;
    uint first = record.data.x;
    uint index = uint(y) * record.data.y + uint(x);
    if (kind == TEXEL_RGBA8) {
        uint bytes = texels[first + index];
        uint table = record.decode.x;
        return vec3(uintBitsToFloat(texels[table + (bytes & 0xffu)]), uintBitsToFloat(texels[table + ((bytes >> 8u) & 0xffu)]),
                    uintBitsToFloat(texels[table + ((bytes >> 16u) & 0xffu)]));
    }
    if (kind == TEXEL_R8) {
        uint code = (texels[first + (index >> 2u)] >> ((index & 3u) * 8u)) & 0xffu;
        return vec3(uintBitsToFloat(texels[record.decode.x + code]));
    }
    if (kind == TEXEL_RGBA16F) {
        uint rg = texels[first + 2u * index];
        return vec3(half_to_float(rg & 0xffffu), half_to_float(rg >> 16u), half_to_float(texels[first + 2u * index + 1u] & 0xffffu));
    }
    if (kind == TEXEL_RGB32F) {
        uint at = first + 3u * index;
        return vec3(uintBitsToFloat(texels[at]), uintBitsToFloat(texels[at + 1u]), uintBitsToFloat(texels[at + 2u]));
    }
    return vec3(uintBitsToFloat(texels[first + index]));
}

// x cut to [-1, size], a NaN to -1, so that it converts to an integer on every backend.
FN float image_cut(float x, float size) {
    float low = x >= -1.0f ? x : -1.0f;
    return low <= size ? low : size;
}

// One texel, at most two outside of the image, where the wrap mode says what is there.
FN vec3 image_wrapped_texel(IN(ImageRecord) record, int x, int y) {
    int width = int(record.data.y);
    int height = int(record.data.z);
    int px = x;
    int py = y;
    if (x < 0 || y < 0 || x >= width || y >= height) {
        uint wrap = (record.data.w >> 8u) & 0xffu;
        if (wrap == WRAP_BLACK) return vec3(0.0f);
        if (wrap == WRAP_REPEAT) {
            px = x < 0 ? x + width : (x >= width ? x - width : x);
            py = y < 0 ? y + height : (y >= height ? y - height : y);
        } else if (wrap == WRAP_OCTAHEDRAL) {
            // The square's edge is folded at its middle: beyond it lies the same edge, run through backwards.
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

// An image at st in linear Rec. 709; (0, 0) is the upper left corner of the upper left texel, (1, 1) the lower right corner.
// w is 1. Texel centres lie at half-integers; filter and wrap mode are the image's.
FN vec4 image_lookup(uint image, vec2 st) {
    ImageRecord record = images[image];
    float width = float(record.data.y);
    float height = float(record.data.z);
    vec2 p = st;
    if (((record.data.w >> 8u) & 0xffu) == WRAP_REPEAT) p = vec2(st.x - floor(st.x), st.y - floor(st.y));
    vec3 value;
    if ((record.data.w >> 16u) == FILTER_POINT) {
        value = image_wrapped_texel(record, int(floor(image_cut(p.x * width, width))), int(floor(image_cut(p.y * height, height))));
    } else {
        float x = image_cut(p.x * width - 0.5f, width);
        float y = image_cut(p.y * height - 0.5f, height);
        float x_floor = floor(x);
        float y_floor = floor(y);
        float fx = x - x_floor;
        float fy = y - y_floor;
        int ix = int(x_floor);
        int iy = int(y_floor);
        // One loop, not four calls: a GLSL compiler inlines each of them.
        value = vec3(0.0f);
        for (int tap = 0; tap < 4; ++tap) {
            int dx = tap & 1;
            int dy = tap >> 1;
            float weight = (dx == 0 ? 1.0f - fx : fx) * (dy == 0 ? 1.0f - fy : fy);
            value = value + weight * image_wrapped_texel(record, ix + dx, iy + dy);
        }
    }
    return vec4(value.x, value.y, value.z, 1.0f);
}

// ---- Mappings (pbrt, 4th edition, section 10.2) ----------------------------------------------------------------------

FN vec3 texture_point(uint op, vec3 position) {
    return transform_point(texture_ops[op].m0, texture_ops[op].m1, texture_ops[op].m2, position);
}

FN vec2 texture_st(uint op, IN(TextureContext) c) {
    uint mapping = texture_ops[op].data.y >> 8u;
    vec4 m0 = texture_ops[op].m0;
    if (mapping == MAPPING_UV) return vec2(m0.x * c.uv.x + m0.z, m0.y * c.uv.y + m0.w);
    if (mapping == MAPPING_PLANAR) {
        vec4 m1 = texture_ops[op].m1;
        return vec2(m0.w + (m0.x * c.position.x + m0.y * c.position.y + m0.z * c.position.z),
                    m1.w + (m1.x * c.position.x + m1.y * c.position.y + m1.z * c.position.z));
    }
    vec3 p = texture_point(op, c.position);
    float phi = atan2_of(p.y, p.x);
    if (mapping == MAPPING_CYLINDRICAL) return vec2((PI + phi) * INV_TWO_PI, p.z);
    float theta = atan2_of(sqrt(p.x * p.x + p.y * p.y), p.z);
    return vec2(theta * INV_PI, (phi < 0.0f ? phi + TWO_PI : phi) * INV_TWO_PI);
}

// ---- Gradient noise (Perlin 2002, "Improving Noise") -------------------------------------------------------------------

// Perlin's permutation of 0..255, four bytes a word, lowest first.
CONST uint NOISE_PERMUTATION[64] = {
    0x5b89a097u, 0x0d830f5au, 0x35605fc9u, 0xe107e9c2u, 0x1e67248cu, 0x63088e45u, 0x0a15f025u, 0x9406be17u,
    0x4bea78f7u, 0x3ec51a00u, 0xcbdbfc5eu, 0x200b2375u, 0x5821b139u, 0x573895edu, 0x887d14aeu, 0xaf44a8abu,
    0x8647a54au, 0xa61b308bu, 0xe79e924du, 0x7ae56f53u, 0xe685d33cu, 0x295c69dcu, 0x28f52e37u, 0x368f66f4u,
    0xa13f1941u, 0x4950d801u, 0xbb844cd1u, 0xa91259d0u, 0x8287c4c8u, 0x569fbc74u, 0xc66d64a4u, 0x4003baadu,
    0xfae2d934u, 0xca057b7cu, 0x7e769326u, 0xd45552ffu, 0xe33bcecfu, 0x113a102fu, 0x2a1cbdb6u, 0xd5aab7dfu,
    0x0298f877u, 0x46a39a2cu, 0x9b6599ddu, 0x09ac2ba7u, 0xfd271681u, 0x6e6c6213u, 0xe8e0714fu, 0x6870b9b2u,
    0xe461f6dau, 0xc1f222fbu, 0x0c90d2eeu, 0xf1a2b3bfu, 0xeb913351u, 0x6bef0ef9u, 0x1fd6c031u, 0x9d6ac7b5u,
    0xb0cc54b8u, 0x2d327973u, 0xfe96047fu, 0x5dcdec8au, 0x1d4372deu, 0x8df34818u, 0x424ec380u, 0xb49c3dd7u};

FN uint noise_permute(uint i) { return (NOISE_PERMUTATION[(i & 0xffu) >> 2u] >> ((i & 3u) * 8u)) & 0xffu; }

// The corner's gradient, one of twelve edge directions, dotted with the offset from the corner.
FN float noise_corner(int x, int y, int z, vec3 d) {
    uint h = noise_permute(noise_permute(noise_permute(uint(x)) + uint(y)) + uint(z)) & 15u;
    float u = (h < 8u || h == 12u || h == 13u) ? d.x : d.y;
    float v = (h < 4u || h == 12u || h == 13u) ? d.y : d.z;
    return ((h & 1u) != 0u ? -u : u) + ((h & 2u) != 0u ? -v : v);
}

FN float noise_weight(float t) { return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f); }

// In about [-1, 1]; 0 at every point of the integer lattice, and where coordinates are too large to have a fraction.
FN float noise_at(vec3 p) {
    if (!(abs(p.x) < 1.0e9f && abs(p.y) < 1.0e9f && abs(p.z) < 1.0e9f)) return 0.0f;
    vec3 low = vec3(floor(p.x), floor(p.y), floor(p.z));
    vec3 d = p - low;
    int x = int(low.x) & 255;
    int y = int(low.y) & 255;
    int z = int(low.z) & 255;
    float wx = noise_weight(d.x);
    float wy = noise_weight(d.y);
    float wz = noise_weight(d.z);
    float layers[2];
    for (int k = 0; k < 2; ++k) {
        float dz = d.z - float(k);
        float y0 = lerp_of(wx, noise_corner(x, y, z + k, vec3(d.x, d.y, dz)), noise_corner(x + 1, y, z + k, vec3(d.x - 1.0f, d.y, dz)));
        float y1 = lerp_of(wx, noise_corner(x, y + 1, z + k, vec3(d.x, d.y - 1.0f, dz)),
                           noise_corner(x + 1, y + 1, z + k, vec3(d.x - 1.0f, d.y - 1.0f, dz)));
        layers[k] = lerp_of(wy, y0, y1);
    }
    return lerp_of(wz, layers[0], layers[1]);
}

// Octaves of noise, each 1.99 times as fine and `roughness` times as strong; `turbulent`: of its absolute value, plus the mean
// (0.2) of the first octave left out (pbrt, 4th edition, section 10.6.4 online, without a footprint).
FN float noise_octaves(vec3 p, float roughness, uint octaves, bool turbulent) {
    float sum = 0.0f;
    float frequency = 1.0f;
    float strength = 1.0f;
    for (uint i = 0u; i < octaves; ++i) {
        float value = noise_at(frequency * p);
        sum = sum + strength * (turbulent ? abs(value) : value);
        frequency = frequency * 1.99f;
        strength = strength * roughness;
    }
    return turbulent ? sum + strength * 0.2f : sum;
}

// A cubic Bezier segment of marble's colours at t in [0, 1]; the spline's control points are pbrt's.
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

// The textures made of noise.
FN vec3 texture_noise(uint op, uint kind, uint octaves, vec3 position) {
    vec4 a = texture_ops[op].a;
    vec3 p = texture_point(op, position);
    if (kind == TEXTURE_MARBLE) p = a.y * p;
    // Windy: slow gusts over waves; one call site for both sums.
    float gust = 1.0f;
    float sum = 0.0f;
    uint passes = kind == TEXTURE_WINDY ? 2u : 1u;
    for (uint pass = 0u; pass < passes; ++pass) {
        bool is_gust = kind == TEXTURE_WINDY && pass == 0u;
        sum = noise_octaves(is_gust ? 0.1f * p : p, kind == TEXTURE_WINDY ? 0.5f : a.x, is_gust ? 3u : octaves,
                            kind == TEXTURE_WRINKLED);
        if (is_gust) gust = abs(sum);
    }
    if (kind == TEXTURE_MARBLE) return marble_spline(0.5f + 0.5f * sin_of(p.y + a.z * sum));
    return vec3(gust * sum);
}

// Whether st lies in a dot: cells with positive noise have one, of radius 0.35, shifted at random inside the cell.
FN bool texture_in_dot(vec2 st) {
    float s = floor(st.x + 0.5f);
    float t = floor(st.y + 0.5f);
    float value[3];
    for (int i = 0; i < 3; ++i) {
        vec2 shift = i == 0 ? vec2(0.5f, 0.5f) : (i == 1 ? vec2(1.5f, 2.8f) : vec2(4.5f, 9.8f));
        value[i] = noise_at(vec3(s + shift.x, t + shift.y, 0.5f));
    }
    float x = st.x - (s + 0.15f * value[1]);
    float y = st.y - (t + 0.15f * value[2]);
    return value[0] > 0.0f && x * x + y * y < 0.35f * 0.35f;
}

// ---- Programs ----------------------------------------------------------------------------------------------------------

// 1 in odd cells of the unit lattice, 0 in even ones.
FN bool texture_odd(uint op, uint dimension, IN(TextureContext) c) {
    float sum;
    if (dimension == 3u) {
        vec3 p = texture_point(op, c.position);
        sum = floor(p.x) + floor(p.y) + floor(p.z);
    } else {
        vec2 st = texture_st(op, c);
        sum = floor(st.x) + floor(st.y);
    }
    return sum - 2.0f * floor(0.5f * sum) == 1.0f;
}

FN vec3 texture_image(uint op, uvec4 code, IN(TextureContext) c) {
    vec2 st = texture_st(op, c);
    vec4 a = texture_ops[op].a;
    // Texture coordinates have (0, 0) in the lower left corner, images in the upper left one.
    vec4 found = image_lookup(code.z, vec2(st.x, 1.0f - st.y));
    vec3 value = vec3(found.x * a.x, found.y * a.y, found.z * a.z);
    if ((code.w & 1u) != 0u) value = max(vec3(1.0f) - value, vec3(0.0f));
    return value;
}

// The value of a texture. Every operand is evaluated, also those that a checkerboard does not show: a loop over operations
// branches alike for all points of a program.
FN vec3 texture_color(uint program, IN(TextureContext) c) {
    // The top of the stack is a variable: a program of one operation, the common case, touches no array.
    vec3 stack[TEXTURE_STACK];
    vec3 top = vec3(0.0f);
    uint depth = 0u;  // of `stack`, without the top
    for (uint i = 0u; i < TEXTURE_LENGTH; ++i) {
        uint op = program + i;
        uvec4 code = texture_ops[op].data;
        uint kind = code.x;
        if (kind < TEXTURE_CHECKERBOARD) {
            if (i > 0u) {
                stack[depth] = top;
                depth = depth + 1u;
            }
            vec4 a = texture_ops[op].a;
            top = vec3(a.x, a.y, a.z);
            if (HAS(EFFECT_IMAGES) && kind == TEXTURE_IMAGE) top = texture_image(op, code, c);
            if (HAS(EFFECT_NOISE) && kind >= TEXTURE_FBM) top = texture_noise(op, kind, code.w, c.position);
        } else {
            depth = depth - 1u;
            vec3 first = stack[depth];
            if (kind == TEXTURE_SCALE) {
                top = first * top;
            } else if (kind == TEXTURE_MIX) {
                depth = depth - 1u;
                top = lerp3_of(top.x, stack[depth], first);
            } else if (kind == TEXTURE_CHECKERBOARD) {
                top = texture_odd(op, code.w, c) ? top : first;
            } else if (kind == TEXTURE_DIRECTION_MIX) {
                vec4 a = texture_ops[op].a;
                top = lerp3_of(abs_dot(c.normal, vec3(a.x, a.y, a.z)), top, first);
            } else if (HAS(EFFECT_NOISE) && kind == TEXTURE_DOTS) {
                top = texture_in_dot(texture_st(op, c)) ? first : top;
            } else {
                depth = depth - 2u;
                vec2 st = texture_st(op, c);
                top = (1.0f - st.x) * ((1.0f - st.y) * stack[depth] + st.y * stack[depth + 1u]) +
                      st.x * ((1.0f - st.y) * first + st.y * top);
            }
        }
        if ((code.y & 1u) != 0u) return top;
    }
    REPORT_UNFINISHED();
    return top;
}

FN float texture_float(uint program, IN(TextureContext) c) { return texture_color(program, c).x; }

#endif
