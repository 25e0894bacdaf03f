// Materials: from descriptions to records, built when a shape first needs one.
#include "core/scene/builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace lampyris {

namespace {

// Materials of pbrt-v4 that Lampyris does not simulate; grey replaces them with --skip-unsupported.
constexpr const char* kUnsupported[] = {"subsurface", "hair", "measured"};

kernel::MaterialRecord blank_material() {
    kernel::MaterialRecord record{};
    record.kind = kernel::MATERIAL_DIFFUSE;
    forget_textures(record);
    record.color0 = Spectrum(0.5f);
    record.scale = 1.0f;
    record.roughest_alpha = kRoughestDiffuse;
    return record;
}

bool refuse_unsupported(BuildContext& context, const MaterialDescription& material) {
    for (const char* name : kUnsupported) {
        if (material.type != name) continue;
        context.diagnostics.unsupported(material.type_location.known() ? material.type_location : material.location,
                                        fmt::format("material \"{}\"", name),
                                        "--skip-unsupported renders diffuse grey instead");
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
        // pbrt-v4 still accepts the older names.
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
    const uint32_t index = uint32_t(scene.materials.size());
    scene.materials.push_back(record);
    built_materials.emplace(description_index, index);
    return index;
}

}  // namespace lampyris
