#include "core/scene/texture_builder.h"

#include "core/base/file.h"
#include "core/scene/builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace lampyris {

namespace {

const char* type_word(bool is_spectrum) { return is_spectrum ? "spectrum" : "float"; }

uint64_t effects_of(const kernel::TextureOp& op) {
    switch (op.operation) {
        case kernel::TEXTURE_IMAGE: return kernel::EFFECT_IMAGES;
        case kernel::TEXTURE_FBM:
        case kernel::TEXTURE_WRINKLED:
        case kernel::TEXTURE_WINDY:
        case kernel::TEXTURE_MARBLE:
        case kernel::TEXTURE_DOTS: return kernel::EFFECT_NOISE;
        default: return 0;
    }
}

// An InputError's text as part of a located message.
std::string reason(const InputError& error) {
    std::string text = error.what();
    if (text.starts_with("error: ")) text.erase(0, 7);
    return text;
}

}  // namespace

ImageStore& TextureBuilder::images() {
    if (!images_) images_ = std::make_unique<ImageStore>(context_.scene, context_.diagnostics);
    return *images_;
}

void TextureBuilder::define_all() {
    if (defined_) return;
    defined_ = true;
    for (TextureDescription& description : context_.description.textures) define(description);
}

void TextureBuilder::define(TextureDescription& description) {
    Diagnostics& diagnostics = context_.diagnostics;
    Texture texture{description.location, constant_program(glm::vec3(0.5f)), kNone};
    if (const TextureFactory* factory = texture_registry().find(description.type)) {
        ParameterReader reader(texture_registry().find_info(description.type)->parameters, description, diagnostics);
        TextureContext context{*this, description, reader};
        if (description.world_from_texture.animated())
            diagnostics.warning(description.location,
                                fmt::format("texture \"{}\" does not move", shown(description.name)),
                                "the transform at the start of the shutter's interval is used");
        texture.program = (*factory)(context);
        reader.finish("texture");
    } else if (description.type == "ptex") {
        diagnostics.unsupported(description.type_location, "texture \"ptex\"",
                                "--skip-unsupported uses a grey of 0.5 instead");
    } else {
        const auto [message, hint] = texture_registry().unknown(description.type);
        diagnostics.error(description.type_location, message, hint);
    }
    const auto [place, is_new] = textures_[description.is_spectrum].try_emplace(description.name, std::move(texture));
    if (!is_new)
        diagnostics.error(
            description.location,
            fmt::format("{} texture \"{}\" is defined twice", type_word(description.is_spectrum),
                        shown(description.name)),
            fmt::format("the first time at {}", context_.description.sources->describe(place->second.location)));
}

TextureBuilder::Texture* TextureBuilder::find(const std::string& name, bool is_spectrum, Location where) {
    define_all();
    Textures& textures = textures_[is_spectrum];
    if (const auto found = textures.find(name); found != textures.end()) return &found->second;
    const char* wanted = type_word(is_spectrum);
    if (const auto other = textures_[!is_spectrum].find(name); other != textures_[!is_spectrum].end()) {
        context_.diagnostics.error(
            where,
            fmt::format("\"{}\" is a {} texture, and this takes a {} texture", shown(name), type_word(!is_spectrum),
                        wanted),
            fmt::format("it is defined at {}", context_.description.sources->describe(other->second.location)));
        return nullptr;
    }
    std::string guess, hint;
    if (!context_.diagnostics.full()) {
        std::vector<std::string> names;
        for (const auto& [known, texture] : textures) names.push_back(known);
        guess = context_.diagnostics.guess(name, [&] { return names; });
        hint = names.empty() ? fmt::format("no {} texture is defined before", wanted)
                             : fmt::format("the {} textures defined before are {}", wanted, list_of(names));
        for (const TextureDescription& later : context_.description.textures)
            if (later.name == name && later.is_spectrum == is_spectrum)
                hint = fmt::format("it is defined only at {}", context_.description.sources->describe(later.location));
    }
    context_.diagnostics.error(where, fmt::format("there is no {} texture \"{}\"{}", wanted, shown(name), guess), hint);
    return nullptr;
}

TextureProgram TextureBuilder::operand(ParameterReader& reader, std::string_view name, float absent, bool is_spectrum) {
    const Parameter* parameter = reader.find(name);
    if (!parameter) return constant_program(glm::vec3(absent));
    if (parameter->type == ParameterType::kTexture) {
        const auto* names = std::get_if<std::vector<std::string>>(&parameter->values);
        if (!names || names->size() != 1) {
            reader.error(name, fmt::format("\"{}\" must name one texture", parameter->name));
        } else if (const Texture* texture = find(names->front(), is_spectrum, parameter->value_location)) {
            return texture->program;
        }
        return constant_program(glm::vec3(absent));
    }
    const bool is_color = parameter->type == ParameterType::kRgb || parameter->type == ParameterType::kSpectrum ||
                          parameter->type == ParameterType::kBlackbody;
    if (is_spectrum && is_color)
        return constant_program(
            spectrum_rgb(*parameter, SpectrumUse::kUnbounded, context_.description.folder, context_.diagnostics)
                .value_or(glm::vec3(absent)));
    if (is_spectrum) {
        context_.diagnostics.error(
            parameter->location,
            fmt::format("\"{}\" of a spectrum texture is of type {}", parameter->name, type_name(parameter->type)),
            fmt::format("write \"rgb {}\", or another spectrum, or \"texture {}\"", parameter->name, parameter->name));
        return constant_program(glm::vec3(absent));
    }
    return constant_program(glm::vec3(reader.entity().parameters.get_float(name, absent, context_.diagnostics)));
}

