// Choosing a light by what it is likely to send to a point, where a scene has many: a tree of bounds of lights (Conty Estevez
// and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting"; without the splitting).
//
// Lights without a place (infinite, distant) come first in the list, and keep their shares by power. The share of the others
// is divided from the root on, in proportion to the importance of two children, until all lights below a node are in about the
// same place, seen from the point: one of these is chosen by its intensity. The share is divided as an integer, as CDFs are, so
// that the probability of a node is exactly what it is left with over CDF_TOTAL. One choice in LIGHT_CHOICES_BY_POWER is made by
// power, so that every light is found where bounds say that it sends nothing (smooth normals, masks and rounding are beyond them).
#ifndef LAMPYRIS_KERNEL_LIGHT_TREE
#define LAMPYRIS_KERNEL_LIGHT_TREE

CONST uint LIGHT_CHOICES_BY_POWER = 8u;
CONST float LIGHTS_FAR =
    64.0f;  // squared distance, over the squared radius, from which lights are in about the same place

FN bool uses_light_tree() { return HAS(EFFECT_LIGHT_TREE) && scene[0].tree_leaves != 0u; }
FN float choice_by_power(uint light) { return lights[light].choice_probability; }

// The cosine and sine of max(a - b, 0), for angles between 0 and pi by their sines and cosines.
FN float cos_of_difference(float sin_a, float cos_a, float sin_b, float cos_b) {
    return cos_a > cos_b ? 1.0f : cos_a * cos_b + sin_a * sin_b;
}
FN float sin_of_difference(float sin_a, float cos_a, float sin_b, float cos_b) {
    return cos_a > cos_b ? 0.0f : sin_a * cos_b - cos_a * sin_b;
}

// An estimate of the irradiance of the lights below a node at ref_p, where a surface faces them, from their intensity, the
// squared distance to the middle, and the least angle between a normal and the direction to ref_p (pbrt, 4th edition,
// section 12.6.3).
FN float light_importance(IN(LightNode) node, vec3 ref_p) {
    vec3 way = ref_p - node.middle;
    float d2 = length_squared(way);
    // Within the sphere, lights may be in all directions.
    if (!(d2 > node.radius2)) return node.intensity / node.radius2;
    float cos_way = dot3(node.axis, way) / sqrt(d2);
    if (node.two_sided != 0u) cos_way = abs(cos_way);
    float sin_way = safe_sqrt(1.0f - sqr(cos_way));
    float sin_cone = safe_sqrt(1.0f - sqr(node.cos_normals));
    float cos_x = cos_of_difference(sin_way, cos_way, sin_cone, node.cos_normals);
    float sin_x = sin_of_difference(sin_way, cos_way, sin_cone, node.cos_normals);
    float sin2_box = node.radius2 / d2;
    float cos_least = cos_of_difference(sin_x, cos_x, sqrt(sin2_box), safe_sqrt(1.0f - sin2_box));
    return cos_least < node.cos_emission ? 0.0f : node.intensity * max(cos_least, 0.0f) / d2;
}

// The leaves below a node, and their share of CDF_TOTAL.
struct LightPart {
    uint node;
    uint first;  // leaf
    uint leaves;
    uint share;
};

FN LightPart whole_light_tree() {
    LightPart part;
    part.node = 0u;
    part.first = 0u;
    part.leaves = scene[0].tree_leaves;
    part.share = scene[0].tree_share;
    return part;
}

// Whether its lights are chosen by intensity alone.
FN bool is_far_part(IN(LightPart) part, vec3 ref_p) {
    return part.leaves == 1u ||
           length_squared(ref_p - light_nodes[part.node].middle) > LIGHTS_FAR * light_nodes[part.node].radius2;
}

