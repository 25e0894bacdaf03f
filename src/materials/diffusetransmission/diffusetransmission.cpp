// Material "diffusetransmission": for paper and leaves.
#include "materials/shared/host.h"

namespace lampyris {

namespace {

void build(MaterialContext& context) {
    context.record.kind = kernel::MATERIAL_DIFFUSETRANSMISSION;
    context.record.roughest_alpha = kRoughestDiffuse;
    context.ask(kernel::EFFECT_DIFFUSE_TRANSMISSION);
    set_color0(context,
               read_color(context.build, context.reader, "reflectance", SpectrumUse::kAlbedo, Spectrum(0.25f)));
    set_color1(context,
               read_color(context.build, context.reader, "transmittance", SpectrumUse::kAlbedo, Spectrum(0.25f)));
    context.record.scale = context.reader.get_float("scale");
    read_surface_detail(context);
}

ParameterSpecs specs() {
    return with_surface_detail({
        value("reflectance", ParameterType::kSpectrum, "0.25", "share of the light that is scattered back").textured(),
        value("transmittance", ParameterType::kSpectrum, "0.25", "share of the light that is scattered through")
            .textured(),
        real("scale", 1.0, "multiplies both").at_least(0),
    });
}

const RegisterMaterial diffusetransmission("diffusetransmission", "Scatters light evenly to both sides.", specs(),
                                           build);

}  // namespace

}  // namespace lampyris
