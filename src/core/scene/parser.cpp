#include "core/scene/parser.h"

#include "core/base/memory.h"
#include "core/scene/number.h"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace lampyris {

std::span<const Parser::Directive> Parser::directives() {
    static constexpr Directive kDirectives[] = {
        {"Accelerator", Phase::kBeforeWorld, &Parser::accelerator},
        {"ActiveTransform", Phase::kAnywhere, &Parser::active_transform},
        {"AreaLightSource", Phase::kInWorld, &Parser::area_light_source},
        {"Attribute", Phase::kAnywhere, &Parser::attribute},
        {"AttributeBegin", Phase::kInWorld, &Parser::attribute_begin},
        {"AttributeEnd", Phase::kInWorld, &Parser::attribute_end},
        {"Camera", Phase::kBeforeWorld, &Parser::camera},
        {"ColorSpace", Phase::kAnywhere, &Parser::color_space},
        {"ConcatTransform", Phase::kAnywhere, &Parser::concat_transform},
        {"CoordSysTransform", Phase::kAnywhere, &Parser::coord_sys_transform},
        {"CoordinateSystem", Phase::kAnywhere, &Parser::coordinate_system},
        {"Film", Phase::kBeforeWorld, &Parser::film},
        {"Identity", Phase::kAnywhere, &Parser::identity},
        {"Import", Phase::kInWorld, &Parser::import},
        {"Include", Phase::kAnywhere, &Parser::include},
        {"Integrator", Phase::kBeforeWorld, &Parser::integrator},
        {"LightSource", Phase::kInWorld, &Parser::light_source},
        {"LookAt", Phase::kAnywhere, &Parser::look_at},
        {"MakeNamedMaterial", Phase::kInWorld, &Parser::make_named_material},
        {"MakeNamedMedium", Phase::kAnywhere, &Parser::make_named_medium},
        {"Material", Phase::kInWorld, &Parser::material},
        {"MediumInterface", Phase::kAnywhere, &Parser::medium_interface},
        {"NamedMaterial", Phase::kInWorld, &Parser::named_material},
        {"ObjectBegin", Phase::kInWorld, &Parser::object_begin},
        {"ObjectEnd", Phase::kInWorld, &Parser::object_end},
        {"ObjectInstance", Phase::kInWorld, &Parser::object_instance},
        {"Option", Phase::kAnywhere, &Parser::option},
        {"PixelFilter", Phase::kBeforeWorld, &Parser::pixel_filter},
        {"ReverseOrientation", Phase::kInWorld, &Parser::reverse_orientation},
        {"Rotate", Phase::kAnywhere, &Parser::rotate},
        {"Sampler", Phase::kBeforeWorld, &Parser::sampler},
        {"Scale", Phase::kAnywhere, &Parser::scale},
        {"Shape", Phase::kInWorld, &Parser::shape},
        {"Texture", Phase::kInWorld, &Parser::texture},
        {"Transform", Phase::kAnywhere, &Parser::transform},
        {"TransformBegin", Phase::kInWorld, &Parser::transform_begin},
        {"TransformEnd", Phase::kInWorld, &Parser::transform_end},
        {"TransformTimes", Phase::kBeforeWorld, &Parser::transform_times},
        {"Translate", Phase::kAnywhere, &Parser::translate},
        {"WorldBegin", Phase::kBeforeWorld, &Parser::world_begin},
    };
    return kDirectives;
}

namespace {

const Parser::Directive* find_directive(std::string_view word) {
    const auto all = Parser::directives();
    const auto place = std::lower_bound(all.begin(), all.end(), word,
                                        [](const Parser::Directive& d, std::string_view w) { return d.name < w; });
    return place != all.end() && place->name == word ? &*place : nullptr;
}

}  // namespace

bool is_directive(std::string_view word) { return find_directive(word) || word == "WorldEnd"; }

Parser::Parser(SceneFolder folder, std::shared_ptr<Sources> sources, Diagnostics& diagnostics)
    : diagnostics_(&diagnostics), old_format_(diagnostics), parameter_parser_(diagnostics, old_format_) {
    scene_.sources = std::move(sources);
    scene_.folder = std::move(folder);
}