// The left half of a part.
FN LightPart left_half(IN(LightPart) part, vec3 ref_p) {
    uint right = light_nodes[part.node].right;
    LightNode a = light_nodes[part.node + 1u];
    LightNode b = light_nodes[right];
    float of_left = light_importance(a, ref_p);
    float sum = of_left + light_importance(b, ref_p);
    if (!(sum > 0.0f) || !is_finite(sum)) {
        of_left = a.intensity;
        sum = a.intensity + b.intensity;
    }
    LightPart left;
    left.node = part.node + 1u;
    left.first = part.first;
    left.leaves = (right - part.node) >> 1u;  // of k leaves there are 2 k - 1 nodes
    left.share = min(uint(of_left / sum * float_of_uint(part.share)), part.share);
    return left;
}
FN LightPart other_half(IN(LightPart) part, IN(LightPart) left) {
    LightPart right;
    right.node = light_nodes[part.node].right;
    right.first = left.first + left.leaves;
    right.leaves = part.leaves - left.leaves;
    right.share = part.share - left.share;
    return right;
}

// The probability of a leaf of a part that is far.
FN float leaf_probability(IN(LightPart) part, uint leaf) {
    uint at = scene[0].tree_cdf;
    float of_part = float_of_uint(distributions[at + leaf + 1u] - distributions[at + leaf]) /
                    float_of_uint(distributions[at + part.first + part.leaves] - distributions[at + part.first]);
    float by_power = 1.0f / float(LIGHT_CHOICES_BY_POWER);
    uint light = distributions[at + scene[0].tree_leaves + 1u + leaf];
    return by_power * choice_by_power(light) +
           (1.0f - by_power) * (float_of_uint(part.share) * 4.656612873077393e-10f) * of_part;  // 1 / CDF_TOTAL
}

// The probability with which choose_light_by_tree(ref_p, ...) chooses a light; without a tree, that of choices by power.
FN float light_choice_probability(uint light, vec3 ref_p) {
    float by_power = choice_by_power(light);
    if (!HAS(EFFECT_LIGHT_TREE) || !uses_light_tree() || light < scene[0].placeless_lights) return by_power;
    if (by_power == 0.0f) return 0.0f;  // it is not in the tree
    uint leaf = lights[light].distribution;
    LightPart part = whole_light_tree();
    while (!is_far_part(part, ref_p)) {
        LightPart left = left_half(part, ref_p);
        bool is_left = leaf < left.first + left.leaves;
        if (is_left)
            part = left;
        else
            part = other_half(part, left);
    }
    return leaf_probability(part, leaf);
}

struct LightChoice {
    uint light;
    float probability;
};

// Chooses a light for ref_p by 32 random bits.
FN LightChoice choose_light_by_tree(vec3 ref_p, uint bits) {
    LightChoice chosen;
    uint number = cdf_number(bits);
    uint placeless = CDF_TOTAL - scene[0].tree_share;
    uint more_bits = hash32(bits);
    if (more_bits % LIGHT_CHOICES_BY_POWER == 0u || number < placeless) {
        chosen.light = find_interval(scene[0].light_cdf, scene[0].light_count, number);
        chosen.probability = light_choice_probability(chosen.light, ref_p);
        return chosen;
    }
    number -= placeless;
    LightPart part = whole_light_tree();
    while (!is_far_part(part, ref_p)) {
        LightPart left = left_half(part, ref_p);
        bool is_left = number < left.share;
        if (is_left) {
            part = left;
        } else {
            number -= left.share;
            part = other_half(part, left);
        }
    }
    // What is left of the number may have few digits. The bits are hashed, not what is left: that would change all choices in a
    // scene that is moved by a rounding error.
    uint at = scene[0].tree_cdf;
    uint low = distributions[at + part.first];
    uint among = low + mul_high(hash32(more_bits), distributions[at + part.first + part.leaves] - low);
    uint leaf = part.first + find_interval(at + part.first, part.leaves, among);
    chosen.light = distributions[at + scene[0].tree_leaves + 1u + leaf];
    chosen.probability = leaf_probability(part, leaf);
    return chosen;
}

#endif
