// Material "conductor": a metal, with complex Fresnel terms and GGX microfacets.
#include "materials/shared/host.h"

namespace lampyris {

namespace {

void build(MaterialContext& context) {
    kernel::MaterialRecord& record = context.record;
    record.kind = kernel::MATERIAL_CONDUCTOR;
    read_conductor(context, "");
    const Roughness roughness = read_base_roughness(context, "");
    record.roughest_alpha = roughest_alpha(roughness, record.flags & kernel::MATERIAL_REMAP);
    read_surface_detail(context);
}

ParameterSpecs specs() {
    ParameterSpecs specs;
    add_conductor(specs, "");
    add_roughness(specs, "", 0.0, "the metal");
    specs.push_back(remap_spec());
    return with_surface_detail(std::move(specs));
}

const RegisterMaterial conductor("conductor", "A metal, smooth or rough (GGX).", specs(), build);

}  // namespace

}  // namespace lampyris
