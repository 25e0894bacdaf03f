#include "support/texture_reference.h"

#include "core/scene/noise_table.h"

#include <algorithm>
#include <cmath>

namespace lampyris::test {

namespace {

constexpr double kPi = 3.14159265358979323846;

// Perlin 2002, "Improving Noise": the twelve edge directions in the order of the hash. The four that come twice are pbrt's choice.
constexpr int kEdges[16][3] = {{1, 1, 0},  {-1, 1, 0},  {1, -1, 0}, {-1, -1, 0}, {1, 0, 1},  {-1, 0, 1},
                               {1, 0, -1}, {-1, 0, -1}, {0, 1, 1},  {0, -1, 1},  {0, 1, -1}, {0, -1, -1},
                               {1, 1, 0},  {-1, 1, 0},  {0, 1, -1}, {0, -1, -1}};

int permuted(int64_t i) { return kNoisePermutation[((i % 256) + 256) % 256]; }

double octaves(glm::dvec3 p, double roughness, uint32_t count, bool turbulent) {
    double sum = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const double value = reference_noise(std::pow(1.99, i) * p);
        sum += std::pow(roughness, i) * (turbulent ? std::abs(value) : value);
    }
    return turbulent ? sum + 0.2 * std::pow(roughness, count) : sum;
}

glm::dvec3 marble(double t) {
    const glm::dvec3 light(0.58, 0.58, 0.6), grey(0.5), warm(0.6, 0.59, 0.58), dark(0.2, 0.2, 0.33);
    const glm::dvec3 points[] = {light, light, light, grey, warm, light, light, dark, light};
    const int first = std::min(int(std::floor(t * 6)), 5);
    std::vector<glm::dvec3> p(points + first, points + first + 4);
    const double x = t * 6 - first;
    for (size_t n = 3; n > 0; --n)  // de Casteljau
        for (size_t i = 0; i < n; ++i) p[i] = (1 - x) * p[i] + x * p[i + 1];
    return 1.5 * p[0];
}

glm::dvec3 texture_space(const TextureOp& op, glm::dvec3 p) {
    const glm::dvec4 point(p, 1.0);
    return {glm::dot(glm::dvec4(op.m0), point), glm::dot(glm::dvec4(op.m1), point), glm::dot(glm::dvec4(op.m2), point)};
}

double edge_distance(double x) { return std::abs(x - std::round(x)); }

bool in_dot(glm::dvec2 st, double& margin) {
    const double s = std::floor(st.x + 0.5), t = std::floor(st.y + 0.5);
    // In the middle of a cell noise is a sum of eighths, exact in any precision.
    const double present = reference_noise({s + 0.5, t + 0.5, 0.5});
    const glm::dvec2 centre(s + 0.15 * reference_noise({s + 1.5, t + 2.8, 0.5}),
                            t + 0.15 * reference_noise({s + 4.5, t + 9.8, 0.5}));
    margin = std::min(
        {margin, edge_distance(st.x + 0.5), edge_distance(st.y + 0.5), std::abs(glm::distance(st, centre) - 0.35)});
    return present > 0 && glm::distance(st, centre) < 0.35;
}

}  // namespace

double reference_noise(glm::dvec3 p) {
    const glm::dvec3 low = glm::floor(p), d = p - low;
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const int offset[3] = {corner & 1, corner >> 1 & 1, corner >> 2};
        int hash = 0;
        for (int axis = 0; axis < 3; ++axis) hash = permuted(hash + int64_t(low[axis]) % 256 + offset[axis]);
        double weight = 1, slope = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double t = d[axis];
            const double fade = t * t * t * (10 + t * (-15 + t * 6));
            weight *= offset[axis] ? fade : 1 - fade;
            slope += kEdges[hash % 16][axis] * (t - offset[axis]);
        }
        sum += weight * slope;
    }
    return sum;
}

std::vector<TextureOp> postfix(const TextureNode& node) {
    std::vector<TextureOp> ops;
    for (const TextureNode& operand : node.operands) {
        const std::vector<TextureOp> own = postfix(operand);
        ops.insert(ops.end(), own.begin(), own.end());
    }
    ops.push_back(node.op);
    return ops;
}

size_t stack_depth(const TextureNode& node) {
    size_t depth = 1;
    for (size_t i = 0; i < node.operands.size(); ++i) depth = std::max(depth, i + stack_depth(node.operands[i]));
    return depth;
}

glm::dvec2 reference_st(const TextureOp& op, const TexturePoint& point) {
    const uint32_t mapping = op.flags >> 8;
    if (mapping == kernel::MAPPING_UV) return {op.m0.x * point.uv.x + op.m0.z, op.m0.y * point.uv.y + op.m0.w};
    if (mapping == kernel::MAPPING_PLANAR)
        return {glm::dot(glm::dvec3(op.m0), point.position) + op.m0.w,
                glm::dot(glm::dvec3(op.m1), point.position) + op.m1.w};
    const glm::dvec3 p = texture_space(op, point.position);
    const double phi = std::atan2(p.y, p.x);
    if (mapping == kernel::MAPPING_CYLINDRICAL) return {(kPi + phi) / (2 * kPi), p.z};
    return {std::acos(p.z / glm::length(p)) / kPi, (phi < 0 ? phi + 2 * kPi : phi) / (2 * kPi)};
}

