// Material "mix": each point has one of two materials, by random choice.
#include "materials/shared/host.h"

#include <fmt/format.h>

#include <algorithm>

namespace lampyris {

namespace {

// Less than MIX_DEPTH (mix_bsdf.h), the number of steps that kernels take.
constexpr uint32_t kMostMixes = 63;

// The maximum number of nested mixes from a material on.
uint32_t mix_depth(const BuildContext& build, uint32_t material) {
    const auto found = build.mix_depths.find(material);
    return found == build.mix_depths.end() ? 0u : found->second;
}

// The roughest alpha of its materials, without those that it never chooses.
float roughest_of_both(const kernel::MaterialRecord& mix, const std::vector<kernel::MaterialRecord>& materials) {
    const bool constant = mix.amount_texture == kNone;
    float roughest = kNeverGathers;
    if (!constant || mix.amount < 1.0f) roughest = materials[mix.first_material].roughest_alpha;
    if (!constant || mix.amount > 0.0f) roughest = std::max(roughest, materials[mix.second_material].roughest_alpha);
    return roughest;
}

void refuse_depth(MaterialContext& context) {
    context.reader.error("materials", "mixes of mixes nest too deeply",
                         fmt::format("at most {} within each other", kMostMixes));
}

void build(MaterialContext& context) {
    kernel::MaterialRecord& record = context.record;
    BuildContext& build = context.build;
    record.kind = kernel::MATERIAL_MIX;
    context.ask(kernel::EFFECT_MATERIAL_MIX);
    const FloatSlot amount = read_float(build, context.reader, "amount");
    record.amount = amount.value;
    record.amount_texture = amount.texture;
    record.first_material = record.second_material = 0;
    uint32_t depth = 1;
    const Parameter* parameter = context.reader.find("materials");
    if (!parameter) return;  // reported as a missing parameter
    const auto* names = std::get_if<std::vector<std::string>>(&parameter->values);
    if (!names || names->size() != 2) {
        context.reader.error("materials", fmt::format("\"mix\" of {} materials", names ? names->size() : 0),
                             "\"string materials\" [ \"a\" \"b\" ]");
        return;
    }
    for (int i = 0; i < 2; ++i) {
        const std::string& name = (*names)[size_t(i)];
        const uint32_t index = build.named_material(name);
        if (index == kNone) {
            const auto known = [&] {
                std::vector<std::string> names;
                for (const MaterialDescription& m : build.description.materials)
                    if (!m.name.empty()) names.push_back(m.name);
                return names;
            };
            context.reader.error(
                "materials",
                fmt::format("there is no material named \"{}\"{}", name, build.diagnostics.guess(name, known)),
                "MakeNamedMaterial defines one");
            continue;
        }
        if (std::find(context.path.begin(), context.path.end(), index) != context.path.end()) {
            context.reader.error("materials", fmt::format("the mix contains itself, through \"{}\"", name));
            continue;
        }
        // Kernels follow mixes to this depth; the limit also bounds the recursion here.
        if (context.path.size() > kMostMixes) {
            refuse_depth(context);
            return;
        }
        const uint32_t material = build.material(index, context.path);
        (i == 0 ? record.first_material : record.second_material) = material;
        depth = std::max(depth, 1 + mix_depth(build, material));
    }
    if (depth > kMostMixes) {
        refuse_depth(context);
        depth = 0;
    }
    if (!build.diagnostics.has_errors()) record.roughest_alpha = roughest_of_both(record, build.scene.materials);
    // Materials are appended when they are finished, so the next index is this material's.
    build.mix_depths[uint32_t(build.scene.materials.size())] = depth;
}

ParameterSpecs specs() {
    return {
        values("materials", ParameterType::kString, "", "names of two materials").needed(),
        real("amount", 0.5, "share of the second").between(0, 1).textured(),
    };
}

const RegisterMaterial mix("mix", "One of two named materials at each point, by chance.", specs(), build);

}  // namespace

}  // namespace lampyris
