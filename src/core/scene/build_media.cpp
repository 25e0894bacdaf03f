// Media: from descriptions to records, built when a shape, a light or the camera first needs one.
#include "core/scene/builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace lampyris {

namespace {

// Media of pbrt-v4 that Lampyris does not simulate; empty space replaces them with --skip-unsupported.
constexpr const char* kUnsupported[] = {"uniformgrid", "rgbgrid", "cloud", "nanovdb"};
constexpr const char* kInPlace = "--skip-unsupported renders empty space instead";

bool is_unsupported(const MediumDescription& medium) {
    return std::find(std::begin(kUnsupported), std::end(kUnsupported), medium.type) != std::end(kUnsupported);
}

void report_unknown(BuildContext& context, const MediumDescription& medium) {
    if (medium.type.empty()) return;  // the parser has reported it
    const auto [message, hint] = medium_registry().unknown(medium.type);
    context.diagnostics.error(medium.type_location, message, hint);
}

}  // namespace

void MediumContext::refuse(std::string_view parameter, const std::string& with_what, const std::string& hint) {
    build.diagnostics.unsupported(reader.location(parameter),
                                  fmt::format("participating medium \"{}\", {},", medium.name, with_what),
                                  fmt::format("{}; {}", hint, kInPlace));
    record = {};
}

void BuildContext::check_unused_media() {
    for (uint32_t i = 0; i < description.media.size(); ++i) {
        MediumDescription& medium = description.media[i];
        if (built_media.contains(i) || is_unsupported(medium)) continue;
        if (const PluginInfo* info = medium_registry().find_info(medium.type)) {
            for (const ParameterSpec& spec : info->parameters) medium.parameters.find(spec.name);
            if (!medium.parameters.all_used())
                medium.parameters.report_unused(fmt::format("medium \"{}\"", medium.type), spec_names(info->parameters),
                                                diagnostics);
        } else {
            report_unknown(*this, medium);
        }
    }
}

void BuildContext::choose_media() {
    const std::string of_scene =
        description.integrator.parameters.get_choice("media", "on", {"on", "off"}, diagnostics);
    settings.media = options.media.value_or(of_scene == "on");
}

uint32_t BuildContext::medium(uint32_t description_index) {
    if (!settings.media || description_index >= description.media.size()) return kernel::MEDIUM_VACUUM;
    const auto built = built_media.find(description_index);
    if (built != built_media.end()) return built->second;
    MediumDescription& medium = description.media[description_index];
    kernel::MediumRecord record{};
    if (const MediumFactory* factory = medium_registry().find(medium.type)) {
        ParameterReader reader(medium_registry().find_info(medium.type)->parameters, medium, diagnostics);
        MediumContext context{*this, medium, reader, record};
        (*factory)(context);
        reader.finish("medium");
    } else if (is_unsupported(medium)) {
        diagnostics.unsupported(medium.type_location,
                                fmt::format("participating medium \"{}\", a \"{}\",", medium.name, medium.type),
                                fmt::format("\"homogeneous\" media that only absorb are; {}", kInPlace));
    } else {
        report_unknown(*this, medium);
    }
    uint32_t index = kernel::MEDIUM_VACUUM;
    if (record.sigma_a != Spectrum(0.0f)) {
        if (scene.media.empty()) scene.media.emplace_back();  // empty space
        if (scene.media.size() < kernel::MEDIUM_COUNT) {
            index = uint32_t(scene.media.size());
            scene.media.push_back(record);
            ask(kernel::EFFECT_MEDIUM, Asker{this, &medium, "MakeNamedMedium"});
        } else if (scene.media.size() == kernel::MEDIUM_COUNT) {
            diagnostics.error(medium.location, fmt::format("there are more than {} media", kernel::MEDIUM_COUNT - 1));
        }
    }
    built_media.emplace(description_index, index);
    return index;
}

}  // namespace lampyris
