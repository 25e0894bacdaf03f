// Materials "dielectric" and "thindielectric": glass.
#include "core/scene/materials/common.h"

namespace lampyris {

namespace {

void build(MaterialContext& context) {
    kernel::MaterialRecord& record = context.record;
    record.data.x = kernel::MATERIAL_DIELECTRIC;
    context.ask(kernel::EFFECT_DIELECTRIC);
    record.floats.z = read_eta(context, "eta");
    const Roughness roughness = read_roughness(context, "");
    record.floats.x = roughness.u.value, record.floats.y = roughness.v.value;
    record.textures.w = roughness.u.texture, record.textures2.x = roughness.v.texture;
    if (context.reader.get_bool("remaproughness")) record.data.y |= kernel::MATERIAL_REMAP;
    if (!roughness.smooth()) context.ask(kernel::EFFECT_ROUGH);
    read_surface_detail(context);
}

void build_thin(MaterialContext& context) {
    context.record.data.x = kernel::MATERIAL_THIN_DIELECTRIC;
    context.ask(kernel::EFFECT_THIN_DIELECTRIC);
    context.record.floats.z = read_eta(context, "eta");
    read_surface_detail(context);
}

ParameterSpecs specs() {
    ParameterSpecs specs{eta_spec("eta", "the inside, relative to the outside")};
    add_roughness(specs, "", 0.0, "the interface");
    specs.push_back(remap_spec());
    return with_surface_detail(std::move(specs));
}

const RegisterMaterial dielectric("dielectric", "Glass or water: reflects and refracts, smooth or rough (GGX).",
                                  specs(), build);
const RegisterMaterial thindielectric("thindielectric",
                                      "A pane of glass as one surface: reflects, or lets pass straight on.",
                                      with_surface_detail({eta_spec("eta", "the pane")}), build_thin);

}  // namespace

}  // namespace lampyris