glm::dvec3 reference_color(const TextureNode& node, const TexturePoint& point, const ImageReference& images,
                           double& margin) {
    const TextureOp& op = node.op;
    std::vector<glm::dvec3> x;
    for (const TextureNode& operand : node.operands) x.push_back(reference_color(operand, point, images, margin));
    switch (op.operation) {
        case kernel::TEXTURE_CONSTANT: return glm::dvec3(op.a);
        case kernel::TEXTURE_IMAGE: {
            const glm::dvec2 st = reference_st(op, point);
            const glm::dvec3 value = glm::dvec3(op.a) * images(op.image, {st.x, 1 - st.y}, margin);
            return op.option ? glm::max(1.0 - value, 0.0) : value;
        }
        case kernel::TEXTURE_FBM:
            return glm::dvec3(octaves(texture_space(op, point.position), op.a.x, op.option, false));
        case kernel::TEXTURE_WRINKLED:
            return glm::dvec3(octaves(texture_space(op, point.position), op.a.x, op.option, true));
        case kernel::TEXTURE_WINDY: {
            const glm::dvec3 p = texture_space(op, point.position);
            return glm::dvec3(std::abs(octaves(0.1 * p, 0.5, 3, false)) * octaves(p, 0.5, op.option, false));
        }
        case kernel::TEXTURE_MARBLE: {
            const glm::dvec3 p = double(op.a.y) * texture_space(op, point.position);
            return marble(0.5 + 0.5 * std::sin(p.y + op.a.z * octaves(p, op.a.x, op.option, false)));
        }
        case kernel::TEXTURE_CHECKERBOARD: {
            glm::dvec3 p(reference_st(op, point), 0.5);
            if (op.flags >> 8 == kernel::MAPPING_SPACE) p = texture_space(op, point.position);
            int64_t cell = 0;
            for (int axis = 0; axis < 3; ++axis) {
                margin = std::min(margin, edge_distance(p[axis]));
                cell += int64_t(std::floor(p[axis]));
            }
            return x[size_t(std::abs(cell) % 2)];
        }
        case kernel::TEXTURE_SCALE: return x[0] * x[1];
        case kernel::TEXTURE_MIX: return glm::mix(x[0], x[1], x[2].x);
        case kernel::TEXTURE_DIRECTION_MIX:
            return glm::mix(x[1], x[0], std::abs(glm::dot(point.normal, glm::dvec3(op.a))));
        case kernel::TEXTURE_DOTS: return in_dot(reference_st(op, point), margin) ? x[0] : x[1];
        default: {
            const glm::dvec2 st = reference_st(op, point);
            return glm::mix(glm::mix(x[0], x[2], st.x), glm::mix(x[1], x[3], st.x), st.y);
        }
    }
}

glm::dvec3 PlainImage::at(int64_t x, int64_t y) const {
    const int64_t w = width, h = height;
    const bool outside_x = x < 0 || x >= w, outside_y = y < 0 || y >= h;
    if (wrap == kernel::WRAP_BLACK && (outside_x || outside_y)) return glm::dvec3(0);
    if (wrap == kernel::WRAP_REPEAT) x = (x % w + w) % w, y = (y % h + h) % h;
    if (wrap == kernel::WRAP_CLAMP) x = std::clamp<int64_t>(x, 0, w - 1), y = std::clamp<int64_t>(y, 0, h - 1);
    if (wrap == kernel::WRAP_OCTAHEDRAL) {
        // Half a turn about the middle of the edge that was crossed.
        if (outside_x) x = (x < 0 ? 0 : 2 * w) - 1 - x, y = h - 1 - y;
        if (outside_y) y = (y < 0 ? 0 : 2 * h) - 1 - y, x = w - 1 - x;
    }
    return texels[size_t(y * w + x)];
}

glm::dvec3 PlainImage::lookup(glm::dvec2 st, double& margin) const {
    const double x = st.x * width, y = st.y * height;
    if (filtering == kernel::FILTER_POINT) {
        margin = std::min({margin, edge_distance(x), edge_distance(y)});
        return at(int64_t(std::floor(x)), int64_t(std::floor(y)));
    }
    const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
    const int64_t ix = int64_t(left), iy = int64_t(top);
    return glm::mix(glm::mix(at(ix, iy), at(ix + 1, iy), x - 0.5 - left),
                    glm::mix(at(ix, iy + 1), at(ix + 1, iy + 1), x - 0.5 - left), y - 0.5 - top);
}

}  // namespace lampyris::test
