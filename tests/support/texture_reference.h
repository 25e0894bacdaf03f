// Textures in double precision, written from their definitions: the reference for kernels.
#pragma once

#include "support/texture_scene.h"

#include <glm/glm.hpp>

#include <functional>
#include <vector>

namespace lampyris::test {

// A texture as a tree; operands in the order of the operation's definition in core/kernel/layout.h.
struct TextureNode {
    TextureOp op;
    std::vector<TextureNode> operands;
};
std::vector<TextureOp> postfix(const TextureNode& node);
size_t stack_depth(const TextureNode& node);

struct TexturePoint {
    glm::dvec3 position, normal;
    glm::dvec2 uv;
};

// `margin` is reduced to the distance (in units of cells or texels) at which the value jumps, if that is less.
using ImageReference = std::function<glm::dvec3(uint32_t image, glm::dvec2 st, double& margin)>;
glm::dvec3 reference_color(const TextureNode& node, const TexturePoint& point, const ImageReference& images,
                           double& margin);

glm::dvec2 reference_st(const TextureOp& op, const TexturePoint& point);
double reference_noise(glm::dvec3 p);

// An image whose texels are known; row 0 is at the top.
struct PlainImage {
    uint32_t width = 0, height = 0, wrap = 0, filtering = 0;
    std::vector<glm::dvec3> texels;
    glm::dvec3 at(int64_t x, int64_t y) const;  // anywhere, by the wrap mode
    glm::dvec3 lookup(glm::dvec2 st, double& margin) const;
};

}  // namespace lampyris::test
