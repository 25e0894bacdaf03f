// Material "orennayar": clay or plaster.
#include "materials/shared/host.h"

namespace lampyris {

namespace {

void build(MaterialContext& context) {
    context.record.kind = kernel::MATERIAL_ORENNAYAR;
    context.ask(kernel::EFFECT_OREN_NAYAR);
    set_color0(context, read_color(context.build, context.reader, "reflectance", SpectrumUse::kAlbedo, Spectrum(0.5f)));
    const FloatSlot roughness = read_float(context.build, context.reader, "roughness");
    context.record.roughness_u = roughness.value;
    context.record.roughness_u_texture = roughness.texture;
    context.record.roughest_alpha = kRoughestDiffuse;
    read_surface_detail(context);
}

ParameterSpecs specs() {
    return with_surface_detail({
        value("reflectance", ParameterType::kSpectrum, "0.5", "of the facets").textured(),
        real("roughness", 0.5, "of the slopes of the facets; 0 is diffuse").between(0, 1).textured(),
    });
}

const RegisterMaterial orennayar("orennayar", "Clay or plaster: a rough surface of diffuse facets.", specs(), build);

}  // namespace

}  // namespace lampyris