uint32_t TextureBuilder::request_image(ImageRequest request) {
    std::error_code ignored;
    const std::filesystem::path path(request.path);
    if (const std::string why = context_.description.folder.why_refused(request.path); !why.empty()) {
        context_.diagnostics.error(request.location,
                                   fmt::format("the image {} is not read: {}", shown(request.path), why));
        failed_.insert(request.path);
    } else if (!std::filesystem::is_regular_file(path, ignored)) {
        context_.diagnostics.error(
            request.location,
            fmt::format("there is no image file {}{}", shown(request.path),
                        context_.diagnostics.guess(path.filename().string(), [&] { return files_beside(path); })));
        failed_.insert(request.path);
    }
    requests_.push_back(std::move(request));
    return uint32_t(requests_.size() - 1);
}

uint32_t TextureBuilder::load(const ImageRequest& request) {
    // One file is reported once, however many use it.
    if (failed_.contains(request.path)) return kNone;
    try {
        return images().load(request.path, request.encoding, request.lookup, request.location);
    } catch (const InputError& error) {
        context_.diagnostics.error(request.location, reason(error));
        failed_.insert(request.path);
        return kNone;
    }
}

uint32_t TextureBuilder::emit(const TextureProgram& program, Location where, const std::string& what) {
    const auto asked_by = [&] { return fmt::format("{} ({})", context_.description.sources->describe(where), what); };
    std::vector<kernel::TextureOp> ops = program.ops;
    for (kernel::TextureOp& op : ops) {
        if (const uint64_t effects = effects_of(op)) context_.scene.effects.ask(effects, asked_by);
        if (effects_of(op) == kernel::EFFECT_NOISE) op.image = images().noise_permutation();
        if (op.operation != kernel::TEXTURE_IMAGE) continue;
        op.image = load(requests_[op.image]);
        if (op.image == kNone) return kNone;
    }
    ops.back().flags |= 1u;
    const uint32_t first = uint32_t(context_.scene.texture_ops.size());
    context_.scene.texture_ops.insert(context_.scene.texture_ops.end(), ops.begin(), ops.end());
    return first;
}

uint32_t TextureBuilder::named_program(const std::string& name, bool is_spectrum, Location where) {
    Texture* texture = find(name, is_spectrum, where);
    if (!texture) return kNone;
    if (texture->emitted == kNone)
        texture->emitted = emit(texture->program, texture->location, fmt::format("Texture \"{}\"", name));
    return texture->emitted;
}

uint32_t TextureBuilder::float_program(const std::string& name, Location where) {
    return named_program(name, false, where);
}
uint32_t TextureBuilder::color_program(const std::string& name, Location where) {
    return named_program(name, true, where);
}

uint32_t TextureBuilder::image_program(const std::string& filename, glm::vec3 scale, Location where) {
    const auto [found, is_new] =
        image_programs_.try_emplace(fmt::format("{} {} {} {}", scale.x, scale.y, scale.z, filename), kNone);
    if (!is_new) return found->second;
    kernel::TextureOp op{};
    op.operation = kernel::TEXTURE_IMAGE;
    op.flags = kernel::MAPPING_UV << 8;
    op.a = glm::vec4(scale, 0.0f);
    op.m0 = {1.0f, 1.0f, 0.0f, 0.0f};
    ImageRequest request{context_.resolve(filename), {}, {kernel::WRAP_CLAMP, kernel::FILTER_BILINEAR}, where};
    request.encoding.emits = true;
    op.image = request_image(std::move(request));
    TextureProgram program;
    program.ops.push_back(op);
    found->second = emit(program, where, "image");
    return found->second;
}

uint32_t TextureBuilder::image(const std::string& filename, Content content, Location where) {
    ImageRequest request{context_.resolve(filename), {}, {}, where};
    if (content == Content::kNormalMap) request.encoding.kind = TexelEncoding::Kind::kLinear;
    // Looked up without interpolation, as in pbrt, so that the density from which directions are sampled matches the light
    // exactly.
    if (content == Content::kProjection) request.lookup = {kernel::WRAP_CLAMP, kernel::FILTER_POINT};
    if (content == Content::kEnvironment) request.lookup = {kernel::WRAP_OCTAHEDRAL, kernel::FILTER_POINT};
    request.encoding.emits = content == Content::kProjection || content == Content::kEnvironment;
    return load(requests_[request_image(request)]);
}

}  // namespace lampyris
