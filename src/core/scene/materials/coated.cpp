// Materials "coateddiffuse" and "coatedconductor": a dielectric coat over a base, with a medium in between.
#include "core/scene/materials/common.h"

namespace lampyris {

namespace {

// What both have; `eta` is the name of the index of the coat.
void read_coat(MaterialContext& context, const std::string& eta) {
    kernel::MaterialRecord& record = context.record;
    ParameterReader& reader = context.reader;
    context.ask(kernel::EFFECT_COAT);
    context.ask(kernel::EFFECT_DIELECTRIC);
    record.floats.z = read_eta(context, eta);
    const FloatSlot thickness = read_float(context.build, reader, "thickness");
    record.floats2.x = thickness.value;
    record.textures2.y = thickness.texture;
    record.floats.w = reader.get_float("g");
    set_color2(context, read_color(context.build, reader, "albedo", SpectrumUse::kAlbedo, glm::vec3(0.0f)));
    if (reader.get_bool("exactcoat")) record.data.y |= kernel::MATERIAL_EXACT_COAT;
    record.extra.x = uint32_t(reader.get_int("maxdepth"));
    record.extra.y = uint32_t(reader.get_int("nsamples"));
}

void build_diffuse(MaterialContext& context) {
    kernel::MaterialRecord& record = context.record;
    record.data.x = kernel::MATERIAL_COATED_DIFFUSE;
    set_color0(context,
               read_color(context.build, context.reader, "reflectance", SpectrumUse::kAlbedo, glm::vec3(0.5f)));
    const Roughness roughness = read_roughness(context, "");
    record.floats.x = roughness.u.value, record.floats.y = roughness.v.value;
    record.textures.w = roughness.u.texture, record.textures2.x = roughness.v.texture;
    if (context.reader.get_bool("remaproughness")) record.data.y |= kernel::MATERIAL_REMAP;
    if (!roughness.smooth()) context.ask(kernel::EFFECT_ROUGH);
    read_coat(context, "eta");
    read_surface_detail(context);
}

void build_conductor(MaterialContext& context) {
    kernel::MaterialRecord& record = context.record;
    record.data.x = kernel::MATERIAL_COATED_CONDUCTOR;
    read_conductor(context, "conductor.");
    const Roughness base = read_roughness(context, "conductor."), coat = read_roughness(context, "interface.");
    record.floats.x = base.u.value, record.floats.y = base.v.value;
    record.textures.w = base.u.texture, record.textures2.x = base.v.texture;
    record.floats2.y = coat.u.value, record.floats2.z = coat.v.value;
    record.textures2.z = coat.u.texture, record.textures2.w = coat.v.texture;
    if (context.reader.get_bool("remaproughness"))
        record.data.y |= kernel::MATERIAL_REMAP | kernel::MATERIAL_REMAP_COAT;
    if (!base.smooth() || !coat.smooth()) context.ask(kernel::EFFECT_ROUGH);
    read_coat(context, "interface.eta");
    read_surface_detail(context);
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

ParameterSpecs diffuse_specs() {
    ParameterSpecs specs{value("reflectance", ParameterType::kSpectrum, "0.5", "of the diffuse base").textured(),
                         eta_spec("eta", "the coat")};
    add_roughness(specs, "", 0.0, "the coat");
    return with_coat(std::move(specs));
}

ParameterSpecs conductor_specs() {
    ParameterSpecs specs;
    add_conductor(specs, "conductor.");
    add_roughness(specs, "conductor.", 0.0, "the metal");
    add_roughness(specs, "interface.", 0.0, "the coat");
    specs.push_back(eta_spec("interface.eta", "the coat"));
    return with_coat(std::move(specs));
}

const RegisterMaterial coateddiffuse("coateddiffuse", "Plastic or varnish: a dielectric coat over a diffuse base.",
                                     diffuse_specs(), build_diffuse);
const RegisterMaterial coatedconductor("coatedconductor", "Varnished metal: a dielectric coat over a conductor.",
                                       conductor_specs(), build_conductor);

}  // namespace

}  // namespace lampyris
