// pbrt's graphics state: directives change it, and entities take a snapshot of it.
#pragma once

#include "core/scene/description.h"

#include <glm/mat4x4.hpp>

#include <unordered_map>

namespace lampyris {

// Names that may be used before they are defined. Each gets an index at its first mention, and its definition later.
class NameTable {
 public:
    struct Entry {
        std::string name;
        Location first_use;  // unknown() while the name is defined but not used
        Location definition;
        uint32_t index = kNone;         // index of the named thing, once defined
        mutable bool reported = false;  // true: already reported as undefined
    };
    uint32_t use(const std::string& name, Location location) {
        const uint32_t id = intern(name);
        if (!entries_[id].first_use.known()) entries_[id].first_use = location;
        return id;
    }
    // The earlier definition, where there is one.
    const Entry* define(const std::string& name, Location location, uint32_t index) {
        Entry& entry = entries_[intern(name)];
        if (entry.index != kNone) return &entry;
        entry.index = index;
        entry.definition = location;
        return nullptr;
    }
    const Entry& operator[](uint32_t id) const { return entries_[id]; }
    std::vector<std::string> defined() const {
        std::vector<std::string> names;
        for (const Entry& entry : entries_)
            if (entry.index != kNone) names.push_back(entry.name);
        return names;
    }

 private:
    uint32_t intern(const std::string& name) {
        const auto [place, is_new] = ids_.try_emplace(name, static_cast<uint32_t>(entries_.size()));
        if (is_new) entries_.push_back({name, {}, {}});
        return place->second;
    }
    std::unordered_map<std::string, uint32_t> ids_;
    std::vector<Entry> entries_;
};

// Parameters that Attribute set for later entities of one kind. Shared between saved states until one of them adds more.
using Defaults = std::shared_ptr<const std::vector<Parameter>>;

struct GraphicsState {
    // In double precision, so that long chains of transforms and the camera's inverse lose no accuracy that a float would show.
    std::array<glm::dmat4, 2> ctm{glm::dmat4(1.0), glm::dmat4(1.0)};  // at the start and the end of the shutter
    static constexpr uint32_t kBothTimes = 3;
    uint32_t active_times = kBothTimes;  // bit i: transforms change ctm[i]
    bool reverse_orientation = false;
    std::string_view color_space = kColorSpaces[0];
    // An index into materials, or kNamed + an entry of the table of named materials.
    static constexpr uint32_t kNamed = 0x80000000u;
    uint32_t material = kNone;
    uint32_t area_light = kNone;
    uint32_t interior_medium = kNone, exterior_medium = kNone;  // entries of the table of media
    Defaults shape_defaults, light_defaults, material_defaults, medium_defaults, texture_defaults;

    glm::dvec3 place() const { return glm::dvec3(ctm[0][3]); }
    AnimatedTransform transform() const { return {{glm::mat4(ctm[0]), glm::mat4(ctm[1])}}; }
};

}  // namespace lampyris
