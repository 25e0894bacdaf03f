#include "core/scene/pbrt_v3.h"

namespace lampyris {
namespace {

struct Renamed {
    std::string_view directive, old_name, instead;
};

constexpr Renamed kDirectives[] = {
    {"", "WorldEnd", "the end of the file ends the world"},
    {"", "SurfaceIntegrator", "Integrator"},
    {"", "VolumeIntegrator", "Integrator \"volpath\""},
    {"", "Renderer", "Integrator"},
    {"", "Volume", "MakeNamedMedium"},
    {"", "SearchPath", "relative file names start at the scene's folder"},
};

constexpr Renamed kEntities[] = {
    {"Film", "image", "Film \"rgb\""},
    {"Camera", "environment", "Camera \"spherical\""},
    {"Sampler", "lowdiscrepancy", "Sampler \"paddedsobol\""},
    {"Sampler", "02sequence", "Sampler \"paddedsobol\""},
    {"Sampler", "maxmindist", "Sampler \"paddedsobol\""},
    {"Sampler", "bestcandidate", "Sampler \"paddedsobol\""},
    {"Sampler", "random", "Sampler \"independent\""},
    {"Integrator", "directlighting", "Integrator \"path\""},
    {"Integrator", "whitted", "Integrator \"path\""},
    {"Accelerator", "grid", "Accelerator \"bvh\""},
    {"Material", "matte", "\"diffuse\", and Kd is \"reflectance\""},
    {"Material", "plastic", "\"coateddiffuse\""},
    {"Material", "uber", "\"coateddiffuse\""},
    {"Material", "substrate", "\"coateddiffuse\""},
    {"Material", "shinymetal", "\"conductor\""},
    {"Material", "metal", "\"conductor\""},
    {"Material", "mirror", "\"conductor\" with a \"reflectance\""},
    {"Material", "glass", "\"dielectric\""},
    {"Material", "translucent", "\"diffusetransmission\""},
    {"Material", "disney", "\"coateddiffuse\" or \"conductor\""},
    {"Material", "fourier", "\"measured\""},
    {"Material", "kdsubsurface", "\"subsurface\""},
    {"Shape", "heightfield", "Shape \"trianglemesh\""},
    {"Shape", "heightfield2", "Shape \"trianglemesh\""},
    {"Shape", "nurbs", "Shape \"trianglemesh\""},
    {"Shape", "cone", "Shape \"trianglemesh\""},
    {"Shape", "paraboloid", "Shape \"trianglemesh\""},
    {"Shape", "hyperboloid", "Shape \"trianglemesh\""},
    {"LightSource", "exinfinite", "LightSource \"infinite\""},
    {"AreaLightSource", "area", "AreaLightSource \"diffuse\""},
    {"Texture", "color", "\"spectrum\""},
};

}  // namespace

bool OldFormat::found(const std::string& what, const std::string& instead, Location location) {
    if (!reported_)
        diagnostics_->error(
            location, "this is a scene in the format of pbrt-v3: pbrt-v4 has no " + what,
            (instead.empty() ? "" : "instead: " + instead + "; ") +
                std::string("pbrt-v4's own program upgrades a scene: pbrt --upgrade old.pbrt > new.pbrt"));
    reported_ = true;
    return true;
}

bool OldFormat::directive(std::string_view word, Location location) {
    for (const Renamed& old : kDirectives)
        if (word == old.old_name) return found(std::string(word), std::string(old.instead), location);
    return false;
}

bool OldFormat::entity(std::string_view directive, std::string_view type, Location location) {
    if (directive == "MakeNamedMaterial") directive = "Material";
    for (const Renamed& old : kEntities)
        if (directive == old.directive && type == old.old_name)
            return found(std::string(directive) + " \"" + std::string(type) + "\"", std::string(old.instead), location);
    return false;
}

bool OldFormat::parameter_type(std::string_view type, Location location) {
    if (type == "color") return found("parameter type \"color\"", "\"rgb\"", location);
    if (type == "xyz") return found("parameter type \"xyz\"", "\"rgb\"", location);
    return false;
}

bool OldFormat::parameter_name(std::string_view name, Location location) {
    return name == "bumpmap" && found("parameter \"bumpmap\"", "\"texture displacement\"", location);
}

}  // namespace lampyris
