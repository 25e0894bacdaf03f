// Directives of the world: blocks, materials, textures, media, lights, shapes, objects.
#include "core/scene/limits.h"
#include "core/scene/parser.h"

namespace lampyris {

std::string Parser::name_of(Block kind) {
    return kind == Block::kObject ? "Object" : kind == Block::kAttribute ? "Attribute" : "Transform";
}

void Parser::begin_block(Block kind, const Token& directive) {
    OpenBlock block{kind, directive.location, state_, {}};
    if (!blocks_.empty()) block.last_of_kind = blocks_.back().last_of_kind;
    block.last_of_kind[size_t(kind)] = blocks_.size() + 1;
    blocks_.push_back(std::move(block));
}

bool Parser::end_block(Block kind, const Token& directive) {
    if (blocks_.size() <= first_own_block_) {
        diagnostics_->error(directive.location, std::string(directive.text) + " without " + name_of(kind) + "Begin");
        return false;
    }
    const OpenBlock& open = blocks_.back();
    if (open.kind != kind) {
        diagnostics_->error(directive.location,
                            std::string(directive.text) + " cannot close the block opened at " + place(open.location),
                            name_of(open.kind) + "End closes it");
        // Most likely one End is missing: if an outer block fits, close up to there.
        const size_t match = open.last_of_kind[size_t(kind)];
        if (match <= first_own_block_) return false;
        for (size_t i = match; i < blocks_.size(); ++i)
            if (blocks_[i].kind == Block::kObject) object_ = kNone;
        blocks_.resize(match);
    }
    state_ = std::move(blocks_.back().saved);
    blocks_.pop_back();
    return true;
}

void Parser::report_open_blocks(size_t from) {
    for (size_t i = blocks_.size(); i-- > from;)
        diagnostics_->error(blocks_[i].location, "this " + name_of(blocks_[i].kind) + "Begin is never closed",
                            "close it with " + name_of(blocks_[i].kind) + "End");
}

void Parser::defined_twice(const std::string& what, const NameTable::Entry& earlier, Location location) {
    diagnostics_->error(location, what + " \"" + shown(earlier.name) + "\" is defined twice",
                        "the first is at " + place(earlier.definition));
}

void Parser::attribute_begin(const Token& directive) { begin_block(Block::kAttribute, directive); }
void Parser::attribute_end(const Token& directive) { end_block(Block::kAttribute, directive); }

// In pbrt-v4 these save and restore everything that AttributeBegin does.
void Parser::transform_begin(const Token& directive) {
    if (!warned_transform_block_)
        diagnostics_->warning(directive.location, "TransformBegin and TransformEnd are old names",
                              "pbrt-v4 calls them AttributeBegin and AttributeEnd");
    warned_transform_block_ = true;
    begin_block(Block::kTransform, directive);
}
void Parser::transform_end(const Token& directive) { end_block(Block::kTransform, directive); }

void Parser::object_begin(const Token& directive) {
    std::string name;
    Location location;
    if (!read_string(directive, "a name", name, &location)) return;
    begin_block(Block::kObject, directive);
    if (object_ != kNone) {
        diagnostics_->error(directive.location, "ObjectBegin inside of an object: objects do not nest",
                            "close the outer one with ObjectEnd first");
    }
    const auto index = static_cast<uint32_t>(scene_.objects.size());
    if (const auto* earlier = objects_.define(name, location, index)) defined_twice("object", *earlier, location);
    ObjectDescription object;
    object.name = name;
    object.location = directive.location;
    scene_.objects.push_back(std::move(object));
    object_ = index;
}

void Parser::object_end(const Token& directive) {
    if (end_block(Block::kObject, directive)) object_ = kNone;
}

void Parser::object_instance(const Token& directive) {
    std::string name;
    Location location;
    if (!read_string(directive, "an object's name", name, &location)) return;
    if (object_ != kNone)
        return diagnostics_->error(directive.location, "ObjectInstance inside of an object: objects do not nest",
                                   "place instances after ObjectEnd");
    InstanceDescription instance;
    instance.object = objects_.use(name, location);
    instance.location = directive.location;
    instance.world_from_object = state_.transform();
    scene_.instances.push_back(instance);
    places_.instances.push_back(state_.place());
}

void Parser::attribute(const Token& directive) {
    std::string target;
    Location location;
    if (!read_string(directive, "\"shape\", \"light\", \"material\", \"medium\" or \"texture\"", target, &location))
        return;
    ParameterList list;
    read_parameters(list, nullptr);
    const std::pair<const char*, Defaults*> targets[] = {{"shape", &state_.shape_defaults},
                                                         {"light", &state_.light_defaults},
                                                         {"material", &state_.material_defaults},
                                                         {"medium", &state_.medium_defaults},
                                                         {"texture", &state_.texture_defaults}};
    std::vector<std::string> names;
    for (const auto& [name, defaults] : targets) {
        names.emplace_back(name);
        if (target != name) continue;
        // The new ones go first: they override those of an outer block.
        if (*defaults) list.add_defaults(**defaults);
        if (list.parameters.size() > kMostDefaults) {
            diagnostics_->error(
                directive.location,
                "Attribute has set " + std::to_string(list.parameters.size()) + " parameters of " + target,
                "a " + target + " has fewer; at most " + std::to_string(kMostDefaults) + " are kept");
            return;
        }
        for (Parameter& parameter : list.parameters) parameter.used = true;
        *defaults = std::make_shared<const std::vector<Parameter>>(std::move(list.parameters));
        return;
    }
    diagnostics_->error(location, "Attribute does not know \"" + shown(target) + "\"" + did_you_mean(target, names),
                        "it takes " + list_of(names));
}

void Parser::reverse_orientation(const Token&) { state_.reverse_orientation = !state_.reverse_orientation; }

void Parser::material(const Token& directive) {
    MaterialDescription material;
    if (!read_entity(directive, material, state_.material_defaults)) return;
    state_.material = static_cast<uint32_t>(scene_.materials.size());
    scene_.materials.push_back(std::move(material));
}

void Parser::make_named_material(const Token& directive) {
    MaterialDescription material;
    material.location = directive.location;
    Location location;
    if (!read_string(directive, "a name", material.name, &location)) return;
    read_parameters(material.parameters, state_.material_defaults);
    const Parameter* type = material.parameters.find("type", ParameterType::kString);
    const auto* values = type ? std::get_if<std::vector<std::string>>(&type->values) : nullptr;
    if (values && values->size() == 1) {
        material.type = values->front();
        material.type_location = type->value_location;
        old_format_.entity(directive.text, material.type, material.type_location);
    } else {
        diagnostics_->error(location, "named material \"" + shown(material.name) + "\" has no type",
                            "write \"string type\" \"diffuse\", for instance");
    }
    if (const auto* earlier =
            materials_.define(material.name, location, static_cast<uint32_t>(scene_.materials.size())))
        defined_twice("material", *earlier, location);
    scene_.materials.push_back(std::move(material));
}

void Parser::named_material(const Token& directive) {
    std::string name;
    Location location;
    if (read_string(directive, "a material's name", name, &location))
        state_.material = GraphicsState::kNamed + materials_.use(name, location);
}

void Parser::texture(const Token& directive) {
    TextureDescription texture;
    texture.location = directive.location;
    std::string values;
    Location name_location, values_location;
    if (!read_string(directive, "a name", texture.name, &name_location) ||
        !read_string(directive, "\"float\" or \"spectrum\"", values, &values_location) ||
        !read_string(directive, "a class of textures", texture.type, &texture.type_location))
        return;
    read_parameters(texture.parameters, state_.texture_defaults);
    if (values != "float" && values != "spectrum") {
        if (!old_format_.entity(directive.text, values, values_location))
            diagnostics_->error(
                values_location,
                "a texture cannot be of \"" + shown(values) + "\"" + did_you_mean(values, {"float", "spectrum"}),
                "it is \"float\" or \"spectrum\"");
        return;
    }
    texture.is_spectrum = values == "spectrum";
    texture.world_from_texture = state_.transform();
    NameTable& names = texture.is_spectrum ? spectrum_textures_ : float_textures_;
    if (const auto* earlier = names.define(texture.name, name_location, static_cast<uint32_t>(scene_.textures.size())))
        defined_twice(values + " texture", *earlier, name_location);
    scene_.textures.push_back(std::move(texture));
    places_.textures.push_back(state_.place());
}

void Parser::make_named_medium(const Token& directive) {
    MediumDescription medium;
    medium.location = directive.location;
    Location location;
    if (!read_string(directive, "a name", medium.name, &location)) return;
    read_parameters(medium.parameters, state_.medium_defaults);
    const Parameter* type = medium.parameters.find("type", ParameterType::kString);
    const auto* values = type ? std::get_if<std::vector<std::string>>(&type->values) : nullptr;
    if (values && values->size() == 1) {
        medium.type = values->front();
        medium.type_location = type->value_location;
    } else {
        diagnostics_->error(location, "medium \"" + shown(medium.name) + "\" has no type",
                            "write \"string type\" \"homogeneous\", for instance");
    }
    medium.world_from_medium = state_.transform();
    if (const auto* earlier = media_.define(medium.name, location, static_cast<uint32_t>(scene_.media.size())))
        defined_twice("medium", *earlier, location);
    scene_.media.push_back(std::move(medium));
}

// MediumInterface "interior" "exterior", or one name for both; "" is vacuum.
void Parser::medium_interface(const Token& directive) {
    std::string interior, exterior;
    Location interior_location, exterior_location;
    if (!read_string(directive, "a medium's name", interior, &interior_location)) return;
    exterior = interior;
    exterior_location = interior_location;
    if (tokenizer_->peek().kind == TokenKind::kString)
        read_string(directive, "a medium's name", exterior, &exterior_location);
    state_.interior_medium = interior.empty() ? kNone : media_.use(interior, interior_location);
    state_.exterior_medium = exterior.empty() ? kNone : media_.use(exterior, exterior_location);
}

void Parser::light_source(const Token& directive) {
    LightDescription light;
    if (!read_entity(directive, light, state_.light_defaults)) return;
    light.world_from_light = state_.transform();
    light.medium = state_.exterior_medium;
    scene_.lights.push_back(std::move(light));
    places_.lights.push_back(state_.place());
}

void Parser::area_light_source(const Token& directive) {
    Entity light;
    if (!read_entity(directive, light, state_.light_defaults)) return;
    state_.area_light = static_cast<uint32_t>(scene_.area_lights.size());
    scene_.area_lights.push_back(std::move(light));
}

void Parser::shape(const Token& directive) {
    ShapeDescription shape;
    if (!read_entity(directive, shape, state_.shape_defaults)) return;
    shape.world_from_object = state_.transform();
    shape.reverse_orientation = state_.reverse_orientation;
    shape.material = state_.material;
    shape.area_light = state_.area_light;
    shape.interior_medium = state_.interior_medium;
    shape.exterior_medium = state_.exterior_medium;
    if (object_ == kNone) {
        scene_.shapes.push_back(std::move(shape));
        places_.shapes.push_back(state_.place());
        return;
    }
    if (shape.area_light != kNone) {
        diagnostics_->warning(directive.location,
                              "shapes of an object do not emit: the area light is left out, as in pbrt",
                              "place the shape outside of ObjectBegin and ObjectEnd");
        shape.area_light = kNone;
    }
    scene_.objects[object_].shapes.push_back(std::move(shape));
}

}  // namespace lampyris
