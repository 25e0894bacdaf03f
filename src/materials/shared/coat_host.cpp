// Common to the coated materials: parameters of the coat, and of the layer below it.
#include "materials/shared/host.h"

namespace lampyris {

void read_coat(MaterialContext& context, const std::string& eta) {
    kernel::MaterialRecord& record = context.record;
    ParameterReader& reader = context.reader;
    context.ask(kernel::EFFECT_LAYERED_COAT);
    context.ask(kernel::EFFECT_DIELECTRIC);
    record.eta = read_eta(context, eta);
    const FloatSlot thickness = read_float(context.build, reader, "thickness");
    record.thickness = thickness.value;
    record.thickness_texture = thickness.texture;
    record.g = reader.get_float("g");
    set_color2(context, read_color(context.build, reader, "albedo", SpectrumUse::kAlbedo, Spectrum(0.0f)));
    if (reader.get_bool("exactcoat")) record.flags |= kernel::MATERIAL_EXACT_COAT;
    record.max_depth = uint32_t(reader.get_int("maxdepth"));
    record.samples = uint32_t(reader.get_int("nsamples"));
}

ParameterSpecs with_coat(ParameterSpecs specs) {
    specs.push_back(
        real("thickness", 0.01, "of the layer between coat and base").at_least(0).textured().in("mean free paths"));
    specs.push_back(real("g", 0.0, "asymmetry of the scattering in the layer (Henyey-Greenstein)").between(-1, 1));
    specs.push_back(
        value("albedo", ParameterType::kSpectrum, "0", "of the scattering in the layer; 0: no medium").textured());
    specs.push_back(integer("maxdepth", 10, "bounces between the layers").between(1, 1000));
    specs.push_back(integer("nsamples", 1, "random walks for each evaluation").between(1, 1000));
    specs.push_back(
        boolean("exactcoat", false, "unbiased weights of the random walk; pbrt-v4's are off for rough coats"));
    specs.push_back(remap_spec());
    return with_surface_detail(std::move(specs));
}

}  // namespace lampyris