void Parser::parse_text(std::string_view text, uint32_t file, const FileText* mapping) {
    Tokenizer tokenizer(text, file, *diagnostics_, mapping);
    Tokenizer* outer = std::exchange(tokenizer_, &tokenizer);
    while (true) {
        const Token token = tokenizer.next();
        if (token.kind == TokenKind::kEnd) {
            if (!outer) end_ = token.location;
            break;
        }
        if (token.kind == TokenKind::kWord)
            run(token);
        else
            unexpected(token);
        tokenizer.release_consumed();
        constexpr uint64_t kOften = 16384;  // statements: some megabytes
        if (++statements_ % kOften == 0) check_process_memory(diagnostics_->max_memory());
    }
    tokenizer_ = outer;
}

void Parser::run(const Token& token) {
    const Directive* directive = find_directive(token.text);
    if (!directive) return unexpected(token);
    if (directive->phase == Phase::kBeforeWorld && in_world_) {
        diagnostics_->error(token.location, std::string(directive->name) + " cannot come after WorldBegin",
                            "move it before WorldBegin");
        return skip_to_directive();
    }
    if (directive->phase == Phase::kInWorld && !in_world_) {
        diagnostics_->error(token.location, std::string(directive->name) + " cannot come before WorldBegin",
                            "WorldBegin separates camera, film and the like from the world");
        // One error is enough: from here on the parser acts as if the directive were there.
        in_world_ = true;
    }
    (this->*directive->parse)(token);
}

void Parser::unexpected(const Token& token) {
    const auto names = [] {
        std::vector<std::string> all;
        for (const Directive& directive : directives()) all.emplace_back(directive.name);
        return all;
    };
    if (token.kind == TokenKind::kString) {
        diagnostics_->error(token.location, "expected a directive, found the string \"" + shown(token.text) + "\"",
                            "parameters follow the directive that they belong to");
    } else if (token.kind == TokenKind::kOpen || token.kind == TokenKind::kClose) {
        diagnostics_->error(token.location, token.kind == TokenKind::kOpen ? "this '[' belongs to no parameter"
                                                                           : "this ']' closes nothing");
    } else if (!old_format_.directive(token.text, token.location)) {
        double value;
        const char* end = token.text.data() + token.text.size();
        if (parse_double(token.text.data(), end, value).status == NumberStatus::kOk)
            diagnostics_->error(token.location, "expected a directive, found the number " + shown(token.text),
                                "the directive or parameter before it takes no more numbers");
        else
            diagnostics_->error(token.location, "unknown directive \"" + shown(token.text) + "\"" +
                                                    (diagnostics_->full() ? "" : did_you_mean(token.text, names())));
    }
    skip_to_directive();
}

void Parser::skip_to_directive() {
    while (true) {
        const Token& token = tokenizer_->peek();
        if (token.kind == TokenKind::kEnd || (token.kind == TokenKind::kWord && is_directive(token.text))) return;
        tokenizer_->next();
        tokenizer_->release_consumed();
    }
}

bool Parser::read_string(const Token& directive, const char* what, std::string& value, Location* location) {
    const Token token = tokenizer_->peek();
    if (token.kind == TokenKind::kString) {
        tokenizer_->next();
        value = tokenizer_->string_value(token);
        if (location) *location = token.location;
        return true;
    }
    const std::string found = token.kind == TokenKind::kEnd ? "the file ends" : "found \"" + shown(token.text) + "\"";
    diagnostics_->error(token.kind == TokenKind::kEnd ? directive.location : token.location,
                        std::string(directive.text) + " needs " + what + " in quotes, but " + found);
    skip_to_directive();
    return false;
}

void Parser::read_parameters(ParameterList& list, const Defaults& defaults) {
    parameter_parser_.parse(*tokenizer_, state_.color_space, list);
    if (defaults) list.add_defaults(*defaults);
}

bool Parser::read_entity(const Token& directive, Entity& entity, const Defaults& defaults) {
    entity.location = directive.location;
    if (!read_string(directive, "a type", entity.type, &entity.type_location)) return false;
    old_format_.entity(directive.text, entity.type, entity.type_location);
    read_parameters(entity.parameters, defaults);
    return true;
}

