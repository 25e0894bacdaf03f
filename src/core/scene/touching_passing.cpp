#include "core/scene/touching_passing.h"

namespace lampyris {

bool Passing::material(uint32_t index) {
    if (known_[index] != kUnknown) return known_[index] == kYes;
    known_[index] = kNo;
    const kernel::MaterialRecord& m = scene_.materials[index];
    bool passes = false;
    switch (m.kind) {
        case kernel::MATERIAL_DIELECTRIC:
        case kernel::MATERIAL_INTERFACE:
        case kernel::MATERIAL_THINDIELECTRIC:
        case kernel::MATERIAL_DIFFUSETRANSMISSION: passes = true; break;
        case kernel::MATERIAL_MIX: passes = material(m.first_material) || material(m.second_material); break;
        default: break;
    }
    known_[index] = passes ? kYes : kNo;
    return passes;
}

}  // namespace lampyris
