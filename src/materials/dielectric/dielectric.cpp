// Material "dielectric": glass.
#include "materials/shared/host.h"

namespace lampyris {

namespace {

void build(MaterialContext& context) {
    kernel::MaterialRecord& record = context.record;
    record.kind = kernel::MATERIAL_DIELECTRIC;
    context.ask(kernel::EFFECT_DIELECTRIC);
    record.eta = read_eta(context, "eta");
    const Roughness roughness = read_base_roughness(context, "");
    record.roughest_alpha = roughest_alpha(roughness, record.flags & kernel::MATERIAL_REMAP);
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

}  // namespace

}  // namespace lampyris
