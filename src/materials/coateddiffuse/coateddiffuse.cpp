// Material "coateddiffuse": plastic or varnish, a dielectric coat over a diffuse base.
#include "materials/shared/host.h"

namespace lampyris {

namespace {

void build(MaterialContext& context) {
    kernel::MaterialRecord& record = context.record;
    record.kind = kernel::MATERIAL_COATEDDIFFUSE;
    set_color0(context, read_color(context.build, context.reader, "reflectance", SpectrumUse::kAlbedo, Spectrum(0.5f)));
    read_base_roughness(context, "");
    record.roughest_alpha = kRoughestDiffuse;  // because of the base
    read_coat(context, "eta");
    read_surface_detail(context);
}

ParameterSpecs specs() {
    ParameterSpecs specs{value("reflectance", ParameterType::kSpectrum, "0.5", "of the diffuse base").textured(),
                         eta_spec("eta", "the coat")};
    add_roughness(specs, "", 0.0, "the coat");
    return with_coat(std::move(specs));
}

const RegisterMaterial coateddiffuse("coateddiffuse", "Plastic or varnish: a dielectric coat over a diffuse base.",
                                     specs(), build);

}  // namespace

}  // namespace lampyris
