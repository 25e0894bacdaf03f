// Material "thindielectric": a pane of glass.
#include "materials/shared/host.h"

namespace lampyris {

namespace {

void build(MaterialContext& context) {
    context.record.kind = kernel::MATERIAL_THINDIELECTRIC;
    context.record.roughest_alpha = kNeverGathers;
    context.ask(kernel::EFFECT_THIN_DIELECTRIC);
    context.record.eta = read_eta(context, "eta");
    read_surface_detail(context);
}

const RegisterMaterial thindielectric("thindielectric",
                                      "A pane of glass as one surface: reflects, or lets pass straight on.",
                                      with_surface_detail({eta_spec("eta", "the pane")}), build);

}  // namespace

}  // namespace lampyris
