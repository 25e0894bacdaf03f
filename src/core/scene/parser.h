// The parser proper: one method per directive, filling in a SceneDescription. Internal; parse_scene_file() is the way in.
#pragma once

#include "core/scene/description.h"
#include "core/scene/file_text.h"
#include "core/scene/graphics_state.h"
#include "core/scene/parameter_parser.h"
#include "core/scene/recentre.h"
#include "core/scene/tokenizer.h"

#include <optional>
#include <span>
#include <unordered_map>
#include <utility>

namespace lampyris {

class Parser {
 public:
    Parser(SceneFolder folder, std::shared_ptr<Sources> sources, Diagnostics& diagnostics);
    void parse_text(std::string_view text, uint32_t file, const FileText* mapping);
    bool parse_file(const std::string& path, std::string& why);
    SceneDescription finish();

    // Where a directive may stand.
    enum class Phase { kAnywhere, kBeforeWorld, kInWorld };
    struct Directive {
        std::string_view name;
        Phase phase;
        void (Parser::*parse)(const Token& directive);
    };
    static std::span<const Directive> directives();

 private:
    // Settings: what comes before WorldBegin, and what holds for the scene (directives_settings.cpp).
    void world_begin(const Token& directive);
    void option(const Token& directive);
    void color_space(const Token& directive);
    void camera(const Token& directive);
    void sampler(const Token& directive);
    void film(const Token& directive);
    void pixel_filter(const Token& directive);
    void integrator(const Token& directive);
    void accelerator(const Token& directive);
    void include(const Token& directive);
    void import(const Token& directive);
    // Transforms (directives_transform.cpp).
    void identity(const Token& directive);
    void translate(const Token& directive);
    void rotate(const Token& directive);
    void scale(const Token& directive);
    void look_at(const Token& directive);
    void transform(const Token& directive);
    void concat_transform(const Token& directive);
    void coordinate_system(const Token& directive);
    void coord_sys_transform(const Token& directive);
    void active_transform(const Token& directive);
    void transform_times(const Token& directive);
    // The world (directives_world.cpp).
    void attribute_begin(const Token& directive);
    void attribute_end(const Token& directive);
    void transform_begin(const Token& directive);
    void transform_end(const Token& directive);
    void object_begin(const Token& directive);
    void object_end(const Token& directive);
    void object_instance(const Token& directive);
    void attribute(const Token& directive);
    void reverse_orientation(const Token& directive);
    void material(const Token& directive);
    void make_named_material(const Token& directive);
    void named_material(const Token& directive);
    void texture(const Token& directive);
    void make_named_medium(const Token& directive);
    void medium_interface(const Token& directive);
    void light_source(const Token& directive);
    void area_light_source(const Token& directive);
    void shape(const Token& directive);

    // Parts of directives. If they return false, the error is reported, and the caller skips the rest of the directive.
    void run(const Token& directive);
    void unexpected(const Token& token);
    Location end_;                               // of the scene file
    std::string place(Location location) const;  // "file:line:column" for a message
    void defined_twice(const std::string& what, const NameTable::Entry& earlier, Location location);
    void skip_to_directive();
    bool read_string(const Token& directive, const char* what, std::string& value, Location* location = nullptr);
    bool read_numbers(const Token& directive, std::span<double> values, bool bracketed);
    bool read_entity(const Token& directive, Entity& entity, const Defaults& defaults = nullptr);
    void read_parameters(ParameterList& list, const Defaults& defaults);
    void set_once(const Token& directive, Entity& entity);
    void apply(const glm::dmat4& matrix, bool replace = false);
    bool open_file(const Token& directive, const std::string& name, Location location, std::string& path);

    // The stack of open blocks.
    enum class Block { kAttribute, kTransform, kObject };
    struct OpenBlock {
        Block kind;
        Location location;
        GraphicsState saved;
        std::array<size_t, 3>
            last_of_kind;  // index + 1 of the innermost block of each kind, this one included; 0: none
    };
    static std::string name_of(Block kind);
    void begin_block(Block kind, const Token& directive);
    bool end_block(Block kind, const Token& directive);
    void report_open_blocks(size_t from);

    // Resolves names to indices, once everything is known.
    void resolve_names();
    uint32_t resolve(const NameTable& table, uint32_t id, const char* what);

    struct File {
        std::shared_ptr<const FileText> text;
        uint32_t source = 0;
    };

    SceneDescription scene_;
    Places places_;
    Diagnostics* diagnostics_;
    OldFormat old_format_;
    ParameterParser parameter_parser_;
    Tokenizer* tokenizer_ = nullptr;  // of the file being read
    GraphicsState state_;
    std::vector<OpenBlock> blocks_;
    size_t first_own_block_ = 0;  // blocks below belong to the file that Imports this one
    bool in_world_ = false;
    uint32_t object_ = kNone;  // being defined
    NameTable media_, materials_, objects_, float_textures_, spectrum_textures_;
    using CoordinateSystem = std::array<glm::dmat4, 2>;
    void define_coordinate_system(const std::string& name, const CoordinateSystem& matrices);
    std::unordered_map<std::string, CoordinateSystem> coordinate_systems_;
    bool importing_ = false;
    std::vector<std::pair<std::string, std::optional<CoordinateSystem>>> undo_;  // what Imports have changed
    std::unordered_map<std::string, File> files_;  // by canonical path: each is mapped once
    std::vector<std::string> open_files_;          // canonical paths, outermost first
    uint64_t statements_ = 0;
    size_t files_read_ = 0;
    bool warned_transform_block_ = false;
};

}  // namespace lampyris