bool Parser::open_file(const Token& directive, const std::string& name, Location location, std::string& path) {
    constexpr size_t kMaxFiles = 1000000;  // chains of files that include the next one twice grow exponentially
    constexpr size_t kMaxDepth = 100;
    std::string why;
    if (name.empty()) {
        why = "its name is empty";
    } else if (open_files_.size() >= kMaxDepth || ++files_read_ > kMaxFiles) {
        why = "files are included too deeply or too often";
    } else {
        path = scene_.folder.path(name);
        why = scene_.folder.why_refused(path);
        if (why.empty() && parse_file(path, why)) return true;
    }
    diagnostics_->error(location, std::string(directive.text) + " cannot read \"" + shown(name) + "\": " + why,
                        "relative names start at the folder of the scene file");
    return false;
}

bool Parser::parse_file(const std::string& path, std::string& why) {
    std::error_code code;
    std::string canonical = std::filesystem::weakly_canonical(path, code).string();
    if (code) canonical = path;
    if (std::find(open_files_.begin(), open_files_.end(), canonical) != open_files_.end()) {
        why = "it includes itself";
        return false;
    }
    auto place = files_.find(canonical);
    if (place == files_.end()) {
        File file;
        file.text = FileText::open(path, why);
        if (!file.text) return false;
        file.source = scene_.sources->add(path, file.text->text(), file.text);
        place = files_.emplace(canonical, std::move(file)).first;
    }
    const File file = place->second;
    open_files_.push_back(canonical);
    parse_text(file.text->text(), file.source, file.text.get());
    open_files_.pop_back();
    return true;
}

std::string Parser::place(Location location) const {
    return diagnostics_->full() ? std::string() : scene_.sources->describe(location);
}

SceneDescription Parser::finish() {
    report_open_blocks(0);
    if (!in_world_ && !diagnostics_->has_errors())
        diagnostics_->error(end_, "the scene ends before WorldBegin", "what is to be seen comes after WorldBegin");
    resolve_names();
    recentre(scene_, places_);
    return std::move(scene_);
}

uint32_t Parser::resolve(const NameTable& table, uint32_t id, const char* what) {
    if (id == kNone) return kNone;
    const NameTable::Entry& entry = table[id];
    if (entry.index == kNone && !entry.reported) {
        entry.reported = true;
        diagnostics_->error(entry.first_use, std::string("no ") + what + " is named \"" + shown(entry.name) + "\"" +
                                                 diagnostics_->guess(entry.name, [&] { return table.defined(); }));
    }
    return entry.index;
}

void Parser::resolve_names() {
    const auto resolve_shape = [&](ShapeDescription& shape) {
        if (shape.material != kNone && shape.material >= GraphicsState::kNamed)
            shape.material = resolve(materials_, shape.material - GraphicsState::kNamed, "material");
        shape.interior_medium = resolve(media_, shape.interior_medium, "medium");
        shape.exterior_medium = resolve(media_, shape.exterior_medium, "medium");
    };
    for (ShapeDescription& shape : scene_.shapes) resolve_shape(shape);
    for (ObjectDescription& object : scene_.objects)
        for (ShapeDescription& shape : object.shapes) resolve_shape(shape);
    for (LightDescription& light : scene_.lights) light.medium = resolve(media_, light.medium, "medium");
    scene_.camera.medium = resolve(media_, scene_.camera.medium, "medium");
    for (InstanceDescription& instance : scene_.instances)
        instance.object = resolve(objects_, instance.object, "object");
}

namespace {

// Of a scene on standard input, the working folder.
std::string folder_of(const std::string& path) {
    if (path.starts_with("/dev/") || path.starts_with("/proc/")) return ".";
    return std::filesystem::path(path).parent_path().string();
}

}  // namespace

SceneDescription parse_scene_file(const std::string& path, std::shared_ptr<Sources> sources, Diagnostics& diagnostics,
                                  std::vector<std::string> allowed) {
    Parser parser(SceneFolder(folder_of(path), std::move(allowed)), std::move(sources), diagnostics);
    std::string why;
    if (!parser.parse_file(path, why)) throw InputError(path + ": error: the scene cannot be read: " + why);
    return parser.finish();
}

SceneDescription parse_scene_text(std::string name, std::string text, SceneFolder folder,
                                  std::shared_ptr<Sources> sources, Diagnostics& diagnostics) {
    Parser parser(std::move(folder), sources, diagnostics);
    const uint32_t file = sources->add_owned(std::move(name), std::move(text));
    parser.parse_text(sources->text(file), file, nullptr);
    return parser.finish();
}

}  // namespace lampyris
