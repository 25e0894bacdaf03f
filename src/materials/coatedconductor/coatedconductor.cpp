// Material "coatedconductor": varnished metal, a dielectric coat over a conductor.
#include "materials/shared/host.h"

#include <algorithm>

namespace lampyris {

namespace {

void build(MaterialContext& context) {
    kernel::MaterialRecord& record = context.record;
    record.kind = kernel::MATERIAL_COATEDCONDUCTOR;
    read_conductor(context, "conductor.");
    const Roughness base = read_base_roughness(context, "conductor."), coat = read_roughness(context, "interface.");
    record.coat_roughness_u = coat.u.value, record.coat_roughness_v = coat.v.value;
    record.coat_roughness_u_texture = coat.u.texture, record.coat_roughness_v_texture = coat.v.texture;
    const bool remapped = record.flags & kernel::MATERIAL_REMAP;
    if (remapped) record.flags |= kernel::MATERIAL_REMAP_COAT;
    if (!coat.smooth()) context.ask(kernel::EFFECT_ROUGH);
    record.roughest_alpha = std::max(roughest_alpha(base, remapped), roughest_alpha(coat, remapped));
    read_coat(context, "interface.eta");
    read_surface_detail(context);
}

ParameterSpecs specs() {
    ParameterSpecs specs;
    add_conductor(specs, "conductor.");
    add_roughness(specs, "conductor.", 0.0, "the metal");
    add_roughness(specs, "interface.", 0.0, "the coat");
    specs.push_back(eta_spec("interface.eta", "the coat"));
    return with_coat(std::move(specs));
}

const RegisterMaterial coatedconductor("coatedconductor", "Varnished metal: a dielectric coat over a conductor.",
                                       specs(), build);

}  // namespace

}  // namespace lampyris
