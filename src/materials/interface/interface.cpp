// Material "interface" (also "" and "none"): a surface that rays pass, the boundary of a medium.
#include "materials/shared/host.h"

namespace lampyris {

namespace {

void build(MaterialContext& context) {
    context.record.kind = kernel::MATERIAL_INTERFACE;
    context.record.roughest_alpha = kNeverGathers;
    context.ask(kernel::EFFECT_INTERFACE);
}

const RegisterMaterial interface_material("interface", "The boundary of a medium: rays pass through it unchanged.", {},
                                          build);

}  // namespace

}  // namespace lampyris
