// Material "thindielectric": a pane of glass.
#include "materials/shared/host.h"

namespace lampyris {

namespace {

void build(MaterialContext& context) {
    context.record.data.x = kernel::MATERIAL_THINDIELECTRIC;
    context.record.floats2.w = kNeverGathers;
    context.ask(kernel::EFFECT_THIN_DIELECTRIC);
    context.record.floats.z = read_eta(context, "eta");
    read_surface_detail(context);
}

const RegisterMaterial thindielectric("thindielectric",
                                      "A pane of glass as one surface: reflects, or lets pass straight on.",
                                      with_surface_detail({eta_spec("eta", "the pane")}), build);

}  // namespace

}  // namespace lampyris
