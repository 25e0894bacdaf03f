#include "core/render/pbrt_integrators.h"

#include "core/render/integrator.h"

#include <fmt/format.h>

#include <algorithm>

namespace lampyris {
namespace {

using enum ParameterType;

// Names, types and defaults: pbrt-v4, cpu/integrators.cpp, the functions Create.
constexpr PbrtParameter kMaxDepth{"maxdepth", kInteger, "5", "maxdepth", ""};
constexpr PbrtParameter kLightSampler{"lightsampler", kString, "bvh", "", "lights are chosen by their power"};
constexpr PbrtParameter kRegularize{"regularize", kBool, "false", "", "path regularization", true};
constexpr std::string_view kBothAreSampled = "lights and directions are both sampled";
constexpr std::string_view kNoFunction = "no function is sampled";
constexpr std::string_view kNoStrategies =
    "--set integrator.strategies=on keeps an image of each strategy, with and without weights";

constexpr PbrtParameter kDepthAlone[] = {kMaxDepth};
constexpr PbrtParameter kOfPath[] = {kMaxDepth, kLightSampler, kRegularize};
constexpr PbrtParameter kOfSimplePath[] = {kMaxDepth,
                                           {"samplelights", kBool, "true", "", kBothAreSampled},
                                           {"samplebsdf", kBool, "true", "", kBothAreSampled}};
constexpr PbrtParameter kOfBdpt[] = {kMaxDepth,
                                     {"visualizestrategies", kBool, "false", "", kNoStrategies},
                                     {"visualizeweights", kBool, "false", "", kNoStrategies},
                                     kRegularize};
constexpr PbrtParameter kOfMlt[] = {kMaxDepth,
                                    {"bootstrapsamples", kInteger, "100000", "bootstrapsamples", ""},
                                    {"chains", kInteger, "1000", "chains", ""},
                                    {"mutationsperpixel", kInteger, "100", "mutationsperpixel", ""},
                                    {"sigma", kFloat, "0.01", "sigma", ""},
                                    {"largestepprobability", kFloat, "0.3", "largestepprobability", ""},
                                    kRegularize};
constexpr PbrtParameter kOfAo[] = {
    {"cossample", kBool, "true", "", "directions are always cosine-distributed: the same image, with less noise"},
    {"maxdistance", kFloat, "inf", "distance", ""}};
constexpr PbrtParameter kOfSppm[] = {kMaxDepth,
                                     {"photonsperiteration", kInteger, "-1", "photonsperiteration", ""},
                                     {"radius", kFloat, "1", "radius", ""},
                                     {"seed", kInteger, "6502", "", "the Sampler's seed is used"}};
constexpr PbrtParameter kOfFunction[] = {{"function", kString, "step", "", kNoFunction},
                                         {"filename", kString, "", "", kNoFunction},
                                         {"imagefilename", kString, "", "", kNoFunction},
                                         {"skipbad", kBool, "true", "", kNoFunction}};

constexpr PbrtIntegrator kIntegrators[] = {
    {"ambientocclusion", "ao", "the share of a white sky that each point sees", false, kOfAo},
    {"bdpt", "bdpt", "", true, kOfBdpt},
    {"function", "path", "pbrt-v4's measures a sampler's error and renders no image; this renders the scene", false,
     kOfFunction},
    {"lightpath", "light", "lamps and the sky are seen directly, too; pbrt-v4 leaves them out", true, kDepthAlone},
    {"mlt", "mlt", "", true, kOfMlt},
    {"path", "path", "", true, kOfPath},
    {"randomwalk", "path",
     "directions are sampled by the materials, and lights are sampled, too: the same image, with less noise, except "
     "for specular surfaces, which pbrt-v4 shows black",
     true, kDepthAlone},
    {"simplepath", "path", "lights and directions are both sampled: the same image, with less noise", true,
     kOfSimplePath},
    {"simplevolpath", "path",
     "pbrt-v4's refuses surfaces; Lampyris simulates media that absorb, and refuses those that scatter", false,
     kDepthAlone},
    {"sppm", "sppm", "", true, kOfSppm},
    {"volpath", "path", "media that absorb are simulated, those that scatter are refused", false, kOfPath},
};

// The single value of a parameter, in the table's notation.
std::string value_text(const Parameter& parameter) {
    return std::visit(
        [](const auto& values) -> std::string {
            using T = typename std::decay_t<decltype(values)>::value_type;
            if (values.size() != 1) return "several values";
            if constexpr (std::is_same_v<T, uint8_t>)
                return values.front() != 0 ? "true" : "false";
            else
                return fmt::format("{}", values.front());
        },
        parameter.values);
}

const Parameter* find_unmarked(const ParameterList& list, std::string_view name) {
    const auto found = std::find_if(list.parameters.begin(), list.parameters.end(),
                                    [&](const Parameter& parameter) { return parameter.name == name; });
    return found == list.parameters.end() ? nullptr : &*found;
}

bool check_type(const ParameterList& list, const PbrtParameter& known, Diagnostics& diagnostics) {
    const size_t before = diagnostics.error_count();
    switch (known.type) {
        case kBool: list.get_bool(known.name, false, diagnostics); break;
        case kInteger: list.get_int(known.name, 0, diagnostics); break;
        case kFloat: list.get_float(known.name, 0.0f, diagnostics); break;
        default: list.get_string(known.name, "", diagnostics); break;
    }
    return diagnostics.error_count() == before;
}

}  // namespace

std::span<const PbrtIntegrator> pbrt_integrators() { return kIntegrators; }

const PbrtIntegrator* find_pbrt_integrator(std::string_view name) {
    const auto* found = std::find_if(std::begin(kIntegrators), std::end(kIntegrators),
                                     [&](const PbrtIntegrator& known) { return known.name == name; });
    return found == std::end(kIntegrators) ? nullptr : found;
}

std::string rendering_integrator(const std::string& asked) {
    const PbrtIntegrator* known = find_pbrt_integrator(asked);
    return integrators().find(asked) || !known ? asked : std::string(known->ours);
}

std::vector<std::string> take_pbrt_parameters(Entity& integrator, Diagnostics& diagnostics) {
    std::vector<std::string> names;
    const PbrtIntegrator* known = find_pbrt_integrator(integrator.type);
    if (!known) return names;
    const PluginInfo* renders = integrators().find_info(rendering_integrator(integrator.type));
    for (const PbrtParameter& parameter : known->parameters) {
        names.emplace_back(parameter.name);
        // An integrator registered under pbrt's name may have the parameter itself.
        if (renders && find_spec(renders->parameters, parameter.name)) continue;
        if (!parameter.ours.empty()) {
            for (Parameter& given : integrator.parameters.parameters)
                if (given.name == parameter.name) given.name = parameter.ours;
            continue;
        }
        if (!integrator.parameters.has(parameter.name) || !check_type(integrator.parameters, parameter, diagnostics))
            continue;
        const Parameter* given = integrator.parameters.find(parameter.name);
        if (parameter.refused && value_text(*given) != parameter.pbrt_default)
            diagnostics.unsupported(given->location, std::string(parameter.otherwise));
    }
    return names;
}

std::vector<std::string> integrator_notes(const Entity& integrator, const Scene& scene, const Sources& sources) {
    std::vector<std::string> notes;
    const PbrtIntegrator* known = find_pbrt_integrator(integrator.type);
    if (!integrator.given() || !known) return notes;
    const std::string place = sources.describe(integrator.type_location);
    const std::string renders = rendering_integrator(integrator.type);
    if (renders != integrator.type)
        notes.push_back(fmt::format("{}: \"{}\" renders instead of pbrt-v4's \"{}\": {}", place, renders,
                                    integrator.type, known->difference));
    const PluginInfo* info = integrators().find_info(renders);
    for (const PbrtParameter& parameter : known->parameters) {
        const Parameter* given = find_unmarked(integrator.parameters, parameter.name);
        if (!given || !parameter.ours.empty() || parameter.refused || value_text(*given) == parameter.pbrt_default ||
            (info && find_spec(info->parameters, parameter.name)))
            continue;
        notes.push_back(fmt::format("{}: \"{}\" has no effect: {}", sources.describe(given->location), parameter.name,
                                    parameter.otherwise));
    }
    if (known->ignores_media && scene.effects.has(kernel::EFFECT_MEDIUM))
        notes.push_back(
            fmt::format("{}: light is absorbed in media, which pbrt-v4's \"{}\" treats as empty; \"string media\" "
                        "\"off\" in the Integrator directive, or --set integrator.media=off, does the same",
                        place, integrator.type));
    return notes;
}

}  // namespace lampyris
