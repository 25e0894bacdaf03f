// Material "diffuse": Lambert's law.
#include "materials/shared/host.h"

namespace lampyris {

namespace {

void build(MaterialContext& context) {
    context.record.kind = kernel::MATERIAL_DIFFUSE;
    context.record.roughest_alpha = kRoughestDiffuse;
    set_color0(context, read_color(context.build, context.reader, "reflectance", SpectrumUse::kAlbedo, Spectrum(0.5f)));
    read_surface_detail(context);
}

ParameterSpecs specs() {
    return with_surface_detail(
        {value("reflectance", ParameterType::kSpectrum, "0.5", "share of the light that is scattered back")
             .textured()});
}

const RegisterMaterial diffuse("diffuse", "Scatters light evenly, by Lambert's law.", specs(), build);

}  // namespace

}  // namespace lampyris
