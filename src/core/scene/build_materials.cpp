// Materials: from descriptions to records, when a shape first asks for one.
#include "core/scene/builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace lampyris {

namespace {

// Materials of pbrt-v4 that Lampyris does not simulate; grey takes their place where that is skipped.
constexpr const char* kUnsupported[] = {"subsurface", "hair", "measured"};

kernel::MaterialRecord blank_material() {
    kernel::MaterialRecord record{};
    record.data = {kernel::MATERIAL_DIFFUSE, 0u, kernel::NONE, kernel::NONE};
    record.textures = kernel::uvec4(kernel::NONE);
    record.textures2 = kernel::uvec4(kernel::NONE);
    record.extra = {0u, 0u, kernel::NONE, kernel::NONE};
    record.color0 = kernel::vec4(0.5f, 0.5f, 0.5f, 1.0f);
    return record;
}

// What eye paths gather on, whatever `glossy` is; textured roughness may be that.
constexpr float kRoughestDiffuse = 1e30f;

// MaterialRecord::floats2.w. Of a mix its materials are built before it.
float roughest_lobe(const kernel::MaterialRecord& m, const std::vector<kernel::MaterialRecord>& materials) {
    const auto of = [](float u, float v, uint32_t texture_u, uint32_t texture_v, bool remap) {
        if (texture_u != kernel::NONE || texture_v != kernel::NONE) return kRoughestDiffuse;
        const float roughest = std::max({u, v, 0.0f});
        return remap ? std::sqrt(roughest) : roughest;
    };
    const auto base = [&] {
        return of(m.floats.x, m.floats.y, m.textures.w, m.textures2.x, m.data.y & kernel::MATERIAL_REMAP);
    };
    switch (m.data.x) {
        case kernel::MATERIAL_DIFFUSE:
        case kernel::MATERIAL_DIFFUSE_TRANSMISSION:
        case kernel::MATERIAL_COATED_DIFFUSE: return kRoughestDiffuse;
        case kernel::MATERIAL_CONDUCTOR:
        case kernel::MATERIAL_DIELECTRIC: return base();
        case kernel::MATERIAL_COATED_CONDUCTOR:
            return std::max(base(), of(m.floats2.y, m.floats2.z, m.textures2.z, m.textures2.w,
                                       m.data.y & kernel::MATERIAL_REMAP_COAT));
        case kernel::MATERIAL_MIX: {
            const bool constant = m.extra.z == kernel::NONE;
            float roughest = 0.0f;
            if (!constant || m.floats.x < 1.0f) roughest = materials[m.extra.x].floats2.w;
            if (!constant || m.floats.x > 0.0f) roughest = std::max(roughest, materials[m.extra.y].floats2.w);
            return roughest;
        }
        default: return 0.0f;
    }
}

bool refuse_unsupported(BuildContext& context, const MaterialDescription& material) {
    for (const char* name : kUnsupported) {
        if (material.type != name) continue;
        context.diagnostics.unsupported(material.type_location.known() ? material.type_location : material.location,
                                        fmt::format("material \"{}\"", name),
                                        "diffuse grey takes its place if skipped");
        return true;
    }
    return false;
}

}  // namespace

void BuildContext::check_unused_materials() {
    for (uint32_t i = 0; i < description.materials.size(); ++i) {
        MaterialDescription& material = description.materials[i];
        if (built_materials.contains(i) || material.type.empty() || material.type == "none") continue;
        if (const PluginInfo* info = material_registry().find_info(material.type)) {
            for (const ParameterSpec& spec : info->parameters) material.parameters.find(spec.name);
            if (!material.parameters.all_used())
                material.parameters.report_unused(fmt::format("material \"{}\"", material.type),
                                                  spec_names(info->parameters), diagnostics);
        } else if (std::find(std::begin(kUnsupported), std::end(kUnsupported), material.type) ==
                   std::end(kUnsupported)) {
            const auto [message, hint] = material_registry().unknown(material.type);
            diagnostics.error(material.type_location.known() ? material.type_location : material.location, message,
                              hint);
        }
    }
}

uint32_t BuildContext::named_material(const std::string& name) {
    if (named_materials.empty())
        for (uint32_t i = 0; i < description.materials.size(); ++i)
            if (const std::string& known = description.materials[i].name; !known.empty())
                named_materials.try_emplace(known, i);
    const auto found = named_materials.find(name);
    return found == named_materials.end() ? kNone : found->second;
}

uint32_t BuildContext::material(uint32_t description_index, const std::vector<uint32_t>& path) {
    const auto built = built_materials.find(description_index);
    if (built != built_materials.end()) return built->second;
    kernel::MaterialRecord record = blank_material();
    if (description_index != kNone) {
        MaterialDescription& material = description.materials[description_index];
        // pbrt-v4 still takes the older names.
        if (material.type.empty() || material.type == "none") material.type = "interface";
        const MaterialFactory* factory = material_registry().find(material.type);
        if (factory) {
            ParameterReader reader(material_registry().find_info(material.type)->parameters, material, diagnostics);
            MaterialContext context{*this,
                                    material,
                                    reader,
                                    record,
                                    {this, &material, material.name.empty() ? "Material" : "MakeNamedMaterial"},
                                    path};
            context.path.push_back(description_index);
            (*factory)(context);
            reader.finish("material");
        } else if (!refuse_unsupported(*this, material)) {
            const auto [message, hint] = material_registry().unknown(material.type);
            diagnostics.error(material.type_location.known() ? material.type_location : material.location, message,
                              hint);
        }
    }
    if (!diagnostics.has_errors()) record.floats2.w = roughest_lobe(record, scene.materials);
    const uint32_t index = uint32_t(scene.materials.size());
    scene.materials.push_back(record);
    built_materials.emplace(description_index, index);
    return index;
}

}  // namespace lampyris
